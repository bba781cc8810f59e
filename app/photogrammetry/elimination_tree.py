"""In which order photographs are eliminated: nested dissection of the graph of photographs that share targets.

A building is a thin graph: a few photographs part it into halves that share no target. Eliminating the halves first and
the separator last keeps the factor small, so that its cost grows little faster than the number of photographs.
Source: George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10, 1973; separators are level
sets of a breadth-first search as in George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

Index = npt.NDArray[np.intp]
Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class DissectionOptions:
    """How far the graph is cut.

    Attributes
    ----------
    leaf_photos : int
        A part of at most this many photographs is eliminated at once, as one dense block: 64 photographs are a block
        of 384 unknowns, which a processor factors in a few milliseconds, less than cutting further would save.
    least_share : float
        Each side of a cut holds at least this share of the photographs.
    most_separator : float
        A separator of more than this share is not worth its cut; the part is then eliminated at once.
    """

    leaf_photos: int = 64
    least_share: float = 0.25
    most_separator: float = 0.5


@dataclass(frozen=True)
class EliminationNode:
    """Photographs that are eliminated together.

    Attributes
    ----------
    own : ndarray
        The photographs, eliminated after all descendants of the node.
    boundary : ndarray
        Photographs of ancestors that are coupled to the node's subtree.
    parent : int
        The node's parent in the sequence of nodes, -1 for a root.
    """

    own: Index
    boundary: Index
    parent: int


def elimination_tree(adjacency: csr_array, options: DissectionOptions | None = None) -> tuple[EliminationNode, ...]:
    """Nodes in an order of elimination, children before parents, which holds each photograph once.

    Parameters
    ----------
    adjacency : sparse array of shape (P, P)
        Symmetric; an entry where two photographs share a target.
    options : DissectionOptions, optional
    """
    parts, parents = _dissect(adjacency, options or DissectionOptions())
    # Parts were found from the root down; turned round, children stand before their parents.
    last = len(parts) - 1
    owns = parts[::-1]
    parent_of = [-1 if parent < 0 else last - parent for parent in parents[::-1]]
    return _with_boundaries(adjacency, owns, parent_of)


def _dissect(adjacency: csr_array, options: DissectionOptions) -> tuple[list[Index], list[int]]:
    """Separators and leaves from the root down, and for each the place of the separator above it."""
    parts: list[Index] = []
    parents: list[int] = []
    waiting = [(component, -1) for component in _components(adjacency, np.arange(adjacency.shape[0]))]
    while waiting:
        photos, parent = waiting.pop()
        separator = _separator(adjacency, photos, options)
        parts.append(separator)
        parents.append(parent)
        rest = np.setdiff1d(photos, separator)
        waiting += [(component, len(parts) - 1) for component in _components(adjacency, rest)]
    return parts, parents


def _components(adjacency: csr_array, photos: Index) -> list[Index]:
    if not len(photos):
        return []
    count, label = connected_components(adjacency[photos][:, photos], directed=False)
    order = np.argsort(label, kind="stable")
    return np.split(photos[order], np.searchsorted(label[order], np.arange(1, count)))


def _separator(adjacency: csr_array, photos: Index, options: DissectionOptions) -> Index:
    """Photographs whose removal parts the others of a connected set; the whole set when that does not pay."""
    if len(photos) <= options.leaf_photos:
        return photos
    graph = adjacency[photos][:, photos]
    level = _levels_from_the_edge(graph)
    sizes = np.bincount(level)
    before = (np.cumsum(sizes) - sizes) / len(photos)
    after = 1.0 - before - sizes / len(photos)
    balanced = np.flatnonzero((before >= options.least_share) & (after >= options.least_share))
    if not len(balanced):
        return photos
    cut = balanced[np.argmin(sizes[balanced])]
    beyond = graph @ (level == cut + 1).astype(np.float64)
    separator = photos[(level == cut) & (beyond > 0)]  # the rest of the level has no neighbour on the far side
    return photos if len(separator) > options.most_separator * len(photos) else separator


def _levels_from_the_edge(graph: csr_array) -> Index:
    """Steps of each vertex from one at the edge of the graph: the farthest from an arbitrary one."""
    start = int(np.argmax(dijkstra(graph, unweighted=True, indices=0)))
    return np.asarray(dijkstra(graph, unweighted=True, indices=start)).astype(np.intp)


def _with_boundaries(adjacency: csr_array, owns: list[Index], parents: list[int]) -> tuple[EliminationNode, ...]:
    """Symbolic factorisation: what each node's elimination couples."""
    node_of = np.empty(adjacency.shape[0], dtype=np.intp)
    for node, own in enumerate(owns):
        node_of[own] = node
    inherited: list[list[Index]] = [[] for _ in owns]
    nodes = []
    for node, own in enumerate(owns):
        coupled = np.unique(np.concatenate([adjacency[own].indices.astype(np.intp), *inherited[node]]))
        boundary = coupled[node_of[coupled] > node]
        if parents[node] >= 0:
            inherited[parents[node]].append(boundary)
        nodes.append(EliminationNode(own, boundary, parents[node]))
    return tuple(nodes)
