"""The sparse factor against dense algebra, and the order of elimination that keeps it small."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import bsr_array, csr_array

from app.photogrammetry.block_cholesky import BorderedMatrix, factorise
from app.photogrammetry.elimination_tree import DissectionOptions, EliminationNode, elimination_tree

Array = npt.NDArray[np.float64]
SMALL_LEAVES = DissectionOptions(leaf_photos=4)


def random_matrix(rng: np.random.Generator, photos: int, reach: int, border: int) -> tuple[BorderedMatrix, Array]:
    """A random positive definite matrix of a chain in which photographs within a reach share targets; dense too."""
    near = np.abs(np.subtract.outer(np.arange(photos), np.arange(photos))) <= reach
    near &= rng.random((photos, photos)) < 0.8
    near |= near.T | np.eye(photos, dtype=bool)
    order = rng.permutation(photos)  # photographs come unordered
    near = near[np.ix_(order, order)]
    size = 6 * photos
    dense = rng.normal(size=(size + border, size + border))
    dense[:size, :size] *= np.kron(near, np.ones((6, 6)))
    dense = (dense + dense.T) / 2.0
    dense += np.diag(np.abs(dense).sum(axis=0) + 1.0)
    sparse = bsr_array(dense[:size, :size], blocksize=(6, 6))
    return BorderedMatrix(sparse, dense[:size, size:], dense[size:, size:]), dense


def tree_of(matrix: BorderedMatrix, options: DissectionOptions) -> tuple[EliminationNode, ...]:
    blocks = matrix.photos
    pattern = csr_array(
        (np.ones(len(blocks.indices)), blocks.indices, blocks.indptr), shape=(blocks.shape[0] // 6,) * 2
    )
    return elimination_tree(pattern, options)


@settings(deadline=None)
@given(st.integers(1, 30), st.integers(0, 4), st.integers(1, 11), st.integers(0, 2**32 - 1))
def test_solve_and_inverse_agree_with_dense_algebra(photos: int, reach: int, border: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    matrix, dense = random_matrix(rng, photos, reach, border)
    factor = factorise(matrix, tree_of(matrix, SMALL_LEAVES))
    right = rng.normal(size=(len(dense), 3))
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(dense, right), atol=1e-9)
    inverse = np.linalg.inv(dense)
    np.testing.assert_allclose(factor.border_inverse(), inverse[6 * photos :, 6 * photos :], atol=1e-9)
    for front in factor.inverse_fronts():
        unknowns = (6 * front.photos[:, None] + np.arange(6)).ravel()
        unknowns = np.concatenate([unknowns, np.arange(6 * photos, len(dense))])
        np.testing.assert_allclose(front.inverse, inverse[np.ix_(unknowns, unknowns)], atol=1e-9)


@settings(deadline=None)
@given(st.integers(1, 60), st.integers(0, 5), st.integers(0, 2**32 - 1))
def test_each_photograph_is_eliminated_once_and_neighbours_share_a_front(photos: int, reach: int, seed: int) -> None:
    matrix, _ = random_matrix(np.random.default_rng(seed), photos, reach, 1)
    nodes = tree_of(matrix, SMALL_LEAVES)
    assert sorted(np.concatenate([node.own for node in nodes]).tolist()) == list(range(photos))
    node_of = {int(photo): index for index, node in enumerate(nodes) for photo in node.own}
    for index, node in enumerate(nodes):
        assert node.parent == -1 or node.parent > index
        assert all(node_of[int(photo)] > index for photo in node.boundary)
    for first in range(photos):
        for second in matrix.photos.indices[matrix.photos.indptr[first] : matrix.photos.indptr[first + 1]]:
            front = nodes[min(node_of[first], node_of[int(second)])]
            assert {first, int(second)} <= set(front.own.tolist()) | set(front.boundary.tolist())


def test_a_matrix_that_is_not_positive_definite_is_refused() -> None:
    matrix, _ = random_matrix(np.random.default_rng(0), 8, 2, 2)
    worse = BorderedMatrix(bsr_array(-matrix.photos), matrix.photo_border, matrix.border)
    with pytest.raises(np.linalg.LinAlgError):
        factorise(worse, tree_of(worse, SMALL_LEAVES))


def grid_factor_entries(side: int) -> int:
    """Entries of the factor of a hall of side x side photographs, each sharing targets with those within two steps."""
    x, y = np.divmod(np.arange(side * side), side)
    near = (np.abs(np.subtract.outer(x, x)) <= 2) & (np.abs(np.subtract.outer(y, y)) <= 2)
    nodes = elimination_tree(csr_array(near.astype(np.float64)))
    return sum(36 * len(node.own) * (len(node.own) + len(node.boundary)) for node in nodes)


def test_the_factor_of_a_hall_grows_nearly_linearly() -> None:
    sides = np.array([15, 30, 60])
    entries = np.log([grid_factor_entries(side) for side in sides])
    exponent = (entries[2] - entries[1]) / np.log(4.0)
    # A dense factor has exponent 2, nested dissection of a plane graph n log n; the adjustment is to stay below 1.3.
    assert exponent < 1.3
