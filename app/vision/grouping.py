"""Five red blobs that lie like a plate's base dots.

Along the diagonal A stands at -1, E at 0, the crossing f of the diagonals at 0.5 and C at 2 (in diagonal pitches).
Three images of known points of a line fix the projective map of that line, so A, E and C tell where f is: this is the
cross-ratio (ab, fc) = 0.5 of the paper, solved for f. B and D then face each other through f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.vision.dots import Blobs
from app.vision.kernels.groups import find_groups
from app.vision.kernels.neighbours import find_nearest

Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class GroupingOptions:
    """How far five blobs may deviate from a plate's geometry.

    Attributes
    ----------
    neighbours : int
        Blobs of like size about E that are looked at: four of its own plate and those of the plates around it, which
        stand farther off than C unless plates touch.
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


def group_base_dots(blobs: Blobs, least_focal_px: float, options: GroupingOptions = GroupingOptions()) -> Indices:
    """Candidates A, B, C, D, E as blob indices, shape (G, 5); a blob may stand in several.

    Parameters
    ----------
    blobs : Blobs
    least_focal_px : float
        Least focal length that the camera can have: it bounds the perspective on a plate.
    options : GroupingOptions
    """
    nearest = nearest_of_like_size(blobs, options)
    bounds = (
        *options.diagonal_pitch_axes,
        least_focal_px,
        options.depth_slope,
        options.noise_px,
        options.lateral_max,
        options.lateral_px,
        options.facing_max,
        options.facing_px,
        *options.reach,
    )
    major_px = np.ascontiguousarray(blobs.semi_axes_px[:, 0])
    return find_groups(np.ascontiguousarray(blobs.centres_px), major_px, nearest, bounds, options.nearest_a)


def nearest_of_like_size(blobs: Blobs, options: GroupingOptions) -> Indices:
    """The nearest blobs of like size of each blob, shape (N, K), nearest first, -1 where there are no more."""
    nearest = np.empty((len(blobs), options.neighbours), dtype=np.int64)
    if len(blobs):
        centres_px, semi_axes_px = (np.ascontiguousarray(part) for part in (blobs.centres_px, blobs.semi_axes_px))
        find_nearest(centres_px, semi_axes_px, options.area_ratio_max, nearest)
    return nearest
