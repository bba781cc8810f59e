"""A shadow that falls over a surface: the edge of a window frame or a shelf in strong light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.planning.surfaces import Samples, Surface

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ShadowedSurface:
    """A surface of which one side of a straight edge gets less light.

    Attributes
    ----------
    surface : Surface
    towards : tuple of float
        Direction, in the panel's plane and of length 1, that leads into the shadow.
    edge_m : float
        Where the middle of the edge lies along that direction.
    penumbra_m : float
        Width over which the light falls, positive.
    share : float
        Of the light that is left in the shadow.
    """

    surface: Surface
    towards: tuple[float, float]
    edge_m: float
    penumbra_m: float
    share: float

    def __post_init__(self) -> None:
        if not (self.penumbra_m > 0 and 0 <= self.share <= 1):
            raise ValueError("a shadow has a penumbra of positive width and leaves a share of the light, 0 ... 1")

    @property
    def detail_m(self) -> float | None:
        """That of the surface below."""
        return self.surface.detail_m

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3)."""
        inward_m = self.towards[0] * samples.x_m + self.towards[1] * samples.y_m - self.edge_m
        depth = np.clip(inward_m / self.penumbra_m + 0.5, 0.0, 1.0)
        return np.asarray(self.surface.albedo(samples) * (1.0 - (1.0 - self.share) * depth)[..., None])
