"""A batch of sheets printed together: which targets are on it, and how long its check bars came out."""

from __future__ import annotations

from dataclasses import dataclass

from app.targets.sheet import BAR_MM


@dataclass(frozen=True)
class PrintBatch:
    """Sheets printed in one go, on one printer with one setting.

    Attributes
    ----------
    name : str
        Unique within a site.
    codes : tuple of int
        Of its targets, ascending.
    bar_across_mm, bar_along_mm : float
        Measured lengths of the check bars, across (the plates' x) and along the paper (the plates' y).
    sigma_mm : float
        Standard deviation of the measured lengths.
    """

    name: str
    codes: tuple[int, ...]
    bar_across_mm: float
    bar_along_mm: float
    sigma_mm: float

    def __post_init__(self) -> None:
        if not self.name or not self.codes or list(self.codes) != sorted(set(self.codes)):
            raise ValueError("a print batch has a name, and codes that ascend and are each told once")
        if min(self.bar_across_mm, self.bar_along_mm, self.sigma_mm) <= 0:
            raise ValueError("the lengths of bars and their sigma are positive")

    @property
    def scale_xy(self) -> tuple[float, float]:
        """Printed over nominal length along the plates' x and y."""
        return self.bar_across_mm / BAR_MM, self.bar_along_mm / BAR_MM

    @property
    def scale_sigma(self) -> float:
        """Standard deviation of either scale."""
        return self.sigma_mm / BAR_MM
