"""The cameras as the survey found them, and what their models leave in the images."""

from __future__ import annotations

from app.photogrammetry.image_residuals import ImageResiduals
from app.photogrammetry.report import CameraRecord
from app.services.reporting.document import Block, Column, Facts, Section, Table
from app.services.reporting.numbers import fixed, pixels
from app.services.survey_report.figures.residual_field import residual_field
from app.services.survey_report.figures.residual_histogram import residual_histogram
from app.services.survey_report.material import ReportMaterial

LENGTHS = ("fx", "fy", "cx", "cy")  # in px; the others are numbers
LENGTH_DIGITS, NUMBER_DIGITS = 3, 6
PERCENT = 100.0


def cameras(material: ReportMaterial) -> tuple[Section, ...]:
    """A section for each camera."""
    pairs = list(zip(material.report.cameras, material.report.image_residuals, strict=True))
    return tuple(
        Section("Camera" if len(pairs) == 1 else f"Camera {number}", _camera(*pair))
        for number, pair in enumerate(pairs, start=1)
    )


def _camera(camera: CameraRecord, found: ImageResiduals) -> tuple[Block, ...]:
    blocks: tuple[Block, ...] = (_facts(camera, found), _intrinsics(camera), residual_field(camera, found))
    return (*blocks, residual_histogram(found)) if found.rms_px > 0 else blocks


def _facts(camera: CameraRecord, found: ImageResiduals) -> Facts:
    x_px, y_px = camera.centre_scatter_px
    return Facts(
        (
            ("Camera", " ".join(part for part in camera.key.split("|") if part)),
            ("Photographs", str(camera.photographs)),
            ("Image", f"{camera.width_px} x {camera.height_px} px"),
            ("Root mean square residual", f"{pixels(found.rms_px)} px per coordinate"),
            (
                "Scatter between photographs",
                f"focal length {fixed(PERCENT * camera.focal_scatter, 3)} %, principal point {fixed(x_px, 2)} and "
                f"{fixed(y_px, 2)} px; a snapshot's camera is known no better than this",
            ),
        )
    )


def _intrinsics(camera: CameraRecord) -> Table:
    """Values, sigmas and correlations in one table: a line per parameter."""
    columns = (
        Column("", align="left"),
        Column("Value"),
        Column("Sigma"),
        *(Column(name, "Correlation") for name in camera.names),
    )
    rows = []
    for index, name in enumerate(camera.names):
        digits = LENGTH_DIGITS if name in LENGTHS else NUMBER_DIGITS
        correlations = [
            fixed(value, 2) if other < index else "" for other, value in enumerate(camera.correlations[index])
        ]
        unit = ", px" if name in LENGTHS else ""
        value, sigma = fixed(camera.intrinsics[index], digits), fixed(camera.sigmas[index], digits)
        rows.append((f"{name}{unit}", value, sigma, *correlations))
    note = "Brown-Conrady in OpenCV's order; pixel (0, 0) is the centre of the top left pixel."
    return Table("Intrinsics with standard deviations and correlations", columns, tuple(rows), note)
