"""Single targets as pictures."""

from __future__ import annotations

from app.errors import NotFound
from app.targets.drawing import DEFAULT_U_MM, plate_png, plate_svg
from app.targets.family import family_by_name

__all__ = ["DEFAULT_U_MM", "png_of_target", "svg_of_target"]


def svg_of_target(family: str, code: int, u_mm: float, margin_u: float) -> bytes:
    """A target as SVG whose unit is the millimetre.

    Raises
    ------
    NotFound
        When the family does not hold the code.
    """
    _check(family, code)
    return plate_svg(code, u_mm, margin_u).encode()


def png_of_target(family: str, code: int, px_per_u: int, margin_u: int) -> bytes:
    """A target as PNG that says how large it is to be printed.

    Raises
    ------
    NotFound
        When the family does not hold the code.
    """
    _check(family, code)
    return plate_png(code, px_per_u, margin_u=margin_u)


def _check(family: str, code: int) -> None:
    if not family_by_name(family).contains(code):
        raise NotFound(f"the family {family} has no code {code}", field="code", code=code, code_family=family)
