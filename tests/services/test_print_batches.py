"""Print batches as they are written, by hand and by the service."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from app.errors import InvalidInput
from app.services.print_batches import BatchEntry, BatchLimits, batches_of_entries, read_entries
from app.targets.family import family_by_name

FAMILY = family_by_name("golay")
KNOWN = tuple(int(code) for code in FAMILY.codes[:6])
ENTRY = BatchEntry("floor 1", f"{KNOWN[0]},{KNOWN[2]}-{KNOWN[4]}", 99.0, 98.5, 0.2)


def test_a_range_holds_the_familys_codes_within_it() -> None:
    (batch,) = batches_of_entries([ENTRY], FAMILY)
    assert batch.codes == (KNOWN[0], *KNOWN[2:5])
    assert (batch.bar_across_mm, batch.bar_along_mm, batch.sigma_mm) == (99.0, 98.5, 0.2)


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ([replace(ENTRY, codes=str(KNOWN[0] + 1))], "no codes of the site's family"),
        ([replace(ENTRY, codes="twelve")], "names no codes"),
        ([replace(ENTRY, codes=" , ")], "names no codes"),
        ([replace(ENTRY, bar_across_mm=9.9)], "in millimetres"),
        ([replace(ENTRY, sigma_mm=0.0)], "sigma_mm"),
        ([ENTRY, replace(ENTRY, name="floor 2")], "printed once"),
        ([ENTRY, replace(ENTRY, codes=str(KNOWN[5]))], "are named"),
        ([ENTRY] * (BatchLimits.most + 1), "at most"),
    ],
)
def test_what_cannot_be_is_refused(entries: list[BatchEntry], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        batches_of_entries(entries, FAMILY)


def test_files_are_csv_or_the_services_json() -> None:
    columns = "name,codes,bar_across_mm,bar_along_mm,sigma_mm"
    (of_csv,) = read_entries(f'{columns}\nfloor 1,"{ENTRY.codes}",99.0,98.5,0.2\n')
    assert of_csv == ENTRY
    record = {"site_id": "x", "print_batches": [{**vars(ENTRY), "codes": list(KNOWN[:2])}]}
    assert read_entries(json.dumps(record)) == (replace(ENTRY, codes=f"{KNOWN[0]},{KNOWN[1]}"),)
    for text in (f"{columns}\nfloor 1,,99,98,0.2\n", f"{columns}\na,1,wide,98,0.2\n", '{"print_batches": 3}', "[1]"):
        with pytest.raises(InvalidInput, match="print batch"):
            read_entries(text)
