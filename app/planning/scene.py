"""A scene: flat panels in a site, the targets posted there and the lamps that light them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.surfaces import PlateSurface, Surface
from app.targets.drawing import cell_colours_rgb
from app.targets.layout import PLATE_SIDE_U, dots_target_m

Floats = npt.NDArray[np.float64]

DEFAULT_PAPER_MARGIN_U = 1.0


@dataclass(frozen=True)
class Gloss:
    """What a smooth film, as of a laminated sheet, mirrors: each lamp as a bright spot on top of the print.

    Attributes
    ----------
    reflectance : float
        Share of light that is mirrored: 0.04 for glass and plastic films.
    sharpness : float
        Exponent of the lobe: 50 spreads a lamp over a satin sheet, 2,000 keeps it a spot.
    """

    reflectance: float = 0.04
    sharpness: float = 300.0

    def __post_init__(self) -> None:
        if not (0 <= self.reflectance <= 1 and self.sharpness > 0):
            raise ValueError("a gloss mirrors a share of the light, 0 ... 1, with a positive sharpness")


@dataclass(frozen=True)
class Panel:
    """A rectangle seen from its front alone: a wall, a poster, one face of a cupboard, a sheet of paper.

    Attributes
    ----------
    site_from_panel : Pose
        Panel frame: origin in the middle, x right, y up, z out of the front.
    width_m, height_m : float
        Along x and y.
    surface : Surface
        What it shows.
    gloss : Gloss or None
        What mirrors the lamps; None for plain paper and plaster.
    glow_rgb : tuple of float
        Light that it sends out by itself, linear: a window by day, a screen.
    """

    site_from_panel: Pose
    width_m: float
    height_m: float
    surface: Surface
    gloss: Gloss | None = None
    glow_rgb: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (self.width_m > 0 and self.height_m > 0):
            raise ValueError("a panel has a positive width and height")

    def corners_m(self) -> Floats:
        """Corners in the site frame, shape (4, 3), clockwise from the top left."""
        half = np.array([self.width_m, self.height_m, 0.0]) / 2
        signs = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]])
        return self.site_from_panel.apply(signs * half)


@dataclass(frozen=True)
class PostedTarget:
    """A plate on the wall.

    Attributes
    ----------
    code : int
        What it says; for a plate of wrong structure, what it pretends to say.
    site_from_target : Pose
    u_m : float
        Nominal module.
    print_scale_xy : tuple of float
        Printed over nominal length along and across the plate.
    paper_margin_u : float
        White paper around the plate.
    wrong_cells_rgb : ndarray of shape (16, 3) or None
        Colours other than the code's, for a plate that no reader may accept.
    """

    code: int
    site_from_target: Pose
    u_m: float
    print_scale_xy: tuple[float, float] = (1.0, 1.0)
    paper_margin_u: float = DEFAULT_PAPER_MARGIN_U
    wrong_cells_rgb: npt.NDArray[np.uint8] | None = None

    @property
    def wrong(self) -> bool:
        """Whether this is a plate of wrong structure."""
        return self.wrong_cells_rgb is not None

    def dots_m(self) -> Floats:
        """Dot centres in the site frame, shape (16, 3), row-major cells, print scale included."""
        return self.site_from_target.apply(dots_target_m(self.u_m, self.print_scale_xy))

    def panel(self) -> Panel:
        """The sheet of paper that carries the plate."""
        colours = cell_colours_rgb(self.code) if self.wrong_cells_rgb is None else self.wrong_cells_rgb
        width_m, height_m = (
            (PLATE_SIDE_U + 2 * self.paper_margin_u) * self.u_m * scale for scale in self.print_scale_xy
        )
        surface = PlateSurface(colours, self.u_m, self.print_scale_xy)
        return Panel(self.site_from_target, width_m, height_m, surface)


@dataclass(frozen=True)
class Lamp:
    """A small light.

    Attributes
    ----------
    position_m : ndarray of shape (3,)
    intensity_rgb : tuple of float
        Light on a panel one metre away that faces the lamp, linear.
    facing : ndarray of shape (3,) or None
        Direction, of length 1, of a lit sheet that shines by Lambert's cosine; None shines all around.
    """

    position_m: Floats
    intensity_rgb: tuple[float, float, float]
    facing: Floats | None = None


@dataclass(frozen=True)
class Scene:
    """Everything a synthetic photograph can show.

    Attributes
    ----------
    targets : tuple of PostedTarget
    panels : tuple of Panel
        Walls, furniture and pictures. Of panels in one plane the later one lies on top; targets lie above all of them.
    lamps : tuple of Lamp
    ambient_rgb : tuple of float
        Light from everywhere, linear.
    """

    targets: tuple[PostedTarget, ...]
    panels: tuple[Panel, ...]
    lamps: tuple[Lamp, ...] = ()
    ambient_rgb: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def all_panels(self) -> tuple[Panel, ...]:
        """Panels and sheets of paper, those on top last; the targets' sheets come last in the targets' order."""
        return (*self.panels, *(target.panel() for target in self.targets))
