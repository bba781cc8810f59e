"""What is signed."""

from __future__ import annotations

from app.services.survey_report.document import Section, Signatures
from app.services.survey_report.material import ReportMaterial
from app.services.survey_report.sections.summary import unit_note

DIGITS_SIGNED = 16  # of the digest: enough to tell any two maps apart, few enough to compare by eye
ROLES = ("Surveyed by", "Checked by")


def signature(material: ReportMaterial) -> Section:
    """The statement and its lines."""
    heading = material.heading
    which = "the target map" if heading.map_version is None else f"version {heading.map_version} of the target map"
    statement = (
        f"This report describes {which} of the site “{heading.site_name}” with {len(material.target_map.targets)} "
        f"targets, whose SHA-256 ({heading.fingerprint.of}) begins with {heading.fingerprint.sha256[:DIGITS_SIGNED]}. "
        "The warnings above have been read."
    )
    return Section("Signatures", (unit_note(), Signatures(statement, ROLES)))
