"""Times of photographs in rows by view and reader."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.speed_tables import print_speed, speed_record
from benchmarks.timing import Timing


def timing(reader: str, plates: int, decode_s: float, stages_s: tuple[float, float, float]) -> Timing:
    return Timing(f"{plates}.jpg", plates, reader, reader != "peer", decode_s, np.array(stages_s), 3, True)


TIMINGS = [
    timing("default", 20, 0.01, (0.011, 0.005, 0.001)),
    timing("peer", 20, 0.02, (0.02, 0.2, 0.0)),
    timing("default", 30, 0.01, (0.011, 0.009, 0.001)),
    timing("peer", 30, 0.02, (0.02, 0.4, 0.0)),
    timing("default", 200, 0.01, (0.01, 0.02, 0.01)),
    timing("peer", 200, 0.02, (0.02, 0.2, 0.0)),
]


def test_each_row_is_relative_to_the_decoding_beside_it() -> None:
    record = speed_record("hall", TIMINGS)
    assert [(row["plates"][0], row["reader"], row["photographs"]) for row in record["rows"]] == [
        (15, "default", 2),
        (15, "peer", 2),
        (101, "default", 1),
        (101, "peer", 1),
    ]
    ours, peer = record["rows"][:2]
    assert (ours["total_multiple"], ours["worst_multiple"]) == (pytest.approx(1.9), pytest.approx(2.1))
    assert ours["multiples"] == {"load": pytest.approx(1.1), "detect": pytest.approx(0.7), "resect": pytest.approx(0.1)}
    assert peer["total_multiple"] == pytest.approx(16.0)


def test_it_is_said_that_peers_find_nothing_only_where_there_are_peers(capsys: pytest.CaptureFixture[str]) -> None:
    print_speed(speed_record("hall", TIMINGS))
    assert "no tags to find" in capsys.readouterr().out
    print_speed(speed_record("hall", [one for one in TIMINGS if one.gives_pose]))
    assert "no tags to find" not in capsys.readouterr().out
