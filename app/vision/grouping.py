"""Five red blobs that lie like a plate's base dots.

Along the diagonal A stands at -1, E at 0, the crossing f of the diagonals at 0.5 and C at 2 (in diagonal pitches).
Three images of known points of a line fix the projective map of that line, so A, E and C tell where f is: this is the
cross-ratio (ab, fc) = 0.5 of the paper, solved for f. B and D then face each other through f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from app.vision.dots import Blobs
from app.vision.homography import cross

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

# Positions along the diagonal in its own pitch, E at 0.
POSITION_F, POSITION_C = 0.5, 2.0

CLASS_OCTAVES = 2  # blobs are searched by classes of area, each four times the last


@dataclass(frozen=True)
class GroupingOptions:
    """How far five blobs may deviate from a plate's geometry.

    Attributes
    ----------
    neighbours : int
        Blobs about E that are looked at: four of its own plate and those of the plates around it, which stand
        farther off than C unless plates touch.
    nearest_a : int
        A is the base dot nearest to E: it stands among this many of the nearest blobs, even between touching plates.
    area_ratio_max : float
        Greatest ratio of two dots' areas: perspective gives 1.5 on a near plate, noise on small dots the rest.
    diagonal_pitch_axes : tuple of float
        |EA| over the major semi-axis of E: 4.24 frontal, foreshortened to 1.1 at 75 degrees; above, for outlines that
        glare made small.
    depth_slope : float
        How much depth may change over a plate, per length in the picture over focal length: tan of 75 degrees. Small
        plates are seen almost without perspective, and that leaves few chance groups.
    noise_px : float
        Error of a distance between two blobs, px.
    lateral_max, lateral_px : float
        How far C may lie off the line A-E, as part of |EC| and in px of noise.
    facing_max, facing_px : float
        How far B and D may be from facing each other through f (sine of the angle), and in px of noise.
    reach : tuple of float
        |fB| and |fD| over |fA|: 1 frontal; foreshortening takes one diagonal down.
    """

    neighbours: int = 12
    nearest_a: int = 6
    area_ratio_max: float = 3.5
    diagonal_pitch_axes: tuple[float, float] = (1.0, 10.0)
    depth_slope: float = 3.7
    noise_px: float = 1.5
    lateral_max: float = 0.12
    lateral_px: float = 1.2
    facing_max: float = 0.1
    facing_px: float = 1.5
    reach: tuple[float, float] = (0.25, 4.0)


@dataclass(frozen=True)
class _Triples:
    """E, A, C in line, with the predicted crossing of the diagonals and how much depth may change along A-C."""

    e: Indices
    a: Indices
    c: Indices
    crossing_px: Array
    depth_ratio: Array


def group_base_dots(blobs: Blobs, least_focal_px: float, options: GroupingOptions = GroupingOptions()) -> Indices:
    """Candidates A, B, C, D, E as blob indices, shape (G, 5); a blob may stand in several.

    Parameters
    ----------
    blobs : Blobs
    least_focal_px : float
        Least focal length that the camera can have: it bounds the perspective on a plate.
    options : GroupingOptions
    """
    nearest, alike = neighbours_of_like_size(blobs, options)
    triples = _diagonals(blobs, nearest, alike, (least_focal_px, options))
    return _with_other_diagonal(blobs, nearest, alike, triples, options)


def neighbours_of_like_size(blobs: Blobs, options: GroupingOptions) -> tuple[Indices, npt.NDArray[np.bool_]]:
    """The nearest blobs of like size of each blob, shape (N, K), and which of these slots are filled.

    Sizes are searched apart, so that specks between the dots of a large plate do not use up its neighbours.
    """
    count = len(blobs)
    nearest = np.zeros((count, options.neighbours), dtype=np.intp)
    alike = np.zeros((count, options.neighbours), dtype=np.bool_)
    area_px2 = blobs.semi_axes_px.prod(axis=1)
    size_class = np.floor(np.log2(area_px2) / CLASS_OCTAVES).astype(np.int64)
    for size in np.unique(size_class):
        members = np.flatnonzero(size_class == size)
        reach = options.area_ratio_max
        least, most = 2.0 ** (CLASS_OCTAVES * np.array([size, size + 1]))
        near_size = (area_px2 * reach > least) & (area_px2 < reach * most)
        pool = np.flatnonzero(near_size)
        _, found = cKDTree(blobs.centres_px[pool]).query(blobs.centres_px[members], k=options.neighbours + 1)
        exists = found[:, 1:] < len(pool)  # the tree answers with its length where there are too few
        slots = pool[np.minimum(found[:, 1:], len(pool) - 1)]
        ratio = area_px2[slots] / area_px2[members, None]
        nearest[members] = slots
        alike[members] = exists & (ratio < reach) & (ratio > 1.0 / reach)
    return nearest, alike


def _diagonals(
    blobs: Blobs, nearest: Indices, alike: npt.NDArray[np.bool_], bounds: tuple[float, GroupingOptions]
) -> _Triples:
    """All (E, A, C) in which C lies beyond E on the line from A, about twice as far."""
    least_focal_px, options = bounds
    from_e_px = blobs.centres_px[nearest] - blobs.centres_px[:, None]
    distance_px = np.hypot(from_e_px[..., 0], from_e_px[..., 1])
    axes = distance_px / blobs.semi_axes_px[:, :1]
    least, most = options.diagonal_pitch_axes
    near = np.arange(nearest.shape[1]) < options.nearest_a
    e, slot_a = np.nonzero(alike & near & (axes > least) & (axes < most))
    to_a_px, length_px = from_e_px[e, slot_a], distance_px[e, slot_a][:, None]
    along = -np.einsum("mkc,mc->mk", from_e_px[e], to_a_px) / length_px**2
    across = np.abs(cross(to_a_px[:, None], from_e_px[e])) / length_px**2
    # Perspective stretches the far or the near part of a diagonal by no more than the depth changes along it.
    depth_ratio = 1.0 + options.depth_slope * (1.0 + along) * length_px / least_focal_px
    noise = options.noise_px * (1.0 + POSITION_C) / length_px
    stretched = (along > POSITION_C / depth_ratio - noise) & (along < POSITION_C * depth_ratio + noise) & (along > 0)
    in_line = across < options.lateral_max * along + options.lateral_px / length_px
    row, slot_c = np.nonzero(alike[e] & stretched & in_line)
    a, c = nearest[e[row], slot_a[row]], nearest[e[row], slot_c]
    # x -> alpha x / (1 + beta x) takes -1, 0, 2 to -1, 0, s with s = |EC| / |EA|.
    s = along[row, slot_c]
    beta = (POSITION_C - s) / (POSITION_C * (1.0 + s))
    position_f = (1.0 - beta) * POSITION_F / (1.0 + beta * POSITION_F)
    a_px, c_px = blobs.centres_px[a], blobs.centres_px[c]
    crossing_px = a_px + (c_px - a_px) * ((position_f + 1.0) / (s + 1.0))[:, None]
    return _Triples(e[row], a, c, crossing_px, depth_ratio[row, slot_c])


def _with_other_diagonal(
    blobs: Blobs, nearest: Indices, alike: npt.NDArray[np.bool_], triples: _Triples, options: GroupingOptions
) -> Indices:
    """Complete each (E, A, C) by the pairs (B, D) that face each other through f, B clockwise from A."""
    from_f_px = blobs.centres_px[nearest[triples.e]] - triples.crossing_px[:, None]
    reach_px = np.hypot(from_f_px[..., 0], from_f_px[..., 1])
    fa_px = blobs.centres_px[triples.a] - triples.crossing_px
    half_px = np.hypot(fa_px[:, 0], fa_px[:, 1])[:, None]
    within = alike[triples.e] & (reach_px > options.reach[0] * half_px) & (reach_px < options.reach[1] * half_px)
    side = cross(fa_px[:, None], from_f_px)
    # Pairs are formed only among the few blobs on either side, not over all neighbours squared.
    row_b, slot_b = np.nonzero(within & (side > 0))
    row_d, slot_d = np.nonzero(within & (side < 0))
    first_d, last_d = np.searchsorted(row_d, row_b), np.searchsorted(row_d, row_b, side="right")
    counts = last_d - first_d
    pair_b = np.repeat(np.arange(len(row_b)), counts)
    pair_d = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first_d, counts)
    row, b, d = row_b[pair_b], slot_b[pair_b], slot_d[pair_d]
    fb_px, fd_px, reach_b, reach_d = from_f_px[row, b], from_f_px[row, d], reach_px[row, b], reach_px[row, d]
    sine = cross(fb_px, fd_px) / (reach_b * reach_d)
    facing = options.facing_max + options.facing_px / np.minimum(reach_b, reach_d)
    opposite = np.einsum("mc,mc->m", fb_px, fd_px) < 0
    balanced = np.maximum(reach_b, reach_d) < triples.depth_ratio[row] * np.minimum(reach_b, reach_d) + options.noise_px
    keep = opposite & balanced & (np.abs(sine) < facing)
    row, b, d = row[keep], b[keep], d[keep]
    e = triples.e[row]
    return np.stack([triples.a[row], nearest[e, b], triples.c[row], nearest[e, d], e], axis=1)
