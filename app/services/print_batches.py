"""Print batches of a site: read entry by entry, checked as a whole, put in place together."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import InvalidInput
from app.geometry.print_batch import PrintBatch
from app.services.sheets.wish import codes_of_text
from app.storage.print_batches import PrintBatchRepository
from app.storage.sites import SiteRepository
from app.targets.family import CodeFamily, family_by_name

COLUMNS = ("name", "codes", "bar_across_mm", "bar_along_mm", "sigma_mm")
FIELD = "print_batches"


@dataclass(frozen=True)
class BatchLimits:
    """What can be believed of print batches.

    Attributes
    ----------
    most : int
        Batches of a site; each adds two unknowns that all photographs share.
    least_bar_mm, greatest_bar_mm : float
        Of a bar of 100 mm: beyond them another bar was measured, or in another unit.
    least_sigma_mm, greatest_sigma_mm : float
        A ruler is read to a tenth of a millimetre, a caliper to a hundredth.
    """

    most: int = 50
    least_bar_mm: float = 50.0
    greatest_bar_mm: float = 200.0
    least_sigma_mm: float = 0.001
    greatest_sigma_mm: float = 10.0


@dataclass(frozen=True)
class BatchEntry:
    """A batch as it was written: ``codes`` as ``389,400-420``, of which a range means the family's codes within it."""

    name: str
    codes: str
    bar_across_mm: float
    bar_along_mm: float
    sigma_mm: float


def put_print_batches(session: Session, site_id: str, entries: Sequence[BatchEntry]) -> tuple[PrintBatch, ...]:
    """Replace a site's print batches; builds from now on use them.

    Raises
    ------
    NotFound
        When there is no such site.
    InvalidInput
        As ``batches_of_entries``.
    """
    family = family_by_name(SiteRepository(session).get(site_id).code_family)
    batches = batches_of_entries(entries, family)
    PrintBatchRepository(session).replace(site_id, batches)
    return batches


def batches_of_entries(
    entries: Sequence[BatchEntry], family: CodeFamily, limits: BatchLimits = BatchLimits()
) -> tuple[PrintBatch, ...]:
    """Batches of what was written.

    Raises
    ------
    InvalidInput
        Naming the batch: a name or a code that comes twice, codes that are none of the family, lengths that no bar of
        100 mm has, too many batches.
    """
    if len(entries) > limits.most:
        raise _refusal(f"a site has at most {limits.most} print batches; join those of one printer and setting")
    batches: list[PrintBatch] = []
    owner: dict[int, str] = {}
    for entry in entries:
        _check_lengths(entry, limits)
        codes = _family_codes(entry, family)
        taken = next((code for code in codes if code in owner), None)
        if taken is not None:
            raise _refusal(f"code {taken} is in batch {owner[taken]!r} and in {entry.name!r}: a target is printed once")
        if any(batch.name == entry.name for batch in batches):
            raise _refusal(f"two print batches are named {entry.name!r}")
        owner.update(dict.fromkeys(codes, entry.name))
        batches.append(PrintBatch(entry.name, codes, entry.bar_across_mm, entry.bar_along_mm, entry.sigma_mm))
    return tuple(batches)


def read_entries(text: str) -> tuple[BatchEntry, ...]:
    """Batches of a file: CSV with a header, or the JSON that the service takes and gives.

    Raises
    ------
    InvalidInput
        When the file is neither, or an entry lacks something.
    """
    try:
        rows = _json_rows(text) if text.lstrip()[:1] in ("[", "{") else list(csv.DictReader(io.StringIO(text)))
    except (ValueError, RecursionError, csv.Error) as error:
        raise _refusal(f"the print batches cannot be read ({error})") from error
    return tuple(_entry(place, row) for place, row in enumerate(rows, start=1))


def _json_rows(text: str) -> list[object]:
    record = json.loads(text)
    rows = record.get(FIELD) if isinstance(record, dict) else record
    if not isinstance(rows, list):
        raise ValueError(f"expected a list, or an object with a list {FIELD}")
    return rows


def _entry(place: int, row: object) -> BatchEntry:
    if not isinstance(row, dict) or any(row.get(column) in (None, "") for column in COLUMNS):
        raise _refusal(f"print batch {place} needs {', '.join(COLUMNS)}")
    codes = row["codes"]
    try:
        lengths = [float(row[column]) for column in COLUMNS[2:]]
    except (TypeError, ValueError) as error:
        raise _refusal(f"print batch {place}: {error}; lengths are numbers of millimetres") from error
    return BatchEntry(str(row["name"]), text_of_codes(codes) if isinstance(codes, list) else str(codes), *lengths)


def text_of_codes(codes: Iterable[int]) -> str:
    """Codes as ``BatchEntry`` writes them."""
    return ",".join(str(code) for code in codes)


def _family_codes(entry: BatchEntry, family: CodeFamily) -> tuple[int, ...]:
    codes: set[int] = set()
    for part in filter(None, (part.strip() for part in entry.codes.replace(";", ",").split(","))):
        known = {code for code in codes_of_text(part) if family.contains(code)}
        if not known:
            raise _refusal(f"batch {entry.name!r}: {part} are no codes of the site's family {family.name}")
        codes |= known
    if not codes:
        raise _refusal(f"batch {entry.name!r} names no codes; write them as 389,400-420")
    return tuple(sorted(codes))


def _check_lengths(entry: BatchEntry, limits: BatchLimits) -> None:
    bars_mm = (entry.bar_across_mm, entry.bar_along_mm)
    if not all(limits.least_bar_mm <= bar_mm <= limits.greatest_bar_mm for bar_mm in bars_mm):
        raise _refusal(
            f"batch {entry.name!r}: bars of {bars_mm[0]:g} and {bars_mm[1]:g} mm; give the measured lengths of the two "
            "check bars, which should be 100 mm, in millimetres"
        )
    if not limits.least_sigma_mm <= entry.sigma_mm <= limits.greatest_sigma_mm:
        raise _refusal(f"batch {entry.name!r}: sigma_mm is how well the bars were measured: 0.2 with a ruler")


def _refusal(text: str) -> InvalidInput:
    return InvalidInput(text, field=FIELD)
