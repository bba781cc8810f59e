"""Sections of tables: accuracy, availability and alignment, zones, differences."""

from __future__ import annotations

from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.numbers import error_m, interval_m
from app.services.evaluation_report.sections.metric_table import (
    ACCURACY,
    ALIGNMENT,
    AVAILABILITY,
    EVAAL,
    metric_table,
)
from app.services.reporting.document import Column, Section, Table
from app.services.reporting.numbers import count
from app.trajectories.comparison import Difference
from app.trajectories.metrics.accuracy import Accuracy

MOST_UPRIGHT = 6  # systems whose columns fit an upright page
NEITHER, NONE_IN_COMMON = "neither beyond doubt", "no moment in common"


def accuracy(material: ReportMaterial) -> Section:
    """ISO/IEC 18305's metrics, their intervals, EvAAL's score."""
    evaluations = material.evaluations
    tables = (
        metric_table("Accuracy in the terms of ISO/IEC 18305", evaluations, ACCURACY),
        _intervals(material),
        metric_table("EvAAL", evaluations, EVAAL),
    )
    return Section("Accuracy", tables, wide=len(evaluations) > MOST_UPRIGHT)


def _intervals(material: ReportMaterial) -> Table:
    columns = (
        Column("System", align="left"),
        *(Column(name, "Errors in space (interval), m") for name in ("Mean", "RMS", "SE50", "SE95")),
        Column("Block"),
    )
    rows = tuple(
        (
            name,
            *(interval_m(interval) for interval in (found.mean, found.rms, found.median, found.quantile_95)),
            count(found.mean.block),
        )
        for name, found in ((name, evaluation.intervals) for name, evaluation in material.evaluations.items())
    )
    return Table("Confidence intervals", columns, rows, "Block: errors in a row that are alike and stay together.")


def conditions(material: ReportMaterial) -> Section:
    """How much was answered, and how the answers were taken into the reference's time and frame."""
    evaluations = material.evaluations
    tables = (
        metric_table("Availability", evaluations, AVAILABILITY),
        metric_table(
            "Clock and alignment",
            evaluations,
            ALIGNMENT,
            "position in the site = scale · rotation · estimate + translation",
        ),
    )
    return Section("Availability and alignment", tables, wide=len(evaluations) > MOST_UPRIGHT)


def comparison(material: ReportMaterial) -> Section:
    """Every two systems where both have an answer."""
    columns = (
        Column("First", align="left"),
        Column("Second", align="left"),
        Column("Common moments"),
        Column("Difference of means (interval), m"),
        Column("Better", align="left"),
    )
    rows = tuple(_difference(difference) for difference in material.differences)
    note = "Mean error in space of the first less the second's; an interval without 0 tells which is better."
    return Section("Comparison", (Table("Paired differences", columns, rows, note),))


def _difference(difference: Difference) -> tuple[str, ...]:
    better = NONE_IN_COMMON if difference.mean_m is None else difference.better or NEITHER
    return difference.first, difference.second, count(difference.common), interval_m(difference.mean_m), better


def zones(material: ReportMaterial) -> Section:
    """The accuracy of each system in each zone."""
    columns = (
        Column("Zone", align="left"),
        Column("System", align="left"),
        Column("Pairs"),
        *(Column(name, "In the plan, m") for name in ("RMS", "CE50", "CE95")),
        *(Column(name, "In height, m") for name in ("RMS", "VE50", "VE95")),
        *(Column(name, "In space, m") for name in ("RMS", "SE50", "SE95")),
    )
    names = dict.fromkeys(zone for evaluation in material.evaluations.values() for zone in evaluation.zones)
    rows = tuple(
        _zone_row(zone, system, evaluation.zones[zone])
        for zone in names
        for system, evaluation in material.evaluations.items()
        if zone in evaluation.zones
    )
    return Section("Zones", (Table("Accuracy by zone", columns, rows),))


def _zone_row(zone: str, system: str, found: Accuracy) -> tuple[str, ...]:
    levels = (
        level
        for part in (found.horizontal, found.vertical, found.spatial)
        for level in (part.rms, part.median, part.quantile_95)
    )
    return zone, system, count(found.spatial.count), *map(error_m, levels)
