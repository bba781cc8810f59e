"""No sheet leaves unread: each page is rasterised, and the detector has to find what was to be printed, where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pypdfium2

from app.errors import SheetUnreadable
from app.services.sheets.wish import SheetsPlan
from app.targets.layout import dots_from_corner_u
from app.targets.sheet import Place
from app.vision.detectors import choose_detector

Floats = npt.NDArray[np.float64]

POINTS_PER_MM = 72.0 / 25.4
HALF_PIXEL = 0.5  # pixel centres are integers


@dataclass(frozen=True)
class ReadBackOptions:
    """How a page is read.

    Attributes
    ----------
    px_per_u : float
        Of the raster: four times what a detector needs, and still a small picture.
    tolerance_px : float
        How far a dot may be found from where it was drawn: the raster's edges have no lens to soften them, which costs
        some tenths of a pixel; a dot or a plate in a wrong place is off by far more.
    """

    px_per_u: float = 8.0
    tolerance_px: float = 0.5


def read_back(
    pdf: bytes,
    plan: SheetsPlan,
    options: ReadBackOptions | None = None,
    report: Callable[[int, int], None] | None = None,
) -> None:
    """Read every page of a file of sheets, telling pages done and pages in all.

    Raises
    ------
    SheetUnreadable
        When a page shows other targets than it should, or a dot stands elsewhere.
    """
    options = options or ReadBackOptions()
    document = pypdfium2.PdfDocument(pdf)
    try:
        if len(document) != len(plan.sheets):
            raise SheetUnreadable(f"the file has {len(document)} pages instead of {len(plan.sheets)}")
        for number in range(len(document)):
            _read_page(document[number], plan, number, options)
            if report is not None:
                report(number + 1, len(document))
    finally:
        document.close()


def _read_page(page: pypdfium2.PdfPage, plan: SheetsPlan, number: int, options: ReadBackOptions) -> None:
    scale = options.px_per_u / plan.layout.u_mm / POINTS_PER_MM
    bgr = np.ascontiguousarray(page.render(scale=scale, rev_byteorder=False).to_numpy()[..., :3])
    paper = plan.layout.paper
    px_per_mm = np.array([bgr.shape[1] / paper.width_mm, bgr.shape[0] / paper.height_mm])  # the raster is whole pixels
    detection = choose_detector("default", "strict").detect(bgr, plan.family)
    expected = plan.sheets[number]
    found = {target.code: target for target in detection.targets}
    if set(found) != set(expected):
        raise SheetUnreadable(
            f"sheet {number + 1} reads as {sorted(found)} instead of {sorted(expected)}; report this, with the wish",
            sheet=number + 1,
            expected=sorted(expected),
            read=sorted(found),
        )
    for code, place in zip(expected, plan.layout.places(), strict=False):  # the last sheet may hold fewer
        drawn_px = _drawn_px(place, plan.layout.u_mm, px_per_mm)
        off_px = np.abs(found[code].centres_px - drawn_px)[found[code].measured]
        if off_px.max() > options.tolerance_px:
            off_mm = float((off_px / px_per_mm).max())
            raise SheetUnreadable(
                f"a dot of target {code} is drawn {off_mm:.2f} mm from its place; report this, with the wish",
                sheet=number + 1,
                code=code,
            )


def _drawn_px(place: Place, u_mm: float, px_per_mm: Floats) -> Floats:
    """Where a plate's dots stand in the raster, shape (16, 2)."""
    corner_mm = np.array([place.x_mm, place.y_mm])
    return np.asarray((corner_mm + dots_from_corner_u() * u_mm) * px_per_mm - HALF_PIXEL)
