"""A drawing as inline SVG; its colours come from the page's style, so that they follow light, dark and print."""

from __future__ import annotations

from html import escape

from app.services.reporting.drawing import Drawing, Ellipse, Path, Pen, Shape
from app.services.reporting.text import readable

PX_PER_POINT = 4.0 / 3.0  # of CSS


def svg_of(drawing: Drawing, description: str) -> str:
    """The drawing as an ``svg`` element, said in words for those who do not see it."""
    size = f'width="{drawing.width * PX_PER_POINT:.0f}" viewBox="0 0 {drawing.width:.6g} {drawing.height:.6g}"'
    shapes = "".join(_shape(shape) for shape in drawing.shapes)
    return f'<svg {size} role="img" aria-label="{escape(readable(description))}">{shapes}</svg>'


def _shape(shape: Shape) -> str:
    if isinstance(shape, Path):
        points = "L".join(f"{x:.2f} {y:.2f}" for x, y in shape.points)
        return f'<path {_pen(shape.pen)} d="M{points}{"Z" if shape.closed else ""}"/>'
    if isinstance(shape, Ellipse):
        return _ellipse(shape)
    x, y = shape.at
    place = f'class="f-{shape.ink}" x="{x:.2f}" y="{y:.2f}" font-size="{shape.size:g}" text-anchor="{shape.anchor}"'
    if shape.upwards:
        place += f' transform="rotate(-90 {x:.2f} {y:.2f})"'
    return f"<text {place}>{escape(readable(shape.text))}</text>"


def _ellipse(shape: Ellipse) -> str:
    (x, y), (first, second) = shape.centre, shape.semi_axes
    turned = "" if first == second else f' transform="rotate({shape.turn_deg:.1f} {x:.2f} {y:.2f})"'
    return f'<ellipse {_pen(shape.pen)} cx="{x:.2f}" cy="{y:.2f}" rx="{first:.2f}" ry="{second:.2f}"{turned}/>'


def _pen(pen: Pen) -> str:
    classes = [f"f-{pen.ink}"] if pen.filled else []
    if pen.width > 0:
        classes.append(f"s-{pen.ink}")
    width = f' stroke-width="{pen.width:g}"' if pen.width > 0 else ""
    dashes = f' stroke-dasharray="{" ".join(f"{length:g}" for length in pen.dash)}"' if pen.dash else ""
    return f'class="{" ".join(classes)}"{width}{dashes}'
