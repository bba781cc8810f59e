"""Cholesky factor of a sparse symmetric matrix of 6 x 6 blocks with a dense border, and the part of its inverse on it.

The multifrontal method: each node of the elimination tree gathers its rows and its children's updates in one small
dense matrix, so that all arithmetic is dense and there are as many steps as nodes, not as photographs.
Sources: Duff and Reid, ACM TOMS 9(3), 1983 (fronts); Takahashi, Fagan and Chin, PICA 1973 (inverse on the pattern).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse import bsr_array

from app.photogrammetry.elimination_tree import EliminationNode
from app.photogrammetry.network import POSE_COUNT

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class BorderedMatrix:
    """A symmetric positive definite matrix over P photographs (6 unknowns each) and b unknowns shared by them.

    Attributes
    ----------
    photos : bsr_array of shape (6 P, 6 P)
        Both triangles, blocks of 6 x 6.
    photo_border : ndarray of shape (6 P, b)
    border : ndarray of shape (b, b)
    """

    photos: bsr_array
    photo_border: Array
    border: Array


@dataclass(frozen=True)
class InverseFront:
    """Entries of the inverse among the photographs of one node and the border.

    Attributes
    ----------
    node : int
        The node of the elimination tree.
    photos : ndarray of shape (n,)
        Its own photographs, then its boundary.
    inverse : ndarray of shape (6 n + b, 6 n + b)
        Rows: the photographs' unknowns in that order, then the border's.
    """

    node: int
    photos: Index
    inverse: Array


@dataclass(frozen=True)
class BlockCholesky:
    """The factor: per node the triangle of its own unknowns and the rows below it, then the border's triangle.

    Attributes
    ----------
    nodes : sequence of EliminationNode
    diagonals, belows : tuple of ndarray
        Of each node, shapes (6 own, 6 own) and (6 boundary + b, 6 own).
    border : ndarray of shape (b, b)
    photo_count : int
    """

    nodes: Sequence[EliminationNode]
    diagonals: tuple[Array, ...]
    belows: tuple[Array, ...]
    border: Array
    photo_count: int

    def solve(self, right: Array) -> Array:
        """Solution of shape (6 P + b, k) for right-hand sides of that shape, photographs first."""
        x = right.copy()
        first_border = POSE_COUNT * self.photo_count
        places = [self._places(node) for node in self.nodes]
        for (own, rest), diagonal, below in zip(places, self.diagonals, self.belows, strict=True):
            x[own] = solve_triangular(diagonal, x[own], lower=True)
            x[rest] -= below @ x[own]
        x[first_border:] = solve_triangular(self.border, x[first_border:], lower=True)
        x[first_border:] = solve_triangular(self.border, x[first_border:], lower=True, trans=1)
        for (own, rest), diagonal, below in reversed(list(zip(places, self.diagonals, self.belows, strict=True))):
            x[own] = solve_triangular(diagonal, x[own] - below.T @ x[rest], lower=True, trans=1)
        return x

    def inverse_fronts(self) -> Iterator[InverseFront]:
        """The inverse, node by node from the root, wherever two unknowns stand in one front.

        Any two photographs that share a target stand together in the front of the one that is eliminated first.
        """
        inverse = {-1: self.border_inverse()}
        waiting = [0] * len(self.nodes)  # children that still need a node's part
        for node in self.nodes:
            if node.parent >= 0:
                waiting[node.parent] += 1
        for index in reversed(range(len(self.nodes))):
            node = self.nodes[index]
            front = self._inverse_of(index, inverse[node.parent])
            if waiting[index]:
                inverse[index] = front
            if node.parent >= 0:
                waiting[node.parent] -= 1
                if not waiting[node.parent]:
                    del inverse[node.parent]
            yield InverseFront(index, np.concatenate([node.own, node.boundary]), front)

    def border_inverse(self) -> Array:
        """The inverse among the border's unknowns, shape (b, b)."""
        triangle = solve_triangular(self.border, np.eye(len(self.border)), lower=True)
        return np.asarray(triangle.T @ triangle)

    def _inverse_of(self, index: int, parent_inverse: Array) -> Array:
        """Inverse on the front of a node, from the inverse on its parent's front."""
        node, border_count = self.nodes[index], len(self.border)
        held = np.arange(0)
        if node.parent >= 0:
            parent = self.nodes[node.parent]
            held = _position_in(np.concatenate([parent.own, parent.boundary]), node.boundary)
        places = np.concatenate([_unknowns(held), np.arange(len(parent_inverse) - border_count, len(parent_inverse))])
        rest = parent_inverse[np.ix_(places, places)]
        inverse_diagonal = solve_triangular(self.diagonals[index], np.eye(len(self.diagonals[index])), lower=True)
        gain = self.belows[index] @ inverse_diagonal
        across = -rest @ gain
        own = inverse_diagonal.T @ inverse_diagonal - gain.T @ across
        return np.block([[own, across.T], [across, rest]])

    def _places(self, node: EliminationNode) -> tuple[Index, Index]:
        """Where the unknowns of a node and those below it stand among all."""
        border = POSE_COUNT * self.photo_count + np.arange(len(self.border))
        return _unknowns(node.own), np.concatenate([_unknowns(node.boundary), border])


