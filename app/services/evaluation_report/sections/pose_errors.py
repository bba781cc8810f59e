"""The section of absolute and relative pose errors, the measures of robotics."""

from __future__ import annotations

from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.numbers import error_m
from app.services.evaluation_report.sections.metric_table import DEGREE_DIGITS
from app.services.reporting.document import Column, Section, Table
from app.services.reporting.numbers import count, fixed
from app.trajectories.metrics.absolute_pose_error import Part
from app.trajectories.metrics.pose_errors import PoseErrors
from app.trajectories.metrics.relative_pose_error import Unit
from app.trajectories.metrics.summary import Summary

FULL_DIGITS = 4
ABSOLUTE = "APE"
RELATIVE: tuple[tuple[Unit, str], ...] = (
    ("frames", "RPE per frame"),
    ("metres", "RPE per metre"),
    ("seconds", "RPE per second"),
)
STATISTICS = ("RMSE", "Mean", "Median", "Greatest")
COLUMNS = (
    Column("System", align="left"),
    Column("Error", align="left"),
    Column("Count"),
    *(Column(name, "Position, m") for name in STATISTICS),
    *(Column(name, "Orientation, degrees") for name in STATISTICS),
    Column("RMSE", "Full pose"),
)
NOTE = (
    "APE: each aligned pose against the reference's. RPE: motion over one stretch after the other against the "
    "reference's motion, from pair to pair, or between pairs that are a metre of the reference's path, or a second, "
    "apart (Sturm et al., IROS 2012). The full pose has no unit. RPE takes orientations, and a walk longer than a "
    "stretch."
)


def pose_errors(material: ReportMaterial) -> Section:
    """APE and RPE of all systems."""
    rows = tuple(
        (name, *row) for name, evaluation in material.evaluations.items() for row in _rows(evaluation.pose_errors)
    )
    return Section("Pose errors", (Table("Absolute and relative pose errors", COLUMNS, rows, NOTE),))


def _rows(found: PoseErrors) -> list[tuple[str, ...]]:
    relative = [(name, found.relative[unit]) for unit, name in RELATIVE if unit in found.relative]
    return [(name, *_row(parts)) for name, parts in ((ABSOLUTE, found.absolute), *relative)]


def _row(parts: dict[Part, Summary]) -> tuple[str, ...]:
    orientation, full = parts.get("rot_deg"), parts.get("full")
    return (
        count(parts["trans"].count),
        *(error_m(value) for value in _levels(parts["trans"])),
        *(fixed(value, DEGREE_DIGITS) for value in _levels(orientation)),
        fixed(None if full is None else full.rms, FULL_DIGITS),
    )


def _levels(summary: Summary | None) -> tuple[float | None, ...]:
    if summary is None:
        return (None,) * len(STATISTICS)
    return summary.rms, summary.mean, summary.median, summary.greatest
