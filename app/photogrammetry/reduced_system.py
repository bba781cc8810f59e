"""The Schur complement: targets are eliminated block by block, what stays couples photographs that share a target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import bsr_array, csr_array

from app.photogrammetry.block_cholesky import BlockCholesky, BorderedMatrix, factorise
from app.photogrammetry.bundle_normals import NormalEquations
from app.photogrammetry.elimination_tree import EliminationNode, elimination_tree
from app.photogrammetry.network import POSE_COUNT
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Unknowns:
    """One column per right-hand side: photographs (6 P, k), targets (6 T, k), free shared unknowns (f, k)."""

    photos: Array
    targets: Array
    border: Array


@dataclass(frozen=True)
class ReducedSystem:
    """Normal equations with the targets eliminated and the rest factored.

    Attributes
    ----------
    factor : BlockCholesky
        Over photographs and the free shared unknowns.
    photo_target : bsr_array of shape (6 P, 6 T)
    target_inverse : ndarray of shape (T, 6, 6)
    target_border : ndarray of shape (6 T, f)
    """

    factor: BlockCholesky
    photo_target: bsr_array
    target_inverse: Array
    target_border: Array

    def solve(self, right: Unknowns) -> Unknowns:
        """Solution of the whole normal equations."""
        lifted = self._times_inverse(right.targets)
        reduced = np.concatenate(
            [right.photos - self.photo_target @ lifted, right.border - self.target_border.T @ lifted]
        )
        solution = self.factor.solve(reduced)
        photos, border = solution[: len(right.photos)], solution[len(right.photos) :]
        targets = right.targets - self.photo_target.T @ photos - self.target_border @ border
        return Unknowns(photos, self._times_inverse(targets), border)

    def _times_inverse(self, targets: Array) -> Array:
        blocks = targets.reshape(len(self.target_inverse), POSE_COUNT, -1)
        return np.asarray((self.target_inverse @ blocks).reshape(targets.shape))


def photo_graph_tree(sightings: Sightings) -> tuple[EliminationNode, ...]:
    """Order of elimination of the photographs; it depends on who sees what, not on any number."""
    ones = np.ones(len(sightings), dtype=np.float32)
    shape = sightings.photo_count, sightings.target_count
    seen = csr_array((ones, (sightings.photo, sightings.target)), shape=shape)
    return elimination_tree(csr_array(seen @ seen.T))


def reduce_normals(
    normals: NormalEquations, sightings: Sightings, free_border: Mask, nodes: Sequence[EliminationNode]
) -> ReducedSystem:
    """Eliminate the targets and factor the rest.

    Raises
    ------
    numpy.linalg.LinAlgError
        When the observations do not fix all unknowns.
    """
    inverse = np.asarray(np.linalg.inv(normals.targets), dtype=np.float64)
    target_border = normals.target_border[:, :, free_border].reshape(-1, int(free_border.sum()))
    photo_target = _blocks(normals.photo_target, sightings)
    gain = _blocks(normals.photo_target @ inverse[sightings.target], sightings)
    border = normals.border[np.ix_(free_border, free_border)]
    lifted = (inverse @ target_border.reshape(len(inverse), POSE_COUNT, -1)).reshape(target_border.shape)
    photo_border = normals.photo_border[:, :, free_border].reshape(-1, target_border.shape[1])
    matrix = BorderedMatrix(
        photos=bsr_array(_diagonal(normals.photos) - gain @ photo_target.T),
        photo_border=photo_border - gain @ target_border,
        border=border - target_border.T @ lifted,
    )
    return ReducedSystem(factorise(matrix, nodes), photo_target, inverse, target_border)


def _blocks(blocks: Array, sightings: Sightings) -> bsr_array:
    """Blocks of the sightings, shape (M, 6, 6), as a sparse matrix of photographs by targets."""
    starts = np.concatenate([[0], np.cumsum(sightings.targets_per_photo())])
    shape = POSE_COUNT * sightings.photo_count, POSE_COUNT * sightings.target_count
    return bsr_array((blocks, sightings.target, starts), shape=shape)


def _diagonal(blocks: Array) -> bsr_array:
    count = len(blocks)
    size = POSE_COUNT * count
    return bsr_array((blocks, np.arange(count), np.arange(count + 1)), shape=(size, size))
