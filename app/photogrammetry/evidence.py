"""What one located snapshot says of where its targets stand: each target's apparent movement in the map.

The movements are kept as they look from the adjusted pose, with the dots' accuracy alone. Who reads many snapshots can
then decide anew which targets to believe, take the others out of every pose, and hold each target against the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, Camera
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import log_rotation
from app.geometry.target_map import TargetMap
from app.photogrammetry.kernels.movements import step_movements
from app.photogrammetry.planar_pose import planar_poses
from app.photogrammetry.resection import Resection
from app.photogrammetry.resection_equations import OWN_COUNT, CameraPrior, State, linearise
from app.photogrammetry.resection_input import SightedTargets, sight_targets
from app.targets.layout import dots_target_m

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Codes = npt.NDArray[np.int64]


@dataclass(frozen=True)
class EvidenceOptions:
    """Which targets of a snapshot can witness.

    Attributes
    ----------
    least_condition : float
        Least eigenvalue of a target's normal matrix, its diagonal scaled to 1. Dots on one line leave a turn free and
        have 0; whole plates have 1e-3 and more. Numbers are kept with seven digits.
    """

    least_condition: float = 1e-5


@dataclass(frozen=True)
class Movements:
    """Apparent movements of K mapped targets against the map, seen from one pose.

    Attributes
    ----------
    codes : ndarray of shape (K,), int
    used : ndarray of shape (K,), bool
        Whether the target carried the pose.
    values : ndarray of shape (K, 6)
        Translation of the centre (m) and small rotation (rad), site axes: where the target stands less where the map
        has it.
    information : ndarray of shape (K, 6, 6)
        Inverse covariance of a movement by the dots alone, the pose taken as it is; positive definite.
    """

    codes: Codes
    used: Mask
    values: Array
    information: Array

    def __post_init__(self) -> None:
        count = len(self.codes)
        if self.used.shape != (count,) or self.values.shape != (count, OWN_COUNT):
            raise ValueError("each target has six numbers of movement and was used or not")
        if self.information.shape != (count, OWN_COUNT, OWN_COUNT):
            raise ValueError("each movement has a 6 x 6 information")

    def __len__(self) -> int:
        return len(self.codes)


@dataclass(frozen=True)
class SnapshotEvidence:
    """What one snapshot tells of the target map.

    Attributes
    ----------
    site_from_cam : Pose
        As it was adjusted.
    camera : Camera
        As it was adjusted.
    sigma0 : float
        Of the adjustment.
    movements : Movements
    unknown_codes : tuple of int
        Codes that were read without any correction and that the map does not hold.
    seen_codes : frozenset of int
        All that were read.
    """

    site_from_cam: Pose
    camera: Camera
    sigma0: float
    movements: Movements
    unknown_codes: tuple[int, ...]
    seen_codes: frozenset[int]


def gather_evidence(
    observations: Sequence[TargetObservation],
    target_map: TargetMap,
    resection: Resection,
    options: EvidenceOptions | None = None,
) -> SnapshotEvidence:
    """What a resected snapshot tells of the map.

    Parameters
    ----------
    observations : sequence of TargetObservation
        Those that were resected.
    target_map : TargetMap
        The map that they were resected in.
    resection : Resection
    options : EvidenceOptions, optional
    """
    options = options or EvidenceOptions()
    known = [seen for seen in observations if seen.code in target_map.by_code]
    fates = {target.code: target.used for target in resection.targets}
    used = np.array([fates[seen.code] for seen in known], dtype=np.bool_)
    look = _Look(resection.camera.camera, resection.site_from_cam, options)
    parts = []
    if used.any():
        parts.append(look.near(sight_targets(_chosen(known, used), target_map)))
    if not used.all():
        parts.append(look.afar(sight_targets(_chosen(known, ~used), target_map), target_map.u_m))
    return SnapshotEvidence(
        site_from_cam=resection.site_from_cam,
        camera=look.camera,
        sigma0=resection.sigma0,
        movements=_joined(parts),
        unknown_codes=tuple(seen.code for seen in observations if _is_surely_unknown(seen, target_map)),
        seen_codes=frozenset(seen.code for seen in observations),
    )


def _chosen(known: Sequence[TargetObservation], mask: Mask) -> list[TargetObservation]:
    return [seen for seen, wanted in zip(known, mask, strict=True) if wanted]


def _is_surely_unknown(seen: TargetObservation, target_map: TargetMap) -> bool:
    """Whether no digit was mended: a misread target of the map is not a new one."""
    return seen.code not in target_map.by_code and seen.corrected == 0 and seen.erased == 0


@dataclass(frozen=True)
class _Look:
    """How one photograph looks at targets: its camera and pose as they were adjusted."""

    camera: Camera
    site_from_cam: Pose
    options: EvidenceOptions

    def near(self, sighted: SightedTargets) -> Movements:
        """Movements of targets that carried the pose, so stand about where they are said to: one step from there."""
        return self._stepped(sighted, np.zeros((len(sighted), OWN_COUNT)), used=True)

    def afar(self, sighted: SightedTargets, u_m: float) -> Movements:
        """Movements of targets that may stand anywhere: found by their own planar pose, then one step from there."""
        plane_m = dots_target_m(u_m)[:, :2]
        poses = planar_poses(plane_m, self.camera.normalise(sighted.observed_px), sighted.measured)
        found = poses.exists[:, 0]
        sighted = sighted.take(found)
        rotations = np.ascontiguousarray(self.site_from_cam.rotation @ poses.rotations[found, 0])
        centres_m = np.ascontiguousarray(self.site_from_cam.apply(poses.translations_m[found, 0]))
        turns = rotations @ np.swapaxes(sighted.rotations, -1, -2)
        arms_m = np.ascontiguousarray(sighted.arms_m @ np.swapaxes(turns, -1, -2))
        there = np.concatenate([centres_m - sighted.centres_m, log_rotation(turns)], axis=-1)
        return self._stepped(
            replace(sighted, rotations=rotations, centres_m=centres_m, arms_m=arms_m), there, used=False
        )

    def _stepped(self, sighted: SightedTargets, start: Array, used: bool) -> Movements:
        """Movements after one step from a start, of those targets whose six numbers the dots determine."""
        exact = CameraPrior(self.camera, np.zeros((INTRINSIC_COUNT, INTRINSIC_COUNT)))
        equations = linearise(sighted, exact, State(self.site_from_cam, np.zeros(INTRINSIC_COUNT)))
        determined, steps = np.empty(len(sighted), dtype=np.bool_), np.empty((len(sighted), OWN_COUNT))
        step_movements(equations.gram, self.options.least_condition, determined, steps)
        sound = equations.seen_from_front & determined
        return Movements(
            sighted.codes[sound],
            np.full(int(sound.sum()), used),
            (start + steps)[sound],
            equations.gram[sound, :OWN_COUNT, :OWN_COUNT],
        )


def _joined(parts: Sequence[Movements]) -> Movements:
    return Movements(
        np.concatenate([part.codes for part in parts]),
        np.concatenate([part.used for part in parts]),
        np.concatenate([part.values for part in parts]),
        np.concatenate([part.information for part in parts]),
    )
