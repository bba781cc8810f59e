"""Malformed images: the same for the same seed, of all kinds, small."""

from __future__ import annotations

from benchmarks.mutants import CHANGES, mutants, seeds
from tests.api.serving import room_photos

PICTURES = seeds(room_photos("locate")["IMG_0000.jpg"])
COUNT = 200
GREATEST_BYTES = 4 * max(len(picture) for picture in PICTURES) + 100_000


def test_a_seed_gives_the_same_images_again() -> None:
    assert list(mutants(PICTURES, 7, COUNT)) == list(mutants(PICTURES, 7, COUNT))
    assert list(mutants(PICTURES, 7, COUNT)) != list(mutants(PICTURES, 8, COUNT))


def test_the_first_images_do_not_hang_on_how_many_follow() -> None:
    assert list(mutants(PICTURES, 7, COUNT))[:20] == list(mutants(PICTURES, 7, 20))


def test_every_format_is_changed_and_stays_small() -> None:
    made = list(mutants(PICTURES, 1, COUNT))
    assert all(len(data) < GREATEST_BYTES for data in made)
    assert sum(data not in PICTURES for data in made) > COUNT - len(CHANGES)
    begins = {data[:2] for data in made}
    assert {b"\xff\xd8", b"\x89P", b"RI"} <= begins
