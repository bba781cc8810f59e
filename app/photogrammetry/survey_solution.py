"""The adjusted network of a site with all that is known of its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import Datum
from app.photogrammetry.bundle import BundleOptions
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import whitened_residuals
from app.photogrammetry.covariance import PartedCovariances, part_datum, pose_covariances, reduced_at
from app.photogrammetry.datum import assumed_covariance
from app.photogrammetry.network import Network
from app.photogrammetry.quality import intersection_angles
from app.photogrammetry.site_network import SiteNetwork

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Solution:
    """An adjusted network of the site.

    Attributes
    ----------
    problem : BundleProblem
    network : Network
    parted : PartedCovariances
        Targets' own covariances and the datum.
    photo_covariances : ndarray of shape (P, 6, 6)
        Datum included.
    border_covariance : ndarray of shape (f, f)
        Of the free shared unknowns: nine intrinsics per camera, then the print scale.
    photo_rms_px, target_rms_px : ndarray of shape (P,), (T,)
        Root mean square image residuals per coordinate.
    angles_rad : ndarray of shape (T,)
        Greatest angle between two rays.
    published : ndarray of shape (T,), bool
    """

    problem: BundleProblem
    network: Network
    parted: PartedCovariances
    photo_covariances: Array
    border_covariance: Array
    photo_rms_px: Array
    target_rms_px: Array
    angles_rad: Array
    published: Mask

    @property
    def datum(self) -> Datum:
        """What all targets share."""
        return self.parted.datum


def solve_uncertainty(site: SiteNetwork, published: Mask) -> Solution:
    """Covariances and residuals of an adjusted site network.

    Raises
    ------
    SurveyFailed
        Reason ``weak-network`` when the observations leave something undetermined.
    """
    problem, network = site.problem, site.adjusted.network
    reduced = reduced_at(problem, network, BundleOptions().loss)
    covariances = pose_covariances(reduced, problem.sightings)
    parted = part_datum(covariances, reduced, network, published, problem.plane_m)
    photos = covariances.photos
    if site.assumed is not None:
        parted = replace(
            parted, datum=assumed_covariance(parted.datum, site.assumed.tilt_sigma_rad, _held_sigma(problem))
        )
        shared = [parted.datum.pose_covariance(position_m) for position_m in network.photo_positions_m]
        photos = parted.photos + np.array(shared)
    photo_rms_px, target_rms_px = _image_residuals(problem, network)
    return Solution(
        problem,
        network,
        parted,
        photos,
        covariances.border,
        photo_rms_px,
        target_rms_px,
        intersection_angles(network, problem.sightings),
        published,
    )


def _held_sigma(problem: BundleProblem) -> float:
    """Of the print scale that a map without control takes its own from."""
    return float(problem.prints.sigma[problem.prints.held].min())


def _image_residuals(problem: BundleProblem, network: Network) -> tuple[Array, Array]:
    """Root mean square residuals of photographs (P,) and targets (T,), px per coordinate."""
    sightings = problem.sightings
    squared = np.zeros(len(sightings))
    for camera, chunk in problem.chunks():
        part = sightings.select(chunk).in_pixels()
        residuals = whitened_residuals(network, part, problem.camera_at(network, camera), problem.plane_m)
        squared[chunk] = (residuals**2).sum(axis=(1, 2))
    count = 2.0 * sightings.measured.sum(axis=-1)
    photos = [np.bincount(sightings.photo, values, sightings.photo_count) for values in (squared, count)]
    targets = [np.bincount(sightings.target, values, sightings.target_count) for values in (squared, count)]
    return np.sqrt(photos[0] / photos[1]), np.sqrt(targets[0] / targets[1])
