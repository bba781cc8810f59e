"""Arguments that several commands share, and the files they name."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from app.errors import InvalidInput

PHOTO_SUFFIXES = (".jpg", ".jpeg", ".png", ".webp")
STRICTNESSES = ("strict", "normal", "eager")
# Tests hold these equal to the library's lists, whose import is slow.
FAMILIES = ("golay", "hamming", "parity", "full")
DETECTORS = ("default", "paper")


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Options that say how targets are read."""
    parser.add_argument("--family", default="golay", choices=FAMILIES, help="code family of the plates (golay)")
    parser.add_argument(
        "--detector", default="default", choices=DETECTORS, help="the default, or the published method as a baseline"
    )
    parser.add_argument(
        "--strictness",
        choices=STRICTNESSES,
        help="evidence that a target needs: strict mends no dot, normal one, eager two "
        "(normal; the published method mends none)",
    )


def add_survey(parser: argparse.ArgumentParser, control: str) -> None:
    """Photographs of a survey, its control points (``control`` says what for), its plates, and how they are read."""
    parser.add_argument("photos", type=Path, nargs="+", help="photographs, or folders of them")
    parser.add_argument("--control", type=Path, metavar="CSV", help=control)
    parser.add_argument("--u-mm", type=positive, default=14.0, help="printed module of the plates in mm (14)")
    add_reading(parser)
    add_workers(parser)


def add_json(parser: argparse.ArgumentParser) -> None:
    """The option for machines."""
    parser.add_argument("--json", action="store_true", help="print JSON for machines")


def add_data_dir(parser: argparse.ArgumentParser) -> None:
    """Which installation is meant, when the environment does not say."""
    parser.add_argument("--data-dir", type=Path, help="folder of photographs and database (SCATTERMARK_DATA_DIR)")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Width of the worker pool."""
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1, help="worker processes (cores)")


def at_least_one(text: str) -> int:
    """A count for argparse."""
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError("at least one")
    return count


def positive(text: str) -> float:
    """A positive number for argparse."""
    number = float(text)
    if not 0.0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"a positive number is needed, got {text}")
    return number


def non_negative(text: str) -> float:
    """A number from zero on for argparse."""
    number = float(text)
    if not 0.0 <= number < float("inf"):
        raise argparse.ArgumentTypeError(f"a number from zero on is needed, got {text}")
    return number


def photo_files(paths: list[Path]) -> list[Path]:
    """The photographs that paths name: files as they are, folders by the photographs in them, in order.

    Raises
    ------
    InvalidInput
        When a path does not exist, a folder holds no photograph, or two files share a name.
    """
    files: list[Path] = []
    for path in paths:
        if path.is_dir():
            found = sorted(file for file in path.iterdir() if file.suffix.lower() in PHOTO_SUFFIXES)
            if not found:
                raise InvalidInput(f"{path} holds no photograph ({', '.join(PHOTO_SUFFIXES)})")
            files.extend(found)
        elif path.is_file():
            files.append(path)
        else:
            raise InvalidInput(f"there is no photograph {path}")
    names = [file.name for file in files]
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise InvalidInput(f"photographs are known by name, and these names come twice: {', '.join(repeated)}")
    return files
