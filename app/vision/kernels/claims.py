"""Which groups of blobs stand when no blob may stand in two."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Indices = npt.NDArray[np.int64]


@compiled("int64(int64[:, ::1], int64[::1], int64[::1])")
def keep_apart(groups: Indices, order: Indices, kept: Indices) -> int:
    """Take groups in an order, each unless it shares a blob with one taken before; how many were kept.

    Parameters
    ----------
    groups : ndarray of shape (G, 5)
        Blob indices, -1 for a dot that was not seen.
    order : ndarray of shape (G,)
    kept : ndarray of shape (G,), written
    """
    taken = np.zeros(groups.max() + 2 if groups.size else 1, dtype=np.bool_)
    count = 0
    for group in order:
        free = True
        for blob in groups[group]:
            free = free and not (blob >= 0 and taken[blob])
        if free:
            kept[count] = group
            count += 1
            for blob in groups[group]:
                taken[max(blob, -1)] = True  # the last place is that of the dots not seen
    return count
