"""What must be known before signing: warnings of the adjustment and everything that it left out."""

from __future__ import annotations

from collections.abc import Iterator

from app.services.reporting.document import Column, Finding, Findings, Paragraph, Section, Table
from app.services.reporting.numbers import fixed, listed
from app.services.survey_report.material import ReportMaterial
from app.services.survey_report.sections.points import doubtful_points

MOST_LISTED = 20
REASONS = {
    "moved": "Moved targets",
    "deformed": "Bent or wrongly printed targets",
    "rays": "Weak targets: too few rays",
    "angle": "Weak targets: rays too nearly parallel",
}
TEXTS = {
    "moved": "in two places during the survey, or posted twice",
    "deformed": "not as flat or as large as the others",
    "rays": "seen by too few photographs that agree on the place",
    "angle": "seen from places that stand too near together",
}
LEFT_OUT = "Not in the map; the table of targets left out says what to do."


def findings(material: ReportMaterial) -> Section:
    """Warnings first, then what the surveyor decided; a sentence when there is nothing to tell."""
    found = sorted(_all(material), key=lambda one: not one.grave)
    if not found:
        return Section("Warnings", (Paragraph("None: nothing was left out and nothing contradicts the result."),))
    return Section("Warnings", (Findings(tuple(found)),))


def _all(material: ReportMaterial) -> Iterator[Finding]:
    yield from (Finding("Adjustment", text, grave=True) for text in material.report.warnings)
    yield from _points(material)
    yield from _targets(material)
    yield from _photographs(material)
    yield from _decisions(material)


def _points(material: ReportMaterial) -> Iterator[Finding]:
    doubtful = doubtful_points(material.report)
    if doubtful:
        text = f"{listed(doubtful, MOST_LISTED)}: the residual is larger than its sigmas let expect. Measure again."
        yield Finding("Doubtful control or check points", text, grave=True)
    checked = any(point.role == "check" and point.residual_m is not None for point in material.report.control)
    if not checked:
        text = "Nothing independent of the adjustment judges this map. Give check points to know its accuracy."
        yield Finding("No check points", text, grave=True)


def _targets(material: ReportMaterial) -> Iterator[Finding]:
    for reason, title in REASONS.items():
        codes = [str(target.code) for target in material.report.left_out if target.reason == reason]
        if codes:
            text = f"{listed(codes, MOST_LISTED)}: {TEXTS[reason]}. {LEFT_OUT}"
            yield Finding(f"{title} ({len(codes)})", text, grave=True)
    false = material.report.false_sightings
    if false:
        seen = listed([f"{one.code} in {one.photo}" for one in false], MOST_LISTED)
        text = f"{seen}: the photograph shows the target where it is not. These sightings were left out."
        yield Finding(f"Misread targets ({len(false)})", text, grave=True)


def _photographs(material: ReportMaterial) -> Iterator[Finding]:
    unoriented = material.unoriented
    if unoriented:
        names = listed([photo.name for photo in unoriented], MOST_LISTED)
        text = f"{names}: took no part. The table of photographs without a pose says why."
        yield Finding(f"Photographs without a pose ({len(unoriented)})", text, grave=True)


def _decisions(material: ReportMaterial) -> Iterator[Finding]:
    excluded, extended = material.excluded, material.extended
    left_out = (
        ("photographs", excluded.images),
        ("targets", tuple(str(code) for code in excluded.codes)),
        ("control or check points", excluded.control_points),
    )
    told = [f"{what} {listed(names, MOST_LISTED)}" for what, names in left_out if names]
    if told:
        yield Finding("Left out on request", f"{'; '.join(told)}.", grave=False)
    if extended is not None:
        yield from _extension(extended.base_version, extended.added, extended.moved)


def _extension(base_version: int, added: tuple[int, ...], moved: tuple[int, ...]) -> Iterator[Finding]:
    text = f"This map extends version {base_version}, whose datum stands. Targets added: {len(added)}."
    yield Finding("Extended map", text, grave=False)
    if moved:
        codes = listed([str(code) for code in moved], MOST_LISTED)
        text = f"Since version {base_version} these targets were moved and stand in their new place: {codes}."
        yield Finding("Targets in a new place", text, grave=True)


def left_out_targets(material: ReportMaterial) -> tuple[Table, ...]:
    """Targets that were seen and are not in the map, and sightings that were left out."""
    report = material.report
    targets = Table(
        "Targets left out of the map",
        (Column("Code"), Column("What is wrong", align="left")),
        tuple((str(target.code), target.detail) for target in report.left_out),
    )
    sightings = Table(
        "Sightings left out",
        (Column("Code"), Column("Photograph", align="left"), Column("Residual, sigmas")),
        tuple((str(one.code), one.photo, fixed(one.sigmas, 1)) for one in report.false_sightings),
    )
    return tuple(table for table in (targets, sightings) if table.rows)


def left_out_photographs(material: ReportMaterial) -> tuple[Table, ...]:
    """Photographs without a pose, and why."""
    if not material.unoriented:
        return ()
    columns = (Column("Photograph", align="left"), Column("Reason", align="left"))
    rows = tuple((photo.name, photo.reason or "") for photo in material.unoriented)
    return (Table("Photographs without a pose", columns, rows),)
