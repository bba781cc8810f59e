"""How far a target must move during a survey to be found: its least detectable displacement.

Source: Baarda, A testing procedure for use in geodetic networks, 1968: what a test cannot see the result may contain.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import linearise
from app.photogrammetry.network import Network

Array = npt.NDArray[np.float64]

POSITION = slice(0, 3)
HALVES = 2.0  # the adjustment puts a target in the middle of its two places


def least_detectable_m(problem: BundleProblem, network: Network, gross_sigmas: float, sigma0: float) -> Array:
    """Least displacement that is found of each target, shape (T,), metres, in whatever direction shows it worst.

    Parameters
    ----------
    problem : BundleProblem
        With the weights that sightings are judged by; every target is seen.
    network : Network
        Adjusted.
    gross_sigmas, sigma0 : float
        Root mean square residual from which a sighting is false, in standard deviations, and these as a multiple of
        the stated ones.

    Notes
    -----
    One half of the photographs is taken to show the target in its old place and the other half in its new one, d apart.
    A sighting's mean square residual is then d' N d / 4 over its 2 n coordinates, with the information N of its dots on
    the target's place. N and n are taken as the mean of the target's sightings, and d along N's weakest direction. The
    photographs are taken to be held by their other targets: in a sparse network those that show little else may follow
    the target instead.
    """
    sightings = problem.sightings
    information = np.zeros((sightings.target_count, 3, 3))
    for camera, chunk in problem.chunks():
        part = sightings.select(chunk)
        by_place = linearise(network, part, problem.camera_at(network, camera), problem.plane_m).jacobian[..., POSITION]
        by_place = by_place.reshape(len(part), -1, 3)
        np.add.at(information, part.target, np.swapaxes(by_place, -1, -2) @ by_place)
    numbers = 2.0 * np.bincount(sightings.target, sightings.measured.sum(axis=-1), minlength=sightings.target_count)
    # Sums instead of means of both: their ratio is the same.
    weakest = np.linalg.eigvalsh(information)[:, 0]
    return np.asarray(HALVES * gross_sigmas * sigma0 * np.sqrt(numbers / weakest))
