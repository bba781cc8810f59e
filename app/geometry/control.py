"""Control points fix the datum; check points take no part in the fit and judge it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.targets.layout import cell_of_dot

Role = Literal["control", "check"]


@dataclass(frozen=True)
class ControlPoint:
    """A surveyed dot of a target.

    Attributes
    ----------
    name : str
        Unique within a site.
    code : int
        The target's code.
    dot : str
        ``A`` ... ``E``, ``r0c0`` ... ``r3c3`` or ``centre`` (the plate's middle).
    position_m : ndarray of shape (3,)
        In the site frame.
    sigma_m : float
        Standard deviation of each coordinate.
    role : str
        ``control`` or ``check``.
    """

    name: str
    code: int
    dot: str
    position_m: npt.NDArray[np.float64]
    sigma_m: float
    role: Role

    def __post_init__(self) -> None:
        cell_of_dot(self.dot)
        if self.position_m.shape != (3,) or not np.isfinite(self.position_m).all():
            raise ValueError(f"control point {self.name}: three finite coordinates are needed")
        if not (np.isfinite(self.sigma_m) and self.sigma_m > 0):
            raise ValueError(f"control point {self.name}: sigma_m must be positive")
        if self.role not in ("control", "check"):
            raise ValueError(f"control point {self.name}: role {self.role!r} is neither control nor check")

    @property
    def cell(self) -> int | None:
        """Row-major cell of the dot; None for the plate's middle."""
        return cell_of_dot(self.dot)
