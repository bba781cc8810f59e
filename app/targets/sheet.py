"""Where things stand on a printed sheet: plates with their labels, check bars, colour patches; all in millimetres.

The sheet's frame: origin at the top left corner, x to the right (across the paper), y down (along it).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.errors import InvalidInput
from app.targets.layout import PLATE_SIDE_U
from app.targets.paper import Paper

EDGE_MM = 5.0  # that office printers leave white
SIDE_MM = 11.0  # left of the plates: the bar along the paper; as much on the right keeps them in the middle
FOOT_MM = 30.0  # the bar across the paper, colour patches, what was printed
GAP_MM = 3.0  # of white around a plate, at least, inside the cut marks
GAP_U = 0.5  # and where there is room
LABEL_MM, LABEL_U = 16.0, 2.0  # height of the label under a plate: at least, and for large plates
BAR_MM = 100.0  # of both check bars
PATCH_MM = 8.0  # side of a colour patch


@dataclass(frozen=True)
class Place:
    """Where one target is printed.

    Attributes
    ----------
    x_mm, y_mm : float
        Top left corner of the plate.
    """

    x_mm: float
    y_mm: float


@dataclass(frozen=True)
class SheetLayout:
    """A sheet with as many plates of one module as it takes.

    Attributes
    ----------
    paper : Paper
    u_mm : float
        The plates' module.
    columns, rows : int
        Of plates.
    gap_mm : float
        White between a plate and its cut marks.
    """

    paper: Paper
    u_mm: float
    columns: int
    rows: int
    gap_mm: float

    @property
    def plate_mm(self) -> float:
        """Side of a plate."""
        return PLATE_SIDE_U * self.u_mm

    @property
    def label_mm(self) -> float:
        """Height of the label under a plate."""
        return _label_mm(self.u_mm)

    @property
    def cut_size_mm(self) -> tuple[float, float]:
        """Width and height of what the cut marks enclose: the plate, white around it, its label."""
        return self.plate_mm + 2 * self.gap_mm, self.plate_mm + 2 * self.gap_mm + self.label_mm

    @property
    def per_sheet(self) -> int:
        """Targets on one sheet."""
        return self.columns * self.rows

    def places(self) -> tuple[Place, ...]:
        """Where the plates stand, row by row."""
        width_mm, height_mm = self.cut_size_mm
        left_mm = (self.paper.width_mm - self.columns * width_mm) / 2 + self.gap_mm
        top_mm = EDGE_MM + (_plates_height_mm(self.paper) - self.rows * height_mm) / 2 + self.gap_mm
        return tuple(
            Place(left_mm + column * width_mm, top_mm + row * height_mm)
            for row in range(self.rows)
            for column in range(self.columns)
        )

    def sheets(self, codes: Sequence[int]) -> tuple[tuple[int, ...], ...]:
        """The codes of each sheet, in their order; the last sheet may hold fewer."""
        return tuple(tuple(codes[start : start + self.per_sheet]) for start in range(0, len(codes), self.per_sheet))


def sheet_layout(paper: Paper, u_mm: float | None = None) -> SheetLayout:
    """As many plates as the paper takes, in its middle.

    Parameters
    ----------
    paper : Paper
    u_mm : float, optional
        Module of the plates; the paper's own when none is given.

    Raises
    ------
    InvalidInput
        When not one plate fits, or the module is no length.
    """
    u_mm = paper.u_mm if u_mm is None else u_mm
    if not 0.0 < u_mm < float("inf"):
        raise InvalidInput(
            f"u_mm is the length of the module in millimetres, a positive number; got {u_mm}", field="u_mm"
        )
    plate_mm = PLATE_SIDE_U * u_mm
    width_mm = paper.width_mm - 2 * SIDE_MM
    columns = int(width_mm // (plate_mm + 2 * GAP_MM))
    rows = int(_plates_height_mm(paper) // (plate_mm + 2 * GAP_MM + _label_mm(u_mm)))
    if columns < 1 or rows < 1:
        raise InvalidInput(
            f"a plate with u = {u_mm:g} mm has a side of {plate_mm:g} mm, too large for {paper.name}; "
            f"up to u = {_largest_u_mm(paper):g} mm fits, or take a larger paper",
            field="u_mm",
            u_mm=u_mm,
            largest_u_mm=_largest_u_mm(paper),
        )
    spare_mm = min(width_mm / columns - plate_mm, _plates_height_mm(paper) / rows - plate_mm - _label_mm(u_mm))
    return SheetLayout(paper, u_mm, columns, rows, min(spare_mm / 2, max(GAP_MM, GAP_U * u_mm)))


def _plates_height_mm(paper: Paper) -> float:
    return paper.height_mm - EDGE_MM - FOOT_MM - EDGE_MM


def _label_mm(u_mm: float) -> float:
    return max(LABEL_MM, LABEL_U * u_mm)


def _largest_u_mm(paper: Paper) -> float:
    """Down to a tenth of a millimetre."""
    by_width = (paper.width_mm - 2 * SIDE_MM - 2 * GAP_MM) / PLATE_SIDE_U
    height_mm = _plates_height_mm(paper) - 2 * GAP_MM
    by_height = min((height_mm - LABEL_MM) / PLATE_SIDE_U, height_mm / (PLATE_SIDE_U + LABEL_U))
    return int(min(by_width, by_height) * 10) / 10
