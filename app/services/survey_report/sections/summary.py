"""The first page: what the report belongs to and the numbers that judge it."""

from __future__ import annotations

import numpy as np

from app.geometry.target_map import MappedTarget
from app.services.reporting.document import Facts, KeyFigure, KeyFigures, Section
from app.services.reporting.numbers import MISSING, MM_PER_M, count, fixed, millimetres, moment
from app.services.survey_report.material import ReportMaterial
from app.targets.layout import PLATE_SIDE_U


def summary(material: ReportMaterial) -> Section:
    """What was surveyed, and how well."""
    return Section("Summary", (_key_figures(material), Facts(tuple(_facts(material)))))


def _key_figures(material: ReportMaterial) -> KeyFigures:
    report, targets = material.report, material.target_map.targets
    oriented = len(material.photos) - len(material.unoriented)
    return KeyFigures(
        (
            KeyFigure(f"{oriented} of {len(material.photos)}", "photographs oriented"),
            KeyFigure(count(len(targets)), "targets in the map", _rays(targets)),
            _rmse(report.check_rmse_m, "check", material),
            _rmse(report.control_rmse_m, "control", material),
            _target_sigma(material),
            KeyFigure(fixed(report.sigma0, 2), "sigma0", f"redundancy {count(report.redundancy)}"),
        )
    )


def _rays(targets: tuple[MappedTarget, ...]) -> str:
    rays = [target.rays for target in targets]
    return f"{min(rays)} to {max(rays)} rays, median {np.median(rays):.0f}"


def _rmse(rmse_m: float | None, role: str, material: ReportMaterial) -> KeyFigure:
    used = sum(point.role == role and point.residual_m is not None for point in material.report.control)
    value = MISSING if rmse_m is None else f"{millimetres(rmse_m)} mm"
    detail = f"3-D, {used} {role} point{'' if used == 1 else 's'}" if used else f"no {role} point was measured"
    return KeyFigure(value, f"RMSE of {role} points", detail)


def _target_sigma(material: ReportMaterial) -> KeyFigure:
    """Of a typical target: in the site, and against its neighbours."""
    shared = [
        material.target_map.datum.pose_covariance(target.site_from_target.position_m)[:3, :3]
        for target in material.target_map.targets
    ]
    own = np.array([target.covariance[:3, :3] for target in material.target_map.targets])
    own_m, whole_m = (
        float(np.median(np.sqrt(np.trace(covariances, axis1=1, axis2=2))))
        for covariances in (own, own + np.array(shared))
    )
    detail = f"median, 3-D; {millimetres(own_m)} mm without the datum's part"
    return KeyFigure(f"{millimetres(whole_m)} mm", "sigma of a target's position", detail)


def _facts(material: ReportMaterial) -> list[tuple[str, str]]:
    heading, target_map = material.heading, material.target_map
    version = None if heading.map_version is None else str(heading.map_version)
    u_mm = MM_PER_M * target_map.u_m
    plates = f"code family {target_map.code_family}, u = {u_mm:g} mm, side {PLATE_SIDE_U * u_mm:g} mm"
    known = (
        ("Site", heading.site_name),
        ("Site id", heading.site_id),
        ("Map version", version),
        ("Survey", heading.survey_id),
        ("Note", heading.survey_note),
        ("Datum", _datum(material)),
        ("Plates", plates),
        ("Map built", moment(heading.built_s)),
        ("Report written", moment(heading.written_s)),
        ("Software", heading.software),
        (f"SHA-256 of {heading.fingerprint.of}", heading.fingerprint.sha256),
    )
    return [(name, text) for name, text in known if text]


def _datum(material: ReportMaterial) -> str:
    if material.extended is not None:
        return f"that of map version {material.extended.base_version}, which this map extends"
    if material.target_map.datum.assumed_scale:
        return "assumed: scale from the printed size of the plates, axes from the plates"
    used = [point.name for point in material.report.control if point.role == "control" and point.residual_m is not None]
    return f"control points {', '.join(used)}"
