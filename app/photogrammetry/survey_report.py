"""Write the adjustment report of a survey."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_NAMES, CameraIdentity
from app.geometry.control import ControlPoint, Role
from app.photogrammetry.bundle import BundleOptions
from app.photogrammetry.control import match_points
from app.photogrammetry.image_residuals import ImageResiduals, image_residuals
from app.photogrammetry.print_records import batch_records, batch_warnings, largest_print
from app.photogrammetry.report import (
    AdjustmentReport,
    CameraRecord,
    ControlRecord,
    DatumRecord,
    FalseSightingRecord,
    LeftOutRecord,
    PhotoRecord,
    TargetRecord,
    UnorientedRecord,
)
from app.photogrammetry.self_calibration import SelfCalibration
from app.photogrammetry.site_network import redundancy
from app.photogrammetry.survey_input import Unoriented
from app.photogrammetry.survey_outcome import SurveyOutcome
from app.photogrammetry.survey_result import adjusted_photos, mapped_targets
from app.photogrammetry.survey_solution import Solution

Array = npt.NDArray[np.float64]


def write_report(
    outcome: SurveyOutcome,
    cameras: Sequence[SelfCalibration],
    unoriented: Sequence[Unoriented],
    left_out: Sequence[LeftOutRecord],
) -> AdjustmentReport:
    """The report of a survey."""
    survey, site, solution = outcome.survey, outcome.site, outcome.solution
    control, control_rmse_m = _points(outcome, "control")
    check, check_rmse_m = _points(outcome, "check")
    degrees_of_freedom = redundancy(solution.problem)
    batches = batch_records(solution, outcome.codes, survey.batch_names)
    return AdjustmentReport(
        # The image weights were scaled once by what the free network showed.
        sigma0=site.components.sigma0 * float(np.sqrt(site.adjusted.cost / degrees_of_freedom)),
        plate_sigmas=site.components.sigmas,
        redundancy=degrees_of_freedom,
        observations=2 * int(solution.problem.sightings.measured.sum()),
        steps=site.adjusted.steps,
        converged=site.adjusted.converged,
        datum=_datum(solution),
        print_scale=largest_print(solution),
        print_batches=batches,
        cameras=tuple(_camera(*pair) for pair in zip(survey.identities, cameras, strict=True) if pair[1].photographs),
        control=(*control, *check),
        control_rmse_m=control_rmse_m,
        check_rmse_m=check_rmse_m,
        photos=_photos(outcome),
        unoriented=tuple(UnorientedRecord(photo.name, photo.reason) for photo in unoriented),
        targets=_targets(outcome),
        left_out=tuple(left_out),
        false_sightings=_false_sightings(outcome),
        warnings=(*site.warnings, *batch_warnings(batches), *_warnings(outcome)),
        image_residuals=_image_residuals(outcome, cameras),
    )


def _points(outcome: SurveyOutcome, role: Role) -> tuple[tuple[ControlRecord, ...], float | None]:
    """Points of one role with what the map says of them, and their root mean square 3-D residual."""
    solution = outcome.solution
    matched = match_points(outcome.points, role, outcome.standing, solution.problem.u_m)
    residuals_m = matched.equations.computed_m(solution.network) - matched.equations.position_m
    seen = [_point(*pair) for pair in zip(matched.points, residuals_m, strict=True)]
    unseen = [_point(point, None) for point in matched.unseen]
    rmse_m = float(np.sqrt((residuals_m**2).sum(axis=1).mean())) if seen else None
    return (*seen, *unseen), rmse_m


def _point(point: ControlPoint, residual_m: Array | None) -> ControlRecord:
    return ControlRecord(point.name, point.code, point.dot, point.role, point.position_m, point.sigma_m, residual_m)


def _datum(solution: Solution) -> DatumRecord:
    datum = solution.datum
    sigma = np.sqrt(np.diag(datum.covariance))
    return DatumRecord(
        datum.origin_m, sigma[:3], sigma[3:6], float(sigma[6]), datum.assumed_scale, datum.assumed_orientation
    )


def _camera(identity: CameraIdentity, camera: SelfCalibration) -> CameraRecord:
    sigmas = np.sqrt(np.diag(camera.posterior))
    return CameraRecord(
        identity.key,
        camera.photographs,
        identity.width_px,
        identity.height_px,
        INTRINSIC_NAMES,
        camera.calibrated.camera.intrinsics,
        sigmas,
        camera.posterior / np.outer(sigmas, sigmas),
        camera.scatter.focal,
        camera.scatter.centre_px,
    )


def _photos(outcome: SurveyOutcome) -> tuple[PhotoRecord, ...]:
    records = []
    for photo in adjusted_photos(outcome.solution, outcome.names, outcome.survey.identities, outcome.codes):
        sigma = np.sqrt(np.diag(photo.covariance))
        pose = photo.site_from_cam
        records.append(
            PhotoRecord(
                photo.name,
                photo.camera_key,
                pose.position_m,
                pose.orientation_xyzw,
                sigma[:3],
                sigma[3:],
                photo.rms_px,
                photo.target_count,
            )
        )
    return tuple(records)


def _targets(outcome: SurveyOutcome) -> tuple[TargetRecord, ...]:
    solution, records = outcome.solution, []
    angles_deg = np.degrees(solution.angles_rad[solution.published])
    detectable_m = outcome.clean.detectable_m[solution.published]
    targets = mapped_targets(solution, outcome.codes)
    for target, angle_deg, least_m in zip(targets, angles_deg, detectable_m, strict=True):
        pose = target.site_from_target
        shared = solution.datum.pose_covariance(pose.position_m)
        records.append(
            TargetRecord(
                target.code,
                pose.position_m,
                pose.orientation_xyzw,
                np.sqrt(np.diag(target.covariance + shared)[:3]),
                np.sqrt(np.diag(target.covariance)[:3]),
                target.rays,
                float(angle_deg),
                target.rms_px,
                float(least_m) if np.isfinite(least_m) else None,
            )
        )
    return tuple(records)


def _image_residuals(outcome: SurveyOutcome, cameras: Sequence[SelfCalibration]) -> tuple[ImageResiduals, ...]:
    weights = BundleOptions().loss.weight(outcome.site.adjusted.squared)
    found = image_residuals(outcome.solution.problem, outcome.solution.network, weights)
    return tuple(one for one, camera in zip(found, cameras, strict=True) if camera.photographs)


def _false_sightings(outcome: SurveyOutcome) -> tuple[FalseSightingRecord, ...]:
    survey = outcome.survey
    return tuple(
        FalseSightingRecord(survey.names[one.photo], int(survey.codes[one.target]), one.sigmas)
        for one in outcome.clean.findings.sightings
    )


def _warnings(outcome: SurveyOutcome) -> tuple[str, ...]:
    """What the surveyor should look at beside what the report lists as left out."""
    warnings = []
    carrying = outcome.codes[outcome.standing.carrying]
    unseen = [point.name for point in outcome.points if point.code not in carrying]
    if unseen:
        warnings.append(
            f"Control or check points {', '.join(unseen)} are on targets that fewer than two photographs show."
        )
    if not outcome.site.adjusted.converged:
        warnings.append("The adjustment ran out of steps before it converged: look for contradictions and build again.")
    return tuple(warnings)
