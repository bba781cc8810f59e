from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import InvalidInput
from app.services.capture_time import LATEST_S, ClientClock, iso_of, moment_of

NOON_S = 1777636800.0  # 2026-05-01T12:00:00Z
RECEIVED_S = 1777636999.0


@pytest.mark.parametrize(
    ("text", "captured_s"),
    [
        ("2026-05-01T12:00:00Z", NOON_S),
        ("2026-05-01T12:00:00", NOON_S),  # UTC when no zone is written
        ("2026-05-01T14:00:00+02:00", NOON_S),
        ("2026-05-01T14:00:00 02:00", NOON_S),  # an unescaped + in a query
        ("2026-05-01 12:00:00.25Z", NOON_S + 0.25),
        ("1777636800", NOON_S),
        ("1777636800.125", NOON_S + 0.125),
        (" 1.7776368e9 ", NOON_S),
    ],
)
def test_the_clients_time_is_read(text: str, captured_s: float) -> None:
    moment = moment_of(ClientClock(text), RECEIVED_S)
    assert (moment.captured_s, moment.source) == (captured_s, "client")


def test_the_offset_takes_the_devices_clock_to_ours() -> None:
    moment = moment_of(ClientClock("2026-05-01T12:00:00Z", offset_s=-3.5, delay_s=0.02), RECEIVED_S)
    assert (moment.captured_s, moment.clock_delay_s) == (NOON_S - 3.5, 0.02)


def test_without_a_word_it_is_the_time_of_arrival() -> None:
    moment = moment_of(ClientClock(offset_s=5.0, delay_s=1.0), RECEIVED_S)
    assert (moment.captured_s, moment.source, moment.clock_delay_s) == (RECEIVED_S, "server", None)


@pytest.mark.parametrize(
    "text", ["", "yesterday", "nan", "inf", "-1", "1e300", "2026-13-01T00:00:00Z", "2026:05:01 12:00"]
)
def test_what_is_no_time_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="2026-05-01T09:30:00") as refused:
        moment_of(ClientClock(text), RECEIVED_S)
    assert refused.value.fields["field"] == "captured_at"


@given(st.floats(0.0, LATEST_S))
def test_what_is_written_is_read_back_to_the_microsecond(seconds: float) -> None:
    assert moment_of(ClientClock(iso_of(seconds)), 0.0).captured_s == pytest.approx(seconds, abs=1e-4, rel=0)
