"""What a worker process does to show a photograph: read it, make it small and upright."""

from __future__ import annotations

from dataclasses import dataclass

from app.services.workbench import workbench
from app.vision.display import DisplayOptions, display_jpeg, quarter_turns
from app.vision.photo import PhotoLimits


@dataclass(frozen=True)
class ShowTask:
    """A photograph of the store, and how it is wanted."""

    sha256: str
    options: DisplayOptions
    limits: PhotoLimits


def show_photo(task: ShowTask) -> bytes:
    """The photograph as a JPEG.

    Raises
    ------
    NotFound
        When the store has lost it.
    BadPhoto, UnsupportedPhoto, PhotoTooLarge
    """
    return display_jpeg(workbench().photos.read(task.sha256), task.options, task.limits)


def turns_of_photo(sha256: str) -> int:
    """Quarter turns clockwise that show a photograph of the store upright.

    Raises
    ------
    NotFound
        When the store has lost it.
    """
    return quarter_turns(workbench().photos.read(sha256))
