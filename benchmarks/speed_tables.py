"""Times of many photographs in a table: a row per reader, by the number of plates in view."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.memory import peak_rss_bytes
from benchmarks.output import print_table
from benchmarks.timing import Timing

MS_PER_S = 1000.0
BYTES_PER_GB = 1e9
STAGES = ("load", "detect", "resect")
NO_TAGS = (
    "Readers of square tags have no tags to find here: theirs is the time to see that, a lower bound, without a pose."
)
VIEWS = ((1, 14), (15, 40), (41, 100), (101, 10**6))  # plates wholly in view


def speed_record(room: str, timings: Sequence[Timing]) -> dict[str, Any]:
    """A JSON-ready record of a run."""
    readers = list(dict.fromkeys(timing.reader for timing in timings))
    rows = []
    for least, most in VIEWS:
        seen = [timing for timing in timings if least <= timing.plates <= most]
        rows += [_row((least, most), [timing for timing in seen if timing.reader == name]) for name in readers if seen]
    return {"room": room, "rows": rows, "peak_bytes": peak_rss_bytes(), "timings": list(timings)}


def print_speed(record: dict[str, Any]) -> None:
    """The table of a run."""
    memory = f"memory at most {record['peak_bytes'] / BYTES_PER_GB:.2f} GB"
    title = f"{record['room']}: bytes to pose over decoding the JPEG alone, one thread; {memory}"
    if any(row["peer"] for row in record["rows"]):
        title += f"\n{NO_TAGS}"
    headings = ["plates", "photos", "reader", "found", "decode ms", *(f"{stage} x" for stage in STAGES)]
    print_table(title, [*headings, "total x", "worst x"], [_cells(row) for row in record["rows"]])


def _row(view: tuple[int, int], timings: Sequence[Timing]) -> dict[str, Any]:
    multiples = np.array([timing.multiples for timing in timings])
    totals = multiples.sum(axis=1)
    return {
        "plates": list(view),
        "reader": timings[0].reader,
        "peer": not timings[0].gives_pose,
        "photographs": len(timings),
        "found_median": float(np.median([timing.found for timing in timings])),
        "located": sum(timing.located for timing in timings),
        "decode_ms": float(MS_PER_S * np.median([timing.decode_s for timing in timings])),
        "multiples": dict(zip(STAGES, np.median(multiples, axis=0).tolist(), strict=True)),
        "total_multiple": float(np.median(totals)),
        "worst_multiple": float(totals.max()),
    }


def _cells(row: dict[str, Any]) -> list[str]:
    least, most = row["plates"]
    label = f"over {least - 1}" if most == VIEWS[-1][1] else f"{least}-{most}"
    found = f"{row['found_median']:g} {'tags' if row['peer'] else 'targets'}"
    figures = [*row["multiples"].values(), row["total_multiple"], row["worst_multiple"]]
    texts = [f"{figure:.2f}" for figure in figures]
    if row["peer"]:
        texts[STAGES.index("resect")] = "-"
    return [label, str(row["photographs"]), row["reader"], found, f"{row['decode_ms']:.1f}", *texts]
