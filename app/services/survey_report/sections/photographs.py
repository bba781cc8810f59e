"""The photographs: pose, sigmas, residuals."""

from __future__ import annotations

import numpy as np

from app.geometry.pose import Pose
from app.geometry.rotation import photogrammetric_angles_deg
from app.photogrammetry.report import PhotoRecord
from app.services.reporting.document import Block, Column, Section, Table
from app.services.reporting.numbers import MDEG_PER_DEG, MISSING, fixed, metres, millimetres, pixels
from app.services.survey_report.figures.photo_residuals import photo_residuals
from app.services.survey_report.material import ReportMaterial
from app.services.survey_report.sections.findings import left_out_photographs

ANGLE_DIGITS, QUATERNION_DIGITS, TURN_DIGITS = 4, 6, 1
COLUMNS = (
    Column("No."),
    Column("Photograph", align="left"),
    *(Column(axis, "Projection centre, m") for axis in "XYZ"),
    *(Column(axis, "Sigma, mm") for axis in "XYZ"),
    *(Column(angle, "Angles, degrees") for angle in ("phi", "omega", "kappa")),
    *(Column(part, "Orientation") for part in "xyzw"),
    *(Column(axis, "Sigma of rotation, mdeg") for axis in "XYZ"),
    Column("Targets"),
    Column("RMS, px"),
)


def photographs(material: ReportMaterial) -> Section:
    """All photographs, and how well they fit."""
    photos = material.report.photos
    several = len(material.report.cameras) > 1
    keys = [camera.key for camera in material.report.cameras]
    numbers = [str(keys.index(photo.camera) + 1) for photo in photos]
    columns = (*COLUMNS, Column("Camera")) if several else COLUMNS
    rows = [
        (*_row(index, photo), number) if several else _row(index, photo)
        for index, (photo, number) in enumerate(zip(photos, numbers, strict=True), start=1)
    ]
    table = Table("Poses of the photographs", columns, tuple(rows))
    blocks: tuple[Block, ...] = (*left_out_photographs(material), photo_residuals(photos), table)
    return Section("Photographs", blocks, wide=True)


def _row(number: int, photo: PhotoRecord) -> tuple[str, ...]:
    turn_mdeg = MDEG_PER_DEG * np.degrees(photo.rotation_sigma_rad)
    return (
        str(number),
        photo.name,
        *map(metres, photo.position_m),
        *map(millimetres, photo.position_sigma_m),
        *_angles(photo),
        *(fixed(part, QUATERNION_DIGITS) for part in photo.orientation_xyzw),
        *(fixed(sigma, TURN_DIGITS) for sigma in turn_mdeg),
        str(photo.targets),
        pixels(photo.rms_px),
    )


def _angles(photo: PhotoRecord) -> tuple[str, ...]:
    pose = Pose.from_quaternion(photo.orientation_xyzw, photo.position_m)
    angles_deg = photogrammetric_angles_deg(pose.rotation)
    if angles_deg is None:
        return (MISSING, MISSING, MISSING)
    return tuple(fixed(angle, ANGLE_DIGITS) for angle in angles_deg)
