"""Why no pose of two trajectories belongs together, and what to try."""

from __future__ import annotations

from app.errors import InvalidInput
from app.trajectories.trajectory import Array

# A stamp since 1970 in another unit than seconds is too large by about one of these.
UNITS = {"milliseconds": 1e3, "microseconds": 1e6, "nanoseconds": 1e9}
SAME_UNIT = 3.0  # two clocks that count since 1970 differ less than by this factor; units differ by 1,000
COUNTS_SINCE_1970_S = 1e8  # stamps above were taken after 1973; below, the clock began with the recording
LEAP_SECONDS_GPS = 18.0  # GPS time is ahead of UTC by this since 2017
HOUR_S = 3600.0


class NothingMatched(InvalidInput):
    """No pose of the estimate has a partner in the reference."""

    slug = "nothing-matched"


def nothing_matched(reference_s: Array, estimate_s: Array, time_offset_s: float, max_gap_s: float) -> NothingMatched:
    """The error that says what is seen of the two clocks, and what to try."""
    if len(reference_s) == 0 or len(estimate_s) == 0:
        which = "reference" if len(reference_s) == 0 else "estimate"
        return NothingMatched(f"nothing matched: the {which} has no poses; give one that has")
    shifted_s = estimate_s + time_offset_s
    ranges = {
        "reference_from_s": float(reference_s[0]),
        "reference_to_s": float(reference_s[-1]),
        "estimate_from_s": float(shifted_s[0]),
        "estimate_to_s": float(shifted_s[-1]),
    }
    seen = (
        f"nothing matched within {max_gap_s:g} s: the reference goes from {ranges['reference_from_s']:.3f} to "
        f"{ranges['reference_to_s']:.3f} s, the estimate from {ranges['estimate_from_s']:.3f} to "
        f"{ranges['estimate_to_s']:.3f} s"
    )
    return NothingMatched(f"{seen}; {_advice(ranges)}", **ranges, max_gap_s=max_gap_s, time_offset_s=time_offset_s)


def _advice(ranges: dict[str, float]) -> str:
    reference_s, estimate_s = ranges["reference_from_s"], ranges["estimate_from_s"]
    for unit, factor in UNITS.items():
        for name, larger_s, smaller_s in (
            ("estimate", estimate_s, reference_s),
            ("reference", reference_s, estimate_s),
        ):
            if smaller_s > COUNTS_SINCE_1970_S and factor / SAME_UNIT < larger_s / smaller_s < factor * SAME_UNIT:
                return f"the stamps of the {name} look like {unit}: import it again with that unit of time"
    if (reference_s > COUNTS_SINCE_1970_S) != (estimate_s > COUNTS_SINCE_1970_S):
        return "one clock counts from 1970 and the other from its own start: give time_offset_s or have it estimated"
    overlap_s = min(ranges["reference_to_s"], ranges["estimate_to_s"]) - max(reference_s, estimate_s)
    if overlap_s >= 0:
        return "both cover the same time but no two stamps are near enough: give a larger max_gap_s"
    return _advice_on_distance(reference_s - estimate_s, -overlap_s)


def _advice_on_distance(apart_s: float, gap_s: float) -> str:
    hours = round(apart_s / HOUR_S)
    if hours and abs(apart_s - hours * HOUR_S) < HOUR_S / 60:
        return f"they begin {hours:+d} h apart: stamps in local time? try time_offset_s={hours * HOUR_S:.0f}"
    if abs(apart_s - LEAP_SECONDS_GPS) < 1 or abs(apart_s + LEAP_SECONDS_GPS) < 1:
        return f"they begin 18 s apart, as GPS time and UTC are: try time_offset_s={apart_s:.3f}"
    return f"{gap_s:.3f} s lie between them: are they of the same walk? If so, give time_offset_s or have it estimated"
