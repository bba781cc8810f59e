"""What the geometry of a calibration's photographs carries, what it does not, and which photographs would help.

The intrinsics are weighted unknowns, so nothing runs away: what the photographs do not show keeps the uncertainty it
had. A camera whose focal length or principal point stays too uncertain to be called calibrated is refused.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import CalibrationFailed
from app.geometry.camera import INTRINSIC_NAMES
from app.photogrammetry.calibration.adjust import AdjustedCamera

Array = npt.NDArray[np.float64]

LEARNED = 0.5  # of its prior's standard deviation: an intrinsic that is not known twice as well was not calibrated
FOCAL, CENTRE = 0, slice(2, 4)


@dataclass(frozen=True)
class CarriedOptions:
    """When a camera counts as calibrated, and what good photographs show.

    Attributes
    ----------
    max_focal : float
        Greatest standard deviation of the focal length, relative, without the photographs' scatter. A camera of the
        same model is known to 0.5 % already (``CameraPriorOptions.model_focal``).
    max_scatter : float
        Greatest standard deviation of a photograph's own focal length, relative: with more than this EXIF's word alone
        (1.5 to 2.5 %) is as good.
    max_centre : float
        As ``max_focal``, of the principal point, as a fraction of the longer side: what another unit gives away.
    good_depth_ratio : float
        Farthest over nearest dot within a photograph, from which distance and focal length part: a wall 3 m away seen
        at 35 degrees.
    good_cover : float
        Share of the picture's cells that hold dots in some photograph.
    cells : tuple of int
        Columns and rows of the cells.
    good_turned : float
        Share of the photographs that are turned by a quarter against the others.
    """

    max_focal: float = 0.003
    max_scatter: float = 0.015
    max_centre: float = 0.003
    good_depth_ratio: float = 1.3
    good_cover: float = 0.7
    cells: tuple[int, int] = (6, 4)
    good_turned: float = 0.15


def not_carried(adjusted: AdjustedCamera) -> tuple[str, ...]:
    """Names of the intrinsics that are hardly better known than before."""
    before = np.sqrt(np.diag(adjusted.prior.covariance))
    after = np.sqrt(np.diag(adjusted.found.of_network))
    return tuple(name for name, share in zip(INTRINSIC_NAMES, after / before, strict=True) if share > LEARNED)


def check_carried(adjusted: AdjustedCamera, options: CarriedOptions) -> None:
    """Refuse a camera that the photographs do not fix.

    Raises
    ------
    CalibrationFailed
        Reason ``focal-not-carried``, ``focal-scatters`` or ``centre-not-carried``, with the photographs to add.
    """
    camera = adjusted.problem.camera_at(adjusted.network, 0)
    sigmas = np.sqrt(np.diag(adjusted.found.of_network))
    focal = float(sigmas[FOCAL] / camera.fx_px)
    scattered = float(np.sqrt(adjusted.found.calibrated.covariance[FOCAL, FOCAL]) / camera.fx_px)
    centre = float(sigmas[CENTRE].max() / max(camera.width_px, camera.height_px))
    if focal > options.max_focal:
        what = f"the focal length to {100.0 * focal:.2g} % only (limit {100.0 * options.max_focal:g} %)"
        raise _refusal("focal-not-carried", what, adjusted, options, focal_sigma=focal)
    if scattered > options.max_scatter:
        limit = f"limit {100.0 * options.max_scatter:g} %"
        what = f"the focal length of each of them to {100.0 * scattered:.2g} % only ({limit})"
        raise _refusal("focal-scatters", what, adjusted, options, focal_sigma=scattered)
    if centre > options.max_centre:
        what = f"the principal point to {100.0 * centre:.2g} % of the picture only ({100.0 * options.max_centre:g} %)"
        raise _refusal("centre-not-carried", what, adjusted, options, centre_sigma=centre)


def _refusal(
    reason: str, what: str, adjusted: AdjustedCamera, options: CarriedOptions, **sigmas: float
) -> CalibrationFailed:
    advice = _advice(adjusted, options)
    return CalibrationFailed(
        f"The {adjusted.problem.sightings.photo_count} photographs fix {what}, so that nothing is gained by them: "
        f"{'; '.join(advice)}.",
        reason=reason,
        advice=advice,
        not_carried=list(not_carried(adjusted)),
        **sigmas,
    )


def _advice(adjusted: AdjustedCamera, options: CarriedOptions) -> list[str]:
    """Which photographs to add; the weakest point of the geometry first."""
    advice = []
    if _depth_ratio(adjusted) < options.good_depth_ratio:
        advice.append(
            "add photographs that show near and far targets together, or look along a wall at 30 to 60 degrees: from "
            "the front, focal length and distance cannot be told apart"
        )
    cover = _cover(adjusted, options.cells)
    if cover < options.good_cover:
        advice.append(
            f"let targets stand in all parts of the picture, in its corners ({100.0 * cover:.0f} % of it hold dots now)"
        )
    if _turned_share(adjusted) < options.good_turned:
        advice.append("turn the phone by a quarter turn for every third photograph")
    if adjusted.found.scatter.focal > options.max_focal:
        advice.append("hold the focus where it is (photograph from like distances, or lock it) and show more targets")
    return advice or ["add photographs from other places, nearer to the targets and with more of them in view"]


def _depth_ratio(adjusted: AdjustedCamera) -> float:
    """Farthest over nearest target or plate's edge within a photograph; the median over the photographs."""
    network, sightings = adjusted.network, adjusted.problem.sightings
    dots_m = network.dots_m(adjusted.problem.u_m)[sightings.target]
    from_cam_m = dots_m - network.photo_positions_m[sightings.photo][:, None]
    depth_m = (from_cam_m * network.photo_rotations[sightings.photo][:, None, :, 2]).sum(axis=-1)
    farthest, nearest = np.zeros(sightings.photo_count), np.full(sightings.photo_count, np.inf)
    np.maximum.at(farthest, sightings.photo, depth_m.max(axis=1))
    np.minimum.at(nearest, sightings.photo, depth_m.min(axis=1))
    return float(np.median(farthest / nearest))


def _cover(adjusted: AdjustedCamera, cells: tuple[int, int]) -> float:
    """Share of the picture's cells in which some photograph measured a dot."""
    camera, sightings = adjusted.prior.camera, adjusted.problem.sightings
    size_px = np.array([camera.width_px, camera.height_px])
    place = np.floor(sightings.dots_px[sightings.measured] / size_px * cells).astype(np.intp)
    place = np.clip(place, 0, np.array(cells) - 1)
    return len(np.unique(place, axis=0)) / (cells[0] * cells[1])


def _turned_share(adjusted: AdjustedCamera) -> float:
    """Share of the photographs whose picture stands a quarter turn off that of most, by the plates' upright edges."""
    network, sightings = adjusted.network, adjusted.problem.sightings
    up = network.target_rotations[sightings.target][..., 1]
    in_cam = (np.swapaxes(network.photo_rotations[sightings.photo], -1, -2) @ up[..., None])[..., 0]
    lying = np.abs(in_cam[:, 0]) > np.abs(in_cam[:, 1])
    counts = sightings.targets_per_photo()
    share = float((np.bincount(sightings.photo, lying, len(counts)) > counts / 2.0).mean())
    return min(share, 1.0 - share)
