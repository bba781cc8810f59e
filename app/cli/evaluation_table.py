"""Evaluations as a table, for people."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise

from rich.console import Console
from rich.table import Table

from app.trajectories.comparison import Difference
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.bands import counts_in_bands
from app.trajectories.metrics.bootstrap import Interval
from app.trajectories.metrics.relative_pose_error import Unit
from app.trajectories.metrics.summary import Summary

Row = tuple[str, Callable[[Evaluation], str]]

METRES, NONE = "{:.4f} m", "-"
AXES = ("x", "y", "z")
STRETCHES: tuple[tuple[Unit, str], ...] = (("frames", "frame"), ("metres", "metre"), ("seconds", "second"))


def print_evaluations(
    evaluations: Mapping[str, Evaluation], differences: Sequence[Difference], bands_m: Sequence[float]
) -> None:
    """One column per system, one row per metric that any has, per zone and per band; then who is better than whom."""
    console = Console()
    table = Table(show_edge=False)
    table.add_column("estimate - reference", no_wrap=True)
    for name in evaluations:
        table.add_column(name, justify="right", overflow="fold")
    for label, value in (*ROWS, *_zone_rows(evaluations), *_band_rows(bands_m)):
        texts = [value(evaluation) for evaluation in evaluations.values()]
        if any(text != NONE for text in texts):
            table.add_row(label, *texts)
    console.print(table)
    for name, evaluation in evaluations.items():
        if evaluation.verdict is not None:
            console.print(f"{name}: {evaluation.verdict.sentence}", soft_wrap=True, highlight=False)
    for difference in differences:
        console.print(_sentence(difference), soft_wrap=True, highlight=False)


def _metres(value: float) -> str:
    return METRES.format(value)


def _with_interval(interval: Interval) -> str:
    return f"{interval.value:.4f} m ({interval.low:.4f} to {interval.high:.4f})"


def _offset(evaluation: Evaluation) -> str:
    offset = evaluation.time_offset
    return f"{offset.offset_s:.4f} s" + (f" +- {offset.sigma_s:.4f}" if offset.sigma_s else "")


def _latency(evaluation: Evaluation) -> str:
    latency_s = evaluation.availability.latency_s
    return NONE if latency_s is None else f"{latency_s.median:.3f} s, {latency_s.quantile_95:.3f} s"


def _share(value: float | None) -> str:
    return NONE if value is None else f"{100 * value:.1f} %"


def _vector(values: Sequence[float]) -> str:
    return " ".join(f"{value:.4f}" for value in values)


def _bias(axis: int, evaluation: Evaluation) -> str:
    return _metres(float(evaluation.accuracy.bias_m[axis]))


def _rms(axis: int, evaluation: Evaluation) -> str:
    return _metres(float(evaluation.accuracy.rms_m[axis]))


def _absolute(evaluation: Evaluation) -> str:
    absolute = evaluation.pose_errors.absolute
    return _pose_error(absolute["trans"], absolute.get("rot_deg"))


def _relative(unit: Unit, evaluation: Evaluation) -> str:
    found = evaluation.pose_errors.relative.get(unit)
    return NONE if found is None else _pose_error(found["trans"], found["rot_deg"])


def _pose_error(position: Summary, orientation_deg: Summary | None) -> str:
    turned = "" if orientation_deg is None else f", {orientation_deg.rms:.3f} deg"
    return f"{_metres(position.rms)}{turned}"


ROWS: tuple[Row, ...] = (
    ("pairs", lambda e: f"{len(e.pairs)} of {e.pairs.estimate_count}"),
    ("clock offset", _offset),
    ("alignment", lambda e: e.alignment.kind),
    *((f"bias {axis}", partial(_bias, row)) for row, axis in enumerate(AXES)),
    *((f"RMS {axis}", partial(_rms, row)) for row, axis in enumerate(AXES)),
    ("RMS in the plan", lambda e: _metres(e.accuracy.horizontal.rms)),
    ("RMS in space (interval)", lambda e: _with_interval(e.intervals.rms)),
    ("mean in space (interval)", lambda e: _with_interval(e.intervals.mean)),
    ("CE50, CE95 (m)", lambda e: _vector((e.accuracy.horizontal.median, e.accuracy.horizontal.quantile_95))),
    ("VE50, VE95 (m)", lambda e: _vector((e.accuracy.vertical.median, e.accuracy.vertical.quantile_95))),
    ("SE50, SE95 (m)", lambda e: _vector((e.accuracy.spatial.median, e.accuracy.spatial.quantile_95))),
    ("APE (RMSE)", _absolute),
    *((f"RPE per {stretch} (RMSE)", partial(_relative, unit)) for unit, stretch in STRETCHES),
    ("EvAAL third quartile", lambda e: _metres(e.evaal.quantile_75)),
    ("right storey", lambda e: _share(None if e.floors is None else e.floors.detection_probability)),
    ("reference covered", lambda e: _share(e.availability.covered_share)),
    ("latency (median, 95 %)", _latency),
)


def _zone_rows(evaluations: Mapping[str, Evaluation]) -> list[Row]:
    zones = dict.fromkeys(zone for evaluation in evaluations.values() for zone in evaluation.zones)
    return [(f"{zone}: SE50, SE95 (m)", partial(_in_zone, zone)) for zone in zones]


def _in_zone(zone: str, evaluation: Evaluation) -> str:
    found = evaluation.zones.get(zone)
    if found is None:
        return NONE
    return f"{_vector((found.spatial.median, found.spatial.quantile_95))} of {found.spatial.count}"


def _band_rows(bands_m: Sequence[float]) -> list[Row]:
    """Pairs by the size of their errors along x and y, as the paper's Table 3 has them."""
    if not bands_m:
        return []
    names = [f"below {bands_m[0]:g}", *(f"{low:g} to {high:g}" for low, high in pairwise(bands_m))]
    names.append(f"above {bands_m[-1]:g}")
    return [
        (f"{axis} {name} m", partial(_count, row, band, tuple(bands_m)))
        for row, axis in enumerate(AXES)
        for band, name in enumerate(names)
    ]


def _count(axis: int, band: int, bands_m: tuple[float, ...], evaluation: Evaluation) -> str:
    return str(counts_in_bands(evaluation.errors, bands_m)[axis, band])


def _sentence(difference: Difference) -> str:
    names = f"{difference.first} and {difference.second}"
    if difference.mean_m is None:
        return f"{names} have no moment in common"
    mean = f"mean difference over {difference.common} common moments {_with_interval(difference.mean_m)}"
    if difference.better is None:
        return f"{names}: neither is better beyond doubt ({mean})"
    return f"{names}: {difference.better} is better ({mean})"
