"""What each sighting of a target says against the others, and how much of that is chance.

A sighting pulls at its target: the gradient of its weighted squares by the target's step. In an adjusted network the
pulls of a target cancel. Their covariance says how much of each is left to see, since the photographs, the cameras and
the target itself follow what is wrong (Baarda, A testing procedure for use in geodetic networks, 1968, the reliability
matrix), and what a lens adds whose focal length and principal point differ from photograph to photograph.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import CAMERA_COLUMNS, COLUMN_COUNT, linearise
from app.photogrammetry.covariance import reduced_at
from app.photogrammetry.inverse_parts import TargetPart, inverse_parts
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.reduced_system import ReducedSystem
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.self_calibration import SCATTERED_COUNT, CameraScatter, self_calibrate
from app.photogrammetry.variance_components import shared_columns

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

# Of the target's own information: what photographs hide to the last digit is not read out of rounding.
RIDGE = 1e-6
SCALING_TARGETS = 300  # give the residuals' scale to 1 %
SCALINGS = 4  # after which the scale stands to a percent
LEAST_VARIANCE = 0.01  # of the stated ones: exact observations are synthetic


@dataclass(frozen=True)
class TargetPulls:
    """The n sightings of one target.

    Attributes
    ----------
    target : int
    rows : ndarray of shape (n,)
        Its sightings.
    pulls : ndarray of shape (n, 6)
        Weighted by their covariance.
    information : ndarray of shape (n, 6, n, 6)
        Covariance of the pulls when nothing is wrong, and at the same time their change by steps of the target in some
        photographs alone: information on such steps.
    squares : float
        All contradiction among the sightings, chi-square distributed by ``freedom`` when nothing is wrong.
    """

    target: int
    rows: Index
    pulls: Array
    information: Array
    squares: float

    @property
    def freedom(self) -> int:
        """Steps of the sightings against each other."""
        return POSE_COUNT * (len(self.rows) - 1)


def target_pulls(problem: BundleProblem, network: Network, loss: RobustLoss, fewest: int) -> tuple[TargetPulls, ...]:
    """Pulls at all targets with so many sightings.

    Parameters
    ----------
    problem : BundleProblem
    network : Network
        Adjusted with that loss.
    loss : RobustLoss
    fewest : int

    Raises
    ------
    SurveyFailed
        Reason ``weak-network`` when the observations leave something undetermined.
    """
    reduced = reduced_at(problem, network, loss)
    scatters = [camera.scatter for camera in self_calibrate(problem, network, reduced.factor.border_inverse())]
    products = _products(problem, network, loss, scatters)
    known = [
        _Known(part, *_covariances(problem, reduced, products, part), _cancelled(products, part.rows))
        for front in inverse_parts(reduced, problem.sightings)
        for part in front.targets
        if len(part.rows) >= fewest
    ]
    variance = _variance(known)
    return tuple(one.weighted(variance) for one in known)


@dataclass(frozen=True)
class _Known:
    """A target's pulls (n, 6) and the two parts of their covariance: of the dots, as stated, and of the lens.

    The first is also how the pulls respond to steps of the target: what is redundant of the sightings' information.
    """

    part: TargetPart
    of_dots: Array
    of_lens: Array
    pulls: Array

    @property
    def freedom(self) -> int:
        """Steps of the sightings against each other."""
        return POSE_COUNT * (len(self.pulls) - 1)

    def squares(self, variance: float) -> float:
        """All contradiction, with the dots' variances multiplied."""
        covariance = (variance * self.of_dots + self.of_lens).reshape(self.pulls.size, -1)
        return float(self.pulls.ravel() @ np.linalg.solve(covariance, self.pulls.ravel()))

    def weighted(self, variance: float) -> TargetPulls:
        """The pulls of least variance (Gauss, Markov), with the dots' variances multiplied.

        A step s in some photographs changes the pulls x, of covariance Q, by R s. So R Q^-1 x tells all that x tells of
        it; its covariance, and its change by s, is R Q^-1 R.
        """
        response = self.of_dots.reshape(self.pulls.size, -1)
        covariance = variance * response + self.of_lens.reshape(response.shape)
        solved = np.linalg.solve(covariance, np.column_stack([self.pulls.ravel(), response]))
        pulls, information = response @ solved[:, 0], response @ solved[:, 1:]
        return TargetPulls(
            self.part.target,
            self.part.rows,
            pulls.reshape(self.pulls.shape),
            information.reshape(self.of_dots.shape),
            float(self.pulls.ravel() @ solved[:, 0]),
        )


