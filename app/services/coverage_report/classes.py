"""Classes of a heat map: round lengths between which radii are told apart by colour."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Ink
from app.services.reporting.numbers import MM_PER_M

Array = npt.NDArray[np.float64]
Classes = npt.NDArray[np.intp]

INKS: tuple[Ink, ...] = ("size1", "size2", "size3", "size4", "size5")
NOT_LOCATED = len(INKS)
ROUND_MM = np.outer(10.0 ** np.arange(-2, 6), [1.0, 2.0, 5.0]).ravel()
USUAL_SHARE = (0.05, 0.95)  # of the radii, between which the classes lie


def round_edges_m(radii_m: Array) -> Array:
    """Round lengths, shape (4,), that part finite radii in five classes; evenly in the series 1, 2, 5."""
    finite_mm = MM_PER_M * radii_m[np.isfinite(radii_m)]
    low_mm, high_mm = np.quantile(finite_mm, USUAL_SHARE) if len(finite_mm) else (1.0, 10.0)
    first = int(np.clip(np.searchsorted(ROUND_MM, low_mm, "right"), 0, len(ROUND_MM) - len(INKS)))
    last = int(np.clip(np.searchsorted(ROUND_MM, high_mm, "right"), first + len(INKS) - 2, len(ROUND_MM) - 1))
    chosen = np.linspace(first, last, len(INKS) - 1).round().astype(np.intp)
    return np.asarray(ROUND_MM[chosen] / MM_PER_M)


def class_of(radii_m: Array, edges_m: Array) -> Classes:
    """Class of each radius: 0 the smallest; ``NOT_LOCATED`` where it is infinite."""
    classes = np.searchsorted(edges_m, radii_m, "left")
    return np.where(np.isfinite(radii_m), classes, NOT_LOCATED)


def names_of(edges_m: Array) -> list[str]:
    """What each class holds, with its unit."""
    edges = [f"{MM_PER_M * edge_m:g}" for edge_m in edges_m]
    between = [f"{low} to {high} mm" for low, high in pairwise(edges)]
    return [f"up to {edges[0]} mm", *between, f"over {edges[-1]} mm"]
