"""A photograph from a file."""

from __future__ import annotations

from pathlib import Path

from app.errors import InvalidInput
from app.vision.photo import Photo, load_photo


def read_photo(path: Path) -> Photo:
    """Read and decode a photograph; errors name the file."""
    try:
        return load_photo(path.read_bytes())
    except InvalidInput as error:
        raise type(error)(f"{path}: {error.detail}", **error.fields) from error
