"""The inverse of the normal equations where it is wanted: each photograph, and each target with all that sees it.

With V a target's own block and W its coupling with the photographs and shared unknowns, of which Z is the inverse of
the Schur complement, the target's covariance is V^-1 + G Z G' with G = -V^-1 W. All photographs that see a target share
a front of the factor, so Z is at hand without any inverse of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.block_cholesky import InverseFront
from app.photogrammetry.network import POSE_COUNT
from app.photogrammetry.reduced_system import ReducedSystem
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class TargetPart:
    """One target with the n = 6 rays + f unknowns that it meets.

    Attributes
    ----------
    target : int
    rows : ndarray of shape (rays,)
        Its sightings.
    gain : ndarray of shape (6, n)
        Derivative of the target by those unknowns: photographs in the order of the rows, then the shared ones.
    inverse : ndarray of shape (n, n)
        Their covariance.
    """

    target: int
    rows: Index
    gain: Array
    inverse: Array


@dataclass(frozen=True)
class FrontPart:
    """What one front tells: its own photographs with their covariances (p, 6, 6), and the targets that it completes."""

    photos: Index
    photo_covariances: Array
    targets: Iterator[TargetPart]


def inverse_parts(reduced: ReducedSystem, sightings: Sightings) -> Iterator[FrontPart]:
    """All photographs and all targets, each once; the targets of a part are to be read before the next part."""
    factor = reduced.factor
    eliminated_by = np.empty(sightings.photo_count, dtype=np.intp)
    for index, node in enumerate(factor.nodes):
        eliminated_by[node.own] = index
    # The front of the photograph that is eliminated first holds all photographs of a target.
    complete_in = np.full(sightings.target_count, len(factor.nodes))
    np.minimum.at(complete_in, sightings.target, eliminated_by[sightings.photo])
    order = np.argsort(sightings.target, kind="stable")
    rows = np.split(order, np.cumsum(sightings.rays())[:-1])
    for front in factor.inverse_fronts():
        own = len(factor.nodes[front.node].own)
        blocks = front.inverse[: POSE_COUNT * own, : POSE_COUNT * own].reshape(own, POSE_COUNT, own, POSE_COUNT)
        every = np.arange(own)
        targets = np.flatnonzero(complete_in == front.node)
        parts = _target_parts(reduced, sightings, front, [rows[target] for target in targets])
        yield FrontPart(front.photos[:own], blocks[every, :, every], parts)


def _target_parts(
    reduced: ReducedSystem, sightings: Sightings, front: InverseFront, rows_of_targets: list[Index]
) -> Iterator[TargetPart]:
    border_count = len(reduced.factor.border)
    place = np.empty(sightings.photo_count, dtype=np.intp)
    place[front.photos] = np.arange(len(front.photos))
    border = POSE_COUNT * len(front.photos) + np.arange(border_count)
    for rows in rows_of_targets:
        target = int(sightings.target[rows[0]])
        held = place[sightings.photo[rows]]
        unknowns = np.concatenate([(POSE_COUNT * held[:, None] + np.arange(POSE_COUNT)).ravel(), border])
        # One block (photograph by target) per sighting, in the order of the sightings.
        with_photos = reduced.photo_target.data[rows].reshape(-1, POSE_COUNT)
        with_border = reduced.target_border[POSE_COUNT * target : POSE_COUNT * (target + 1)]
        gain = -reduced.target_inverse[target] @ np.concatenate([with_photos.T, with_border], axis=1)
        yield TargetPart(target, rows, gain, front.inverse[np.ix_(unknowns, unknowns)])
