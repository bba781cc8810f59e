"""What it costs to store a photograph: without its position, on the disk before it is confirmed, read again.

    python -m benchmarks.photographs

obstore's own folder, which writes without fsync, stands beside the store's; so does the decoding of the photograph, as
a measure that every machine has. Writing to the disk is told from writing to its cache by nothing but the call.
"""

from __future__ import annotations

import hashlib
import statistics
import tempfile
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

import cv2
import numpy as np
import obstore
import piexif
from obstore.store import LocalStore

from app.storage.photo_store import open_photo_store
from app.vision.photo import load_photo
from app.vision.privacy.without_position import without_position
from benchmarks.output import print_table

REPEATS = 21
MS_PER_S = 1000.0
HEADINGS = ("", "230 kB photograph, ms", "12 megapixels, ms")
ROOM_PHOTO = Path(__file__).parents[1] / "examples" / "room" / "locate" / "IMG_0000.jpg"
LARGE_ROWS_AND_COLUMNS_PX = (3000, 4000)
POSITION = {piexif.GPSIFD.GPSLatitude: ((52, 1), (31, 1), (12, 1)), piexif.GPSIFD.GPSLatitudeRef: b"N"}


def main() -> None:
    """Measure and print."""
    photos = [with_position(ROOM_PHOTO.read_bytes()), with_position(large_photo())]
    with tempfile.TemporaryDirectory() as folder:
        rows = measured(photos, Path(folder))
    sizes = " and ".join(f"{len(photo)} bytes" for photo in photos)
    table = [(name, *(f"{value_ms:.2f}" for value_ms in values)) for name, values in rows.items()]
    print_table(f"Photographs of {sizes}, medians of {REPEATS}", HEADINGS, table)


def measured(photos: list[bytes], folder: Path) -> dict[str, list[float]]:
    """Median milliseconds of each step for each photograph."""
    store = open_photo_store(str(folder / "store"))
    plain = LocalStore(folder / "plain", mkdir=True)
    names = (hashlib.sha256(str(number).encode()).hexdigest() for number in count())
    kept = [next(names) for _ in photos]
    for name, photo in zip(kept, photos, strict=True):
        store.put(name, photo)
    steps: dict[str, Callable[[int], object]] = {
        "decode": lambda index: load_photo(photos[index]),
        "leave the position out": lambda index: without_position(photos[index]),
        "put, on the disk": lambda index: store.put(next(names), photos[index]),
        "put by obstore, in the cache": lambda index: obstore.put(plain, next(names), photos[index], mode="create"),
        "read": lambda index: store.read(kept[index]),
    }
    return {name: [median_ms(step, index) for index in range(len(photos))] for name, step in steps.items()}


def median_ms(step: Callable[[int], object], index: int) -> float:
    """Of repeated calls."""
    times_ms = []
    for _ in range(REPEATS):
        begun_s = time.perf_counter()
        step(index)
        times_ms.append(MS_PER_S * (time.perf_counter() - begun_s))
    return statistics.median(times_ms)


def large_photo() -> bytes:
    """Noise, which is the longest JPEG of its size."""
    pixels = np.random.default_rng(1).integers(0, 256, (*LARGE_ROWS_AND_COLUMNS_PX, 3), dtype=np.uint8)
    return cv2.imencode(".jpg", pixels, (cv2.IMWRITE_JPEG_QUALITY, 60))[1].tobytes()


def with_position(photo: bytes) -> bytes:
    """The photograph as a phone takes it that may know where it is."""
    tables = piexif.load(photo)
    tables["GPS"] = POSITION
    block = piexif.dump(tables)
    segment = b"\xff\xe1" + (len(block) + 2).to_bytes(2, "big") + block
    return photo[:2] + segment + photo[2:]


if __name__ == "__main__":
    main()
