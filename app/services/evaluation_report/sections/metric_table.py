"""The metrics of all systems, one column each: every row a metric with its unit, read from the evaluation as it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations_with_replacement

import numpy as np

from app.geometry.pose import Pose
from app.services.evaluation_report.numbers import error_m, percent
from app.services.reporting.document import Column, Table
from app.services.reporting.numbers import MISSING, count, fixed
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.summary import Summary

Row = tuple[str, Callable[[Evaluation], str]]

AXES = "XYZ"
SECOND_DIGITS, DEGREE_DIGITS, QUATERNION_DIGITS, SCALE_DIGITS, SQUARE_DIGITS = 4, 3, 6, 6, 6


def metric_table(title: str, evaluations: Mapping[str, Evaluation], rows: Sequence[Row], note: str = "") -> Table:
    """A table of one column for each system."""
    columns = (Column("", align="left"), *(Column(name) for name in evaluations))
    texts = tuple((label, *(value(evaluation) for evaluation in evaluations.values())) for label, value in rows)
    return Table(title, columns, texts, note)


def _bias(axis: int, evaluation: Evaluation) -> str:
    return error_m(float(evaluation.accuracy.bias_m[axis]))


def _rms(axis: int, evaluation: Evaluation) -> str:
    return error_m(float(evaluation.accuracy.rms_m[axis]))


def _covariance(axes: tuple[int, int], evaluation: Evaluation) -> str:
    return fixed(float(evaluation.accuracy.covariance_m2[axes]), SQUARE_DIGITS)


def _translation(axis: int, evaluation: Evaluation) -> str:
    return error_m(float(evaluation.alignment.site_from_estimate.translation_m[axis]))


def _quaternion(part: int, evaluation: Evaluation) -> str:
    rotation = evaluation.alignment.site_from_estimate.rotation
    return fixed(float(Pose(rotation, np.zeros(3)).orientation_xyzw[part]), QUATERNION_DIGITS)


def _degrees(value: Callable[[Summary], float], evaluation: Evaluation) -> str:
    rotation = evaluation.accuracy.rotation
    return MISSING if rotation is None else fixed(float(np.degrees(value(rotation))), DEGREE_DIGITS)


def _offset_sigma(evaluation: Evaluation) -> str:
    sigma_s = evaluation.time_offset.sigma_s
    return "given" if sigma_s == 0.0 else fixed(sigma_s, SECOND_DIGITS)


def _latency(value: Callable[[Summary], float], evaluation: Evaluation) -> str:
    latency_s = evaluation.availability.latency_s
    return MISSING if latency_s is None else fixed(value(latency_s), SECOND_DIGITS)


def _floors(evaluation: Evaluation) -> str:
    return percent(None if evaluation.floors is None else evaluation.floors.detection_probability)


ACCURACY: tuple[Row, ...] = (
    ("Pairs", lambda e: count(len(e.pairs))),
    *(
        (f"{letter}E{share}, m", partial(lambda part, level, e: error_m(level(part(e))), part, level))
        for letter, part in (
            ("C", lambda e: e.accuracy.horizontal),
            ("V", lambda e: e.accuracy.vertical),
            ("S", lambda e: e.accuracy.spatial),
        )
        for share, level in ((50, lambda s: s.median), (95, lambda s: s.quantile_95))
    ),
    ("Mean in the plan, m", lambda e: error_m(e.accuracy.horizontal.mean)),
    ("Mean in height, m", lambda e: error_m(e.accuracy.vertical.mean)),
    ("Mean in space, m", lambda e: error_m(e.accuracy.spatial.mean)),
    ("RMS in the plan, m", lambda e: error_m(e.accuracy.horizontal.rms)),
    ("RMS in height, m", lambda e: error_m(e.accuracy.vertical.rms)),
    ("RMS in space, m", lambda e: error_m(e.accuracy.spatial.rms)),
    ("Standard deviation in space, m", lambda e: error_m(e.accuracy.spatial.std)),
    ("Least in space, m", lambda e: error_m(e.accuracy.spatial.least)),
    ("Greatest in space, m", lambda e: error_m(e.accuracy.spatial.greatest)),
    *((f"Bias {axis}, m", partial(_bias, row)) for row, axis in enumerate(AXES)),
    *((f"RMS {axis}, m", partial(_rms, row)) for row, axis in enumerate(AXES)),
    *(
        (f"Covariance {AXES[axes[0]]}{AXES[axes[1]]}, m²", partial(_covariance, axes))
        for axes in combinations_with_replacement(range(3), 2)
    ),
    ("Mean rotation, degrees", partial(_degrees, lambda s: s.mean)),
    ("RMS rotation, degrees", partial(_degrees, lambda s: s.rms)),
    ("Rotation at 95 %, degrees", partial(_degrees, lambda s: s.quantile_95)),
    ("Right storey, %", _floors),
)
EVAAL: tuple[Row, ...] = (
    ("Third quartile (score), m", lambda e: error_m(e.evaal.quantile_75)),
    ("Mean, m", lambda e: error_m(e.evaal.mean)),
    ("Median, m", lambda e: error_m(e.evaal.median)),
    ("95 % quantile, m", lambda e: error_m(e.evaal.quantile_95)),
)
AVAILABILITY: tuple[Row, ...] = (
    ("Pairs", lambda e: count(len(e.pairs))),
    ("Poses of the system", lambda e: count(e.pairs.estimate_count)),
    ("Reference covered, %", lambda e: percent(e.availability.covered_share)),
    ("Latency, mean, s", partial(_latency, lambda s: s.mean)),
    ("Latency, median, s", partial(_latency, lambda s: s.median)),
    ("Latency, 95 %, s", partial(_latency, lambda s: s.quantile_95)),
    ("Longest silence, s", lambda e: fixed(e.availability.longest_silence_s, SECOND_DIGITS)),
)
ALIGNMENT: tuple[Row, ...] = (
    ("Clock offset, s", lambda e: fixed(e.time_offset.offset_s, SECOND_DIGITS)),
    ("Its sigma, s", _offset_sigma),
    ("Alignment", lambda e: e.alignment.kind),
    ("Pairs that fixed it", lambda e: count(e.alignment.pairs_used)),
    ("Scale", lambda e: fixed(e.alignment.site_from_estimate.scale, SCALE_DIGITS)),
    *((f"Rotation q{part}", partial(_quaternion, row)) for row, part in enumerate("xyzw")),
    *((f"Translation {axis}, m", partial(_translation, row)) for row, axis in enumerate(AXES)),
)