def _variance(known: Sequence[_Known]) -> float:
    """Factor of the dots' variances by which the median target contradicts itself as chance has it."""
    every = known[:: max(1, len(known) // SCALING_TARGETS)]
    variance = 1.0
    for _ in range(SCALINGS if known else 0):
        variance *= float(np.median([one.squares(variance) / one.freedom for one in every]))
        variance = max(variance, LEAST_VARIANCE)
    return variance


@dataclass(frozen=True)
class _Products:
    """Of M sightings, each dot with its robust weight.

    Attributes
    ----------
    by_columns : ndarray of shape (M, 6, 18)
        The target's columns times all columns and the residuals.
    turned : ndarray of shape (M, 6, 6)
        The target's step that shows as a photograph's step.
    lens : ndarray of shape (M, 6, 3)
        Change of the pull by one standard deviation of the photograph's focal length and principal point, which its
        pose follows.
    """

    by_columns: Array
    turned: Array
    lens: Array

    @property
    def information(self) -> Array:
        """On the target's step, shape (M, 6, 6)."""
        return self.by_columns[..., :POSE_COUNT]

    @property
    def pulls(self) -> Array:
        """Shape (M, 6)."""
        return self.by_columns[..., COLUMN_COUNT]


def _products(
    problem: BundleProblem, network: Network, loss: RobustLoss, scatters: Sequence[CameraScatter]
) -> _Products:
    count = len(problem.sightings)
    by_columns = np.empty((count, POSE_COUNT, COLUMN_COUNT + 1))
    turned, lens = np.empty((count, POSE_COUNT, POSE_COUNT)), np.empty((count, POSE_COUNT, SCATTERED_COUNT))
    for camera, chunk in problem.chunks():
        part, adjusted = problem.sightings.select(chunk), problem.camera_at(network, camera)
        equations = linearise(network, part, adjusted, problem.plane_m)
        weight = loss.weight((equations.residuals**2).sum(axis=-1))
        rows = (equations.rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, COLUMN_COUNT + 1)
        by_columns[chunk] = np.swapaxes(rows[..., :POSE_COUNT], -1, -2) @ rows
        turned[chunk] = equations.target_step_from_photo_step
        lens[chunk] = by_columns[chunk][..., CAMERA_COLUMNS] @ scatters[camera].deviations(adjusted)
    return _Products(by_columns, turned, _after_pose(problem.sightings.photo, by_columns, turned, lens))


def _after_pose(photo: Index, by_columns: Array, turned: Array, lens: Array) -> Array:
    """What is left of changes of the pulls, shape (M, 6, 3), when each photograph's pose has followed them."""
    count = int(photo.max()) + 1
    pose, across = np.zeros((count, POSE_COUNT, POSE_COUNT)), np.zeros((count, POSE_COUNT, SCATTERED_COUNT))
    by_photo = by_columns[..., :POSE_COUNT] @ turned
    np.add.at(pose, photo, np.swapaxes(turned, -1, -2) @ by_photo)
    np.add.at(across, photo, np.swapaxes(turned, -1, -2) @ lens)
    return np.asarray(lens - by_photo @ (np.linalg.pinv(pose, hermitian=True) @ across)[photo])


def _cancelled(products: _Products, rows: Index) -> Array:
    """A target's pulls, shape (n, 6), without what the last step of the adjustment has left of their sum."""
    own, pulls = products.information[rows], products.pulls[rows]
    return np.asarray(pulls - own @ np.linalg.solve(own.sum(axis=0), pulls.sum(axis=0)))


def _covariances(
    problem: BundleProblem, reduced: ReducedSystem, products: _Products, part: TargetPart
) -> tuple[Array, Array]:
    """Of a target's pulls, shape (n, 6, n, 6) each: of the dots, by their stated sigmas, and of the lens."""
    rows, count = part.rows, len(part.rows)
    own, every = products.information[rows], np.arange(count)
    followed = _followed(problem, products, part)
    stacked = own.reshape(-1, POSE_COUNT)
    derivative = stacked @ part.gain + followed
    fitted = stacked @ reduced.target_inverse[part.target] @ stacked.T + derivative @ part.inverse @ derivative.T
    of_dots = -fitted.reshape(count, POSE_COUNT, count, POSE_COUNT)
    of_dots[every, :, every] += own * (1.0 + RIDGE)
    lens = np.zeros((count, POSE_COUNT, count, SCATTERED_COUNT))
    lens[every, :, every] = products.lens[rows]
    lens -= (own @ np.linalg.solve(own.sum(axis=0), lens.sum(axis=0).reshape(POSE_COUNT, -1))).reshape(lens.shape)
    of_lens = lens.reshape(count * POSE_COUNT, -1)
    return of_dots, (of_lens @ of_lens.T).reshape(of_dots.shape)


def _followed(problem: BundleProblem, products: _Products, part: TargetPart) -> Array:
    """Derivative of a target's pulls by its photographs and the shared unknowns, shape (6 n, 6 n + f)."""
    rows, count = part.rows, len(part.rows)
    photos = np.zeros((count, POSE_COUNT, count, POSE_COUNT))
    photos[np.arange(count), :, np.arange(count)] = products.information[rows] @ products.turned[rows]
    shared = np.zeros((count, POSE_COUNT, part.inverse.shape[0] - POSE_COUNT * count))
    cameras = problem.camera_of_photo[problem.sightings.photo[rows]]
    for camera in np.unique(cameras):
        columns, places = shared_columns(problem, int(camera), int(problem.prints.batch[part.target]))
        of_camera = np.flatnonzero(cameras == camera)
        shared[np.ix_(of_camera, np.arange(POSE_COUNT), places)] = products.by_columns[rows[of_camera]][..., columns]
    flat = POSE_COUNT * count
    return np.concatenate([photos.reshape(flat, flat), shared.reshape(flat, -1)], axis=1)
