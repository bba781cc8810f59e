"""Which targets are not seen any more where they should be.

A wall, a door or a person may stand between. So a target counts as missed only in a picture that shows its neighbours:
it must face the camera, be no smaller and no more slanted than they are, and lie well within the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from app.geometry.camera import Camera
from app.geometry.target_map import TargetMap
from app.photogrammetry.evidence import SnapshotEvidence

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class VanishedOptions:
    """When a target counts as vanished.

    Attributes
    ----------
    neighbour_m : float
        Targets nearer than this are neighbours: what hides all of one and none of two others is smaller than that.
    fewest_neighbours : int
        Neighbours that the picture must show.
    margin_share : float
        Least distance of the plate from the picture's border, as a share of the picture's longer side.
    least_size_share : float
        Its size in the picture (foreshortened area's root) over that of the smallest neighbour seen.
    fewest_misses, fewest_places : int
        Pictures, and places that they were taken from, that miss it in a row. A detector that misses a plate in such
        a view once in ten, independently, misses twelve in a row once in 10^12.
    """

    neighbour_m: float = 1.2
    fewest_neighbours: int = 2
    margin_share: float = 0.03
    least_size_share: float = 1.1
    fewest_misses: int = 12
    fewest_places: int = 4


@dataclass(frozen=True)
class VanishedTarget:
    """A target that is not seen any more; ``rows`` numbers the pictures that should show it since it was seen last."""

    code: int
    rows: Index
    places: int


@dataclass(frozen=True)
class _Plates:
    """The map as arrays over its T targets, and who is whose neighbour (T sorted lists)."""

    codes: npt.NDArray[np.int64]
    centres_m: Array
    normals: Array
    dots_m: Array
    neighbours: tuple[Index, ...]

    def take(self, index: Index) -> _Plates:
        """Some of the targets; neighbours keep the numbers that they have in the map."""
        neighbours = tuple(self.neighbours[number] for number in index)
        return _Plates(self.codes[index], self.centres_m[index], self.normals[index], self.dots_m[index], neighbours)

    @classmethod
    def of(cls, target_map: TargetMap, neighbour_m: float) -> _Plates:
        targets = target_map.targets
        centres_m = np.array([target.site_from_target.position_m for target in targets])
        near = cKDTree(centres_m).query_ball_point(centres_m, neighbour_m)
        return cls(
            np.array([target.code for target in targets]),
            centres_m,
            np.array([target.site_from_target.rotation[:, 2] for target in targets]),
            np.array([target.dots_m for target in targets]),
            tuple(np.array([other for other in found if other != at], np.intp) for at, found in enumerate(near)),
        )


def find_vanished_targets(
    snapshots: Sequence[SnapshotEvidence], places: Index, target_map: TargetMap, options: VanishedOptions | None = None
) -> tuple[VanishedTarget, ...]:
    """Targets of the map that the newest snapshots should show and do not.

    Parameters
    ----------
    snapshots : sequence of SnapshotEvidence
        In the order of time, all resected in this map.
    places : ndarray of shape (N,), int
        From which place each was taken.
    target_map : TargetMap
    options : VanishedOptions, optional
    """
    options = options or VanishedOptions()
    plates = _Plates.of(target_map, options.neighbour_m)
    missed: dict[int, list[int]] = {}
    for row, evidence in enumerate(snapshots):
        seen: Mask = np.isin(plates.codes, list(evidence.seen_codes))
        for number in np.flatnonzero(seen).tolist():
            missed.pop(number, None)
        for number in _missing(evidence, plates, seen, options):
            missed.setdefault(number, []).append(row)
    found = []
    for number, rows in sorted(missed.items()):
        stands = len(np.unique(places[rows]))
        if len(rows) >= options.fewest_misses and stands >= options.fewest_places:
            found.append(VanishedTarget(int(plates.codes[number]), np.array(rows, dtype=np.intp), stands))
    return tuple(found)


def _missing(evidence: SnapshotEvidence, plates: _Plates, seen: Mask, options: VanishedOptions) -> list[int]:
    """Numbers of the targets that a picture should show and does not."""
    shown = np.flatnonzero(seen)
    near = {other for number in shown.tolist() for other in plates.neighbours[number].tolist()}
    absent = sorted(near - set(shown.tolist()))
    looked_at = np.array([*absent, *shown], dtype=np.intp)
    sizes = np.full(len(plates.codes), np.nan)
    sizes[looked_at] = _sizes(evidence, plates.take(looked_at), options)
    missing = []
    for number in absent:
        beside = sizes[plates.neighbours[number]][seen[plates.neighbours[number]]]
        beside = beside[np.isfinite(beside)]
        if len(beside) >= options.fewest_neighbours and sizes[number] >= options.least_size_share * beside.min():
            missing.append(number)
    return missing


def _sizes(evidence: SnapshotEvidence, plates: _Plates, options: VanishedOptions) -> Array:
    """Root of the foreshortened area of each target's image, up to a factor, shape (T,); NaN where not wholly in view.

    A target of width w at distance d whose normal lies at an angle t to the line of sight covers w^2 cos(t) / d^2.
    """
    camera, site_from_cam = evidence.camera, evidence.site_from_cam
    to_camera_m = site_from_cam.position_m - plates.centres_m
    distances_m = np.linalg.norm(to_camera_m, axis=1)
    facing = (plates.normals * to_camera_m).sum(axis=1) / distances_m
    cam_m = site_from_cam.inverse().apply(plates.dots_m)
    # A strong distortion folds what lies far outside back into the picture: first without any.
    steepest = np.abs(cam_m[..., :2]).max(axis=(1, 2))
    before = (facing > 0) & (cam_m[..., 2] > 0).all(axis=1) & (steepest < cam_m[..., 2].min(axis=1) * _field(camera))
    image_px = camera.project(np.where(before[:, None, None], cam_m, [0.0, 0.0, 1.0]))
    margin_px = options.margin_share * max(camera.width_px, camera.height_px)
    corner_px = np.array([camera.width_px - 1, camera.height_px - 1])
    inside = ((image_px > margin_px) & (image_px < corner_px - margin_px)).all(axis=(1, 2))
    return np.where(before & inside, np.sqrt(np.maximum(facing, 0.0)) / distances_m, np.nan)


def _field(camera: Camera) -> float:
    """Tangent of the widest angle off the axis that the picture's corners show, along either side."""
    corners_px = np.array([[0.0, 0.0], [camera.width_px - 1.0, camera.height_px - 1.0]])
    return float(np.abs(camera.normalise(corners_px)).max())
