"""A plate bent round a pillar: narrow flat strips, each showing its part of the print."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.scene import Panel
from app.planning.surfaces import Samples, Surface
from app.targets.layout import dots_target_m

Floats = npt.NDArray[np.float64]

STRIPS_PER_U = 2  # over 0.5 u a pillar of 10 u in radius departs from its chord by 0.003 u
OVERLAP = 1.0  # of a strip, beyond each side: no pixel sees a gap between neighbours, which depart by 0.01 u there


@dataclass(frozen=True)
class _Strip:
    """A part of a surface.

    Attributes
    ----------
    whole : Surface
    middle_m : float
        Where the strip's middle lies along the whole's x.
    """

    whole: Surface
    middle_m: float

    @property
    def detail_m(self) -> float | None:
        """That of the whole."""
        return self.whole.detail_m

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3)."""
        return self.whole.albedo(Samples(samples.x_m + self.middle_m, samples.y_m, samples.by_step_m))


def bent_panels(flat: Panel, u_m: float, radius_m: float) -> tuple[Panel, ...]:
    """The flat sheet as it lies on an upright pillar, its middle where the flat sheet's is.

    Parameters
    ----------
    flat : Panel
    u_m : float
        The plate's module: how finely it is cut.
    radius_m : float
        The pillar's; its axis runs along the sheet's y.
    """
    count = int(np.ceil(flat.width_m / u_m * STRIPS_PER_U))
    width_m = flat.width_m / count
    panels = []
    for index in range(count):
        middle_m = (index + 0.5) * width_m - flat.width_m / 2
        pose = _on_pillar(middle_m, radius_m)
        panels.append(
            Panel(
                flat.site_from_panel.compose(pose),
                width_m * (1.0 + 2.0 * OVERLAP),
                flat.height_m,
                _Strip(flat.surface, middle_m),
                flat.gloss,
            )
        )
    return tuple(panels)


def bent_dots_m(site_from_target: Pose, u_m: float, radius_m: float) -> Floats:
    """Where the dots' centres of such a plate are, shape (16, 3), in the site frame."""
    flat_m = dots_target_m(u_m)
    on_pillar_m = [_on_pillar(x_m, radius_m).apply(np.array([0.0, y_m, 0.0])) for x_m, y_m, _ in flat_m]
    return site_from_target.apply(np.array(on_pillar_m))


def _on_pillar(x_m: float, radius_m: float) -> Pose:
    """The frame, within the flat sheet's, of what lay at x along it: turned about y, and back along the arc."""
    angle = x_m / radius_m
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return Pose(rotation, np.array([radius_m * sine, 0.0, radius_m * (cosine - 1.0)]))
