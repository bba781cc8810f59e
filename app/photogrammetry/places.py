"""Places from which snapshots were taken: what is seen twice from one place errs in the same way twice."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


def places_of(positions_m: Array, reach_m: float) -> Index:
    """Number of the place of each position, shape (N,).

    Parameters
    ----------
    positions_m : ndarray of shape (N, 3)
    reach_m : float
        A position that is no farther than this from the first one of a place belongs to it.
    """
    places = np.empty(len(positions_m), dtype=np.intp)
    leaders_m = np.empty((0, 3))
    for row, position_m in enumerate(positions_m):
        distances_m = np.linalg.norm(leaders_m - position_m, axis=1)
        if len(leaders_m) and distances_m.min() <= reach_m:
            places[row] = int(distances_m.argmin())
        else:
            places[row] = len(leaders_m)
            leaders_m = np.vstack([leaders_m, position_m])
    return places
