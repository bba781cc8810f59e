"""``scattermark sheets``: targets to print."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.arguments import FAMILIES, add_json, at_least_one, positive
from app.cli.compile_ import compile_first
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.services.sheets.wish import SheetsPlan, SheetsWish

HELP = "write targets to print: a PDF of sheets, or single targets as SVG or PNG"
SIZES = ("A0", "A1", "A2", "A3", "A4", "A5", "letter")  # a test holds them equal to the papers that there are
PX_PER_U = 100


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.pdf|FOLDER", help="a .pdf, or a folder")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--count", type=at_least_one, help="how many codes to choose, far apart from each other")
    what.add_argument("--codes", metavar="389,400-420", help="which codes to print")
    parser.add_argument("--family", default="golay", choices=FAMILIES, help="code family (golay)")
    parser.add_argument("--size", default="A4", choices=SIZES, help="paper (A4)")
    parser.add_argument(
        "--u-mm", type=positive, help="module; a plate's side is 13 of it (the largest that suits the paper)"
    )
    parser.add_argument("--title", default="", help="what stands on each sheet: the site's name")
    parser.add_argument("--link", help="where QR codes lead; {code} in it stands for the code")
    parser.add_argument("--taken", default="", metavar="CODES", help="codes that hang there already")
    parser.add_argument("--format", default="pdf", choices=("pdf", "svg", "png"), help="pdf; or a folder of svg or png")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Choose, draw, read back, write."""
    from app.services.sheets.wish import SheetsWish, codes_of_text, plan_sheets

    wish = SheetsWish(
        family=arguments.family,
        codes=codes_of_text(arguments.codes or ""),
        count=arguments.count,
        size=arguments.size,
        u_mm=arguments.u_mm,
        title=arguments.title,
        link=arguments.link,
        taken=codes_of_text(arguments.taken),
    )
    plan = plan_sheets(wish)
    if arguments.format == "pdf":
        _write_pdf(arguments.out, wish)
    else:
        _write_pictures(arguments.out, plan, arguments.format)
    _tell(arguments, plan)
    return 0


def _write_pdf(path: Path, wish: SheetsWish) -> None:
    if path.suffix.lower() != ".pdf":
        raise InvalidInput(f"{path} is no .pdf; name one, or say --format svg or png for a folder of single targets")
    compile_first()
    from app.cli.progress import progress
    from app.services.sheets.work import write_sheets

    with progress() as report:
        pdf = write_sheets(wish, lambda done, total: report("read back", done, total))
    path.write_bytes(pdf)


def _write_pictures(folder: Path, plan: SheetsPlan, suffix: str) -> None:
    from app.targets.drawing import plate_png, plate_svg

    folder.mkdir(parents=True, exist_ok=True)
    u_mm = plan.layout.u_mm
    for code in plan.codes:
        picture = plate_svg(code, u_mm, 1.0).encode() if suffix == "svg" else plate_png(code, PX_PER_U, u_mm, 1)
        (folder / f"target-{code}.{suffix}").write_bytes(picture)


def _tell(arguments: argparse.Namespace, plan: SheetsPlan) -> None:
    layout = plan.layout
    if arguments.json:
        told = {"out": str(arguments.out), "codes": plan.codes, "u_mm": layout.u_mm, "sheets": len(plan.sheets)}
        print(json.dumps(told))
        return
    print(f"{arguments.out}: {len(plan.codes)} targets of {plan.family.name}, u = {layout.u_mm:g} mm", end="")
    if arguments.format == "pdf":
        print(f", {len(plan.sheets)} sheets of {layout.paper.name}; print at 100 % and measure the check bars", end="")
    print()
