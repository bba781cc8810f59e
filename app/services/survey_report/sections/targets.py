"""The targets of the map: pose, sigmas, rays, residuals."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import MappedTarget
from app.photogrammetry.report import TargetRecord
from app.services.reporting.document import Column, Section, Table
from app.services.reporting.numbers import fixed, metres, millimetres, pixels
from app.services.survey_report.material import ReportMaterial
from app.services.survey_report.sections.findings import left_out_targets
from app.services.survey_report.sections.photographs import QUATERNION_DIGITS

COLUMNS = (
    Column("Code"),
    *(Column(axis, "Centre, m") for axis in "XYZ"),
    *(Column(axis, "Sigma, mm") for axis in "XYZ"),
    *(Column(axis, "Own sigma, mm") for axis in "XYZ"),
    *(Column(part, "Orientation") for part in "xyzw"),
    Column("Rays"),
    Column("Angle, degrees"),
    Column("Detectable, mm"),
    Column("RMS, px"),
)
NOTE = (
    "Own sigma leaves out what all targets share, the datum. Angle: the greatest between two rays. "
    "Detectable: the least displacement during the survey that is found in four of five cases, in whatever direction, "
    "when half of the photographs show either place; a target may have moved by less, and one that fewer than four "
    "photographs show by anything."
)
BASE_NOTE = " Targets without an angle are those of the base map that this survey did not see or did not change."


def targets(material: ReportMaterial) -> Section:
    """All targets of the map, then those that are not in it."""
    records = {target.code: target for target in material.report.targets}
    rows = tuple(_row(target, records.get(target.code), material) for target in material.target_map.targets)
    note = NOTE + BASE_NOTE if material.extended is not None else NOTE
    return Section(
        "Targets", (*left_out_targets(material), Table("Poses of the targets", COLUMNS, rows, note)), wide=True
    )


def _row(target: MappedTarget, record: TargetRecord | None, material: ReportMaterial) -> tuple[str, ...]:
    pose = target.site_from_target
    shared = material.target_map.datum.pose_covariance(pose.position_m)
    return (
        str(target.code),
        *map(metres, pose.position_m),
        *map(millimetres, _sigmas_m(target.covariance + shared)),
        *map(millimetres, _sigmas_m(target.covariance)),
        *(fixed(part, QUATERNION_DIGITS) for part in pose.orientation_xyzw),
        str(target.rays),
        fixed(None if record is None else record.intersection_deg, 1),
        millimetres(None if record is None else record.detectable_m),
        pixels(target.rms_px),
    )


def _sigmas_m(covariance: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(np.sqrt(np.diag(covariance)[:3]))