def factorise(matrix: BorderedMatrix, nodes: Sequence[EliminationNode]) -> BlockCholesky:
    """Factor a matrix in the order of an elimination tree of its photographs.

    Raises
    ------
    numpy.linalg.LinAlgError
        When the matrix is not positive definite.
    """
    # Updates wait at the parent of the node that made them; those of roots (parent -1) wait for the border.
    waiting: list[list[tuple[Index, Array]]] = [[] for _ in range(len(nodes) + 1)]
    diagonals, belows = [], []
    for index, node in enumerate(nodes):
        front = _front(matrix, node, waiting[index])
        waiting[index] = []
        own = POSE_COUNT * len(node.own)
        diagonals.append(cholesky(front[:own, :own], lower=True))
        belows.append(solve_triangular(diagonals[-1], front[own:, :own].T, lower=True).T)
        waiting[node.parent].append((node.boundary, front[own:, own:] - belows[-1] @ belows[-1].T))
    border = matrix.border + sum(update for _, update in waiting[-1])
    photo_count = matrix.photos.shape[0] // POSE_COUNT
    return BlockCholesky(nodes, tuple(diagonals), tuple(belows), cholesky(border, lower=True), photo_count)


def _front(matrix: BorderedMatrix, node: EliminationNode, updates: list[tuple[Index, Array]]) -> Array:
    """The dense matrix of one node: its own rows of the matrix and its children's updates."""
    photos, border_count = np.concatenate([node.own, node.boundary]), len(matrix.border)
    size = POSE_COUNT * len(photos) + border_count
    front = np.zeros((size, size))
    own = POSE_COUNT * len(node.own)
    front[: size - border_count, :own] = _own_columns(matrix.photos, node.own, photos)
    front[size - border_count :, :own] = matrix.photo_border[_unknowns(node.own)].T
    for boundary, update in updates:
        held = _unknowns(_position_in(photos, boundary))
        places = np.concatenate([held, np.arange(size - border_count, size)])
        front[np.ix_(places, places)] += update
    return front


def _own_columns(matrix: bsr_array, own: Index, photos: Index) -> Array:
    """The matrix' columns of a node's photographs, rows of its whole front, shape (6 n, 6 own)."""
    counts = np.diff(matrix.indptr)[own]
    block = np.repeat(matrix.indptr[own] - np.cumsum(counts) + counts, counts) + np.arange(counts.sum())
    column = np.repeat(np.arange(len(own)), counts)
    row = _position_in(photos, matrix.indices[block].astype(np.intp))
    held = row >= 0  # blocks of descendants have been eliminated
    columns = np.zeros((len(photos), POSE_COUNT, len(own), POSE_COUNT))
    # The matrix is symmetric: its rows, block by block transposed, are its columns.
    columns[row[held], :, column[held], :] = np.swapaxes(matrix.data[block[held]], -1, -2)
    return columns.reshape(POSE_COUNT * len(photos), POSE_COUNT * len(own))


def _position_in(photos: Index, wanted: Index) -> Index:
    """Place of each wanted photograph in a list, -1 where it is not in it."""
    order = np.argsort(photos)
    place = np.minimum(np.searchsorted(photos, wanted, sorter=order), len(photos) - 1)
    return np.where(photos[order[place]] == wanted, order[place], -1)


def _unknowns(photos: Index) -> Index:
    """Places of the six unknowns of each photograph."""
    return (POSE_COUNT * photos[:, None] + np.arange(POSE_COUNT)).ravel()
