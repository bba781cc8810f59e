"""The last page: how the numbers are to be read, and what is signed."""

from __future__ import annotations

from app.services.reporting.document import Paragraph, Section, Signatures
from app.services.survey_report.material import ReportMaterial

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
    return Section("Signatures", (Signatures(statement, ROLES),))


def conventions() -> Section:
    """How the report's numbers are to be read."""
    text = (
        "Coordinates are in metres in the site frame, Z up. Sigma is one standard deviation; sigmas of positions and "
        "rotations hold along and about the site's axes. A residual is computed minus observed (map minus list for "
        "points). Orientations are unit quaternions x, y, z, w that turn the camera frame (x right, y down, z forward) "
        "or the target frame (x right, y up, z towards the viewer) into the site frame. The angles phi, omega, kappa "
        "give the same rotation, R = site_from_cam diag(1, -1, -1) = R_Y(-phi) R_X(omega) R_Z(kappa); within one "
        "degree of looking along the site's Y axis they are not defined and left out."
    )
    return Section("Conventions", (Paragraph(text),))
