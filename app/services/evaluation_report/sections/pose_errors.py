"""The section of absolute and relative pose errors, the measures of robotics."""

from __future__ import annotations

from functools import partial

from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.numbers import error_m
from app.services.evaluation_report.sections.metric_table import DEGREE_DIGITS, MOST_UPRIGHT, Row, metric_table
from app.services.reporting.document import Section
from app.services.reporting.numbers import MISSING, count, fixed
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.absolute_pose_error import Part
from app.trajectories.metrics.relative_pose_error import Unit
from app.trajectories.metrics.summary import Summary

Statistic = str
FULL_DIGITS = 4
PARTS: tuple[tuple[Part, str, str], ...] = (
    ("trans", "Position", ", m"),
    ("rot_deg", "Orientation", ", degrees"),
    ("full", "Full pose", ""),
)
STRETCHES: tuple[tuple[Unit, str], ...] = (("frames", "frame"), ("metres", "metre"), ("seconds", "second"))
STATISTICS: tuple[tuple[Statistic, str], ...] = (
    ("rms", "RMSE"),
    ("mean", "mean"),
    ("median", "median"),
    ("std", "standard deviation"),
    ("greatest", "greatest"),
)
OF_STRETCHES = STATISTICS[:3]
ABSOLUTE_NOTE = "Each aligned pose against the reference's (Sturm et al., 2012); the full pose is without unit."
RELATIVE_NOTE = (
    "Motion over one stretch after the other against the reference's motion: from pair to pair, and over the first "
    "pairs that are a metre of the reference's path, or a second, apart."
)


def pose_errors(material: ReportMaterial) -> Section:
    """APE and RPE; a dash where orientations are missing or the walk is shorter than a stretch."""
    evaluations = material.evaluations
    tables = (
        metric_table("Absolute pose error (APE)", evaluations, ABSOLUTE, ABSOLUTE_NOTE),
        metric_table("Relative pose error (RPE)", evaluations, RELATIVE, RELATIVE_NOTE),
    )
    return Section("Pose errors", tables, wide=len(evaluations) > MOST_UPRIGHT)


def _absolute(part: Part, statistic: Statistic, evaluation: Evaluation) -> str:
    return _told(evaluation.pose_errors.absolute.get(part), part, statistic)


def _relative(unit: Unit, part: Part, statistic: Statistic, evaluation: Evaluation) -> str:
    return _told(evaluation.pose_errors.relative.get(unit, {}).get(part), part, statistic)


def _told(summary: Summary | None, part: Part, statistic: Statistic) -> str:
    value = None if summary is None else float(getattr(summary, statistic))
    return error_m(value) if part == "trans" else fixed(value, DEGREE_DIGITS if part == "rot_deg" else FULL_DIGITS)


def _stretches(unit: Unit, evaluation: Evaluation) -> str:
    found = evaluation.pose_errors.relative.get(unit)
    return MISSING if found is None else count(found["trans"].count)


ABSOLUTE: tuple[Row, ...] = tuple(
    (f"{name}, {words}{shown_in}", partial(_absolute, part, statistic))
    for part, name, shown_in in PARTS
    for statistic, words in STATISTICS
)
RELATIVE: tuple[Row, ...] = tuple(
    row
    for unit, stretch in STRETCHES
    for row in (
        (f"Stretches of one {stretch}", partial(_stretches, unit)),
        *(
            (f"{name} per {stretch}, {words}{shown_in}", partial(_relative, unit, part, statistic))
            for part, name, shown_in in PARTS
            for statistic, words in OF_STRETCHES
        ),
    )
)
