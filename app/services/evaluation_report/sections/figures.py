"""Sections of figures: all systems together, then each by itself."""

from __future__ import annotations

from app.services.evaluation_report.figures.boxes import boxes
from app.services.evaluation_report.figures.components import components
from app.services.evaluation_report.figures.cumulative import cumulative_parts, cumulative_rotation, cumulative_spatial
from app.services.evaluation_report.figures.histogram import histogram
from app.services.evaluation_report.figures.over_time import over_time
from app.services.evaluation_report.figures.plan_view import plan_view
from app.services.evaluation_report.look import pens
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.document import Section


def distributions(material: ReportMaterial) -> Section:
    """Cumulative curves and boxes of all systems."""
    curves = cumulative_spatial(material.evaluations), cumulative_parts(material.evaluations)
    rotation = cumulative_rotation(material.evaluations)
    turned = () if rotation is None else (rotation,)
    return Section("Distribution of the errors", (*curves, *turned, boxes(material)))


def systems(material: ReportMaterial) -> tuple[Section, ...]:
    """The figures of each system."""
    inks = {name: pen.ink for name, pen in pens(list(material.evaluations)).items()}
    return tuple(
        Section(
            name,
            (
                plan_view(evaluation, material.zones),
                over_time(evaluation, inks[name]),
                components(evaluation, inks[name]),
                histogram(evaluation, inks[name]),
            ),
        )
        for name, evaluation in material.evaluations.items()
    )
