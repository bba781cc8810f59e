"""One adjustment of a calibration's photographs: poses and camera free, the map's targets weighted by the map.

It is the survey's bundle adjustment with what a map knows in place of control points. The weights come from the
residuals themselves, as in a survey, so that the camera's covariance is honest where the dots' errors are shared.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import CalibrationFailed
from app.geometry.camera import CalibratedCamera
from app.geometry.target_map import MappedTarget, TargetMap
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.calibration.orient import Oriented, OrientOptions
from app.photogrammetry.collinearity import whitened_residuals
from app.photogrammetry.covariance import pose_covariances, reduced_at
from app.photogrammetry.equations import PoseEquations
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.prints import PRINT_SIGMA, one_batch
from app.photogrammetry.self_calibration import SelfCalibration, self_calibrate
from app.photogrammetry.sightings import gather_sightings
from app.photogrammetry.variance_components import ComponentOptions, estimate_components
from app.targets.layout import dot_centres_u

Array = npt.NDArray[np.float64]

FEWEST_PHOTOS = 5  # of the published range of 5 to 20; fewer cannot show a scatter, and one bad one outweighs the rest

SCATTER_DOUBT = 1.0  # standard deviations: a dozen photographs do not show a scatter of 0.1 % that moves a pose

# Paper on a wall is not known better than this, whatever an adjustment says: 0.02 mm, and the turn that moves a plate's
# corner (some 40 mm from its middle) by as much.
LEAST_OWN_SIGMAS = np.array([2e-5] * 3 + [5e-4] * 3)


@dataclass(frozen=True)
class AdjustedCamera:
    """The adjustment of a calibration.

    Attributes
    ----------
    problem : BundleProblem
        One camera; its prior is what was known before.
    network : Network
        Adjusted, in the site frame.
    found : SelfCalibration
    rms_residual_px : float
        Per coordinate.
    photo_rms_px : ndarray of shape (P,)
        The same of each photograph.
    """

    problem: BundleProblem
    network: Network
    found: SelfCalibration
    rms_residual_px: float
    photo_rms_px: Array

    @property
    def prior(self) -> CalibratedCamera:
        """What was known of the camera before."""
        return self.problem.cameras[0]

    def known_at_most(self, options: OrientOptions) -> CalibratedCamera:
        """The camera for a second look at its photographs: each of them may have focused otherwise."""
        calibrated = self.found.calibrated
        breathing_px = np.zeros(len(calibrated.covariance))
        breathing_px[:2] = options.breathing * calibrated.camera.intrinsics[:2]
        return replace(calibrated, covariance=calibrated.covariance + np.outer(breathing_px, breathing_px))


def adjust_camera(oriented: Oriented, target_map: TargetMap) -> AdjustedCamera:
    """Adjust poses, camera and, within their covariances, targets.

    Raises
    ------
    CalibrationFailed
        Reason ``too-few-photos`` when too few photographs are oriented.
    """
    _check_enough(oriented)
    problem, network = _problem(oriented, target_map)
    bundle = BundleOptions()
    network = adjust_bundle(problem, network, bundle).network
    reduced = reduced_at(problem, network, bundle.loss)
    components = estimate_components(problem, network, reduced, bundle.loss, ComponentOptions())
    problem = problem.with_sightings(problem.sightings.correlated(components.sigmas))
    network = adjust_bundle(problem, network, bundle).network
    covariances = pose_covariances(reduced_at(problem, network, bundle.loss), problem.sightings)
    (found,) = self_calibrate(problem, network, covariances.border, covariances.targets, SCATTER_DOUBT)
    found = replace(found, calibrated=replace(found.calibrated, source="calibration"))
    return AdjustedCamera(problem, network, found, *_rms_px(problem, network))


def _check_enough(oriented: Oriented) -> None:
    count, left_out = len(oriented.photos), oriented.left_out
    if count >= FEWEST_PHOTOS:
        return
    reasons = "; ".join(f"{photo.name}: {photo.detail}" for photo in left_out)
    raise CalibrationFailed(
        f"{count} photographs can be oriented in the map and a calibration takes {FEWEST_PHOTOS} at least: add some "
        f"that show several targets, near and far, over the whole picture. {reasons}".strip(),
        reason="too-few-photos",
        photos=[photo.name for photo in oriented.photos],
        left_out=[vars(photo) for photo in left_out],
    )


def _problem(oriented: Oriented, target_map: TargetMap) -> tuple[BundleProblem, Network]:
    sightings, codes = gather_sightings([photo.detection for photo in oriented.photos])
    targets = [target_map.by_code[int(code)] for code in codes]
    poses = [resection.site_from_cam for resection in oriented.resections]
    network = Network(
        photo_rotations=np.array([pose.rotation for pose in poses]),
        photo_positions_m=np.array([pose.position_m for pose in poses]),
        target_rotations=np.array([target.site_from_target.rotation for target in targets]),
        target_positions_m=np.array([target.site_from_target.position_m for target in targets]),
        intrinsics=oriented.prior.camera.intrinsics[None],
        print_scale=_print_scales(targets, target_map.u_m),
    )
    own = np.array([target.covariance for target in targets]) + np.diag(LEAST_OWN_SIGMAS**2)
    known = PoseEquations(
        np.arange(len(targets)), network.target_rotations, network.target_positions_m, np.linalg.inv(own)
    )
    cameras = np.zeros(len(poses), dtype=np.intp)
    prints = one_batch(len(targets), PRINT_SIGMA, held=True)
    return BundleProblem(sightings, cameras, (oriented.prior,), target_map.u_m, prints, target_poses=known), network


def _print_scales(targets: list[MappedTarget], u_m: float) -> Array:
    """Printed over nominal length along x and y of each plate, shape (T, 2), as the map's dots show it."""
    plane_m = dot_centres_u() * u_m
    scales = np.empty((len(targets), 2))
    for row, target in enumerate(targets):
        local_m = target.site_from_target.inverse().apply(target.dots_m)[:, :2]
        scales[row] = (local_m * plane_m).sum(axis=0) / (plane_m**2).sum(axis=0)
    return scales


def _rms_px(problem: BundleProblem, network: Network) -> tuple[float, Array]:
    """Per coordinate, of all photographs together and of each."""
    sightings = problem.sightings
    residuals_px = whitened_residuals(network, sightings.in_pixels(), problem.camera_at(network, 0), problem.plane_m)
    squares_px2 = np.bincount(sightings.photo, (residuals_px**2).sum(axis=(1, 2)), sightings.photo_count)
    coordinates = 2.0 * np.bincount(sightings.photo, sightings.measured.sum(axis=1), sightings.photo_count)
    return float(np.sqrt(squares_px2.sum() / coordinates.sum())), np.sqrt(squares_px2 / coordinates)


assert len(LEAST_OWN_SIGMAS) == POSE_COUNT
