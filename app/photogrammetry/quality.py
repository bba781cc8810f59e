"""Judge an adjusted network: which sightings are false, which plates are not as printed, which are seen well."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.control import StandingTargets
from app.photogrammetry.network import Network
from app.photogrammetry.plate_faults import PlateFits
from app.photogrammetry.robust import robust_scale
from app.photogrammetry.sightings import Sightings
from app.photogrammetry.split_targets import SplitOptions

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class QualityOptions:
    """When an observation, a target or a photograph is left out.

    Attributes
    ----------
    gross_sigmas : float
        Root mean square residual of a sighting, in standard deviations, beyond which it is false: of 20 to 32 numbers
        the mean square hardly doubles by chance; blur and reflections triple it.
    least_scale : float
        The least standard deviation that residuals are judged by, as a fraction of the stated one: rounding of exact
        observations is no scale.
    bad_photo_share : float
        A photograph with a greater share of false sightings is wrong itself.
    bad_target_share : float
        A target with at least two false sightings, and this share of all, is examined: moved, doubled or deformed.
    fault_gain : float
        Fall of the weighted squares from which a plate's deformation is certain: 10 standard deviations.
    least_fault_u : float
        Displacement of its dots, in modules, from which a deformed plate is left out: 3 % of u, 0.4 mm of 14 mm.
    fewest_rays : int
        Photographs that must see a target for it to be published: three control each other.
    fewest_control_rays : int
        Photographs that must see the target of a control or check point: two of sixteen dots each control each other.
    least_angle_rad : float
        Between two of its rays: 5 degrees.
    most_rounds : int
        Adjustments after which no more is left out: the worst goes first, and what it hid later.
    most_regroupings : int
        Adjustments more in which plates may change their print batch.
    split : SplitOptions
    """

    gross_sigmas: float = 5.0
    least_scale: float = 0.1
    bad_photo_share: float = 0.5
    bad_target_share: float = 0.3
    fault_gain: float = 100.0
    least_fault_u: float = 0.03
    fewest_rays: int = 3
    fewest_control_rays: int = 2
    least_angle_rad: float = float(np.deg2rad(5.0))
    most_rounds: int = 15
    most_regroupings: int = 4
    split: SplitOptions = field(default_factory=SplitOptions)


def residual_scale(problem: BundleProblem, squared: Array, options: QualityOptions) -> float:
    """Robust standard deviation of the residuals, as a multiple of the stated one."""
    return max(robust_scale(squared[problem.sightings.measured]), options.least_scale)


def sighting_sigmas(problem: BundleProblem, squared: Array, scale: float) -> Array:
    """Root mean square residual of each sighting, shape (M,), in standard deviations."""
    measured = problem.sightings.measured
    mean = (squared * measured).sum(axis=-1) / (2.0 * measured.sum(axis=-1))
    return np.asarray(np.sqrt(mean) / scale)


def fault_of_plate(fits: PlateFits, u_m: float, scale: float, options: QualityOptions) -> list[str | None]:
    """For each plate what is wrong with it, in words; None when nothing is."""
    gain = fits.gain / scale**2
    faulty = (gain > options.fault_gain) & (fits.displacement_m > options.least_fault_u * u_m)
    stretch_m = np.sqrt(np.maximum(fits.displacement_m**2 - fits.bend_m**2, 0.0))
    found: list[str | None] = [None] * len(gain)
    for target in np.flatnonzero(faulty):
        if fits.bend_m[target] > stretch_m[target]:
            found[target] = f"is bent: its dots stand {1e3 * fits.bend_m[target]:.1f} mm off a plane; fix it flat"
        else:
            x, y = 100.0 * (1.0 + fits.stretch[target])
            found[target] = (
                f"is printed at {x:.1f} % by {y:.1f} % of the others' size; print it with all others, without fitting "
                "to the page"
            )
    return found


def standing_targets(codes: Index, network: Network, sightings: Sightings, options: QualityOptions) -> StandingTargets:
    """The targets of a network, codes of shape (T,), judged by their rays."""
    angled = intersection_angles(network, sightings) >= options.least_angle_rad
    rays = sightings.rays()
    return StandingTargets(
        codes, angled & (rays >= options.fewest_rays), angled & (rays >= options.fewest_control_rays)
    )


def intersection_angles(network: Network, sightings: Sightings) -> Array:
    """Greatest angle between two rays of each target, shape (T,), rad; zero with fewer than two rays."""
    rays = network.photo_positions_m[sightings.photo] - network.target_positions_m[sightings.target]
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    order = np.argsort(sightings.target, kind="stable")
    angles = np.zeros(sightings.target_count)
    for target, rows in enumerate(np.split(order, np.cumsum(sightings.rays())[:-1])):
        if len(rows) > 1:
            cosine = (rays[rows] @ rays[rows].T).min()
            angles[target] = np.arccos(np.clip(cosine, -1.0, 1.0))
    return angles
