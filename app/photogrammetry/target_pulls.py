"""What each sighting of a target says against the others, and how much of that is chance.

A sighting pulls at its target: the gradient of its weighted squares by the target's step. In an adjusted network the
pulls of a target cancel. Their covariance says how much of each is left to see, since the photographs, the cameras and
the target itself follow what is wrong (Baarda, A testing procedure for use in geodetic networks, 1968, the reliability
matrix), and what a lens adds whose focal length and principal point differ from photograph to photograph.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.covariance import reduced_at
from app.photogrammetry.inverse_parts import TargetPart, inverse_parts
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.reduced_system import ReducedSystem
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.self_calibration import SCATTERED_COUNT, self_calibrate
from app.photogrammetry.sighting_products import SightingProducts, sighting_products
from app.photogrammetry.variance_components import shared_columns

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

# Of the target's own information: what photographs hide to the last digit is not read out of rounding.
RIDGE = 1e-6
SCALING_TARGETS = 300  # give the residuals' scale to 1 %
SCALINGS = 4  # after which the scale stands to a percent
LEAST_VARIANCE = 0.01  # of the stated ones: exact observations are synthetic


@dataclass(frozen=True)
class PullOptions:
    """Whose pulls are looked at.

    Attributes
    ----------
    fewest : int
        Sightings that a target must have.
    most : int
        Of a target with more of them, so many are taken, spread evenly over its photographs: what they say costs
        memory by the square of their number and time by its cube.
    """

    fewest: int = 4
    most: int = 24

    def taken(self, count: int) -> Index:
        """Which of a target's sightings are looked at."""
        return np.unique(np.linspace(0.0, count - 1.0, min(count, self.most)).round().astype(np.intp))


@dataclass(frozen=True)
class TargetPulls:
    """The n sightings of one target that are looked at.

    Attributes
    ----------
    target : int
    rows : ndarray of shape (n,)
        The sightings.
    pulls : ndarray of shape (n, 6)
        Weighted by their covariance.
    information : ndarray of shape (n, 6, n, 6)
        Covariance of the pulls when nothing is wrong, and at the same time their change by steps of the target in some
        photographs alone: information on such steps.
    squares : float
        All contradiction of the sightings, chi-square distributed by ``freedom`` when nothing is wrong.
    freedom : int
        Steps of these sightings against each other and the target's others.
    """

    target: int
    rows: Index
    pulls: Array
    information: Array
    squares: float
    freedom: int


@dataclass(frozen=True)
class PulledTargets:
    """All targets with sightings enough; the pulls of each are made when it is its turn: together they fill a memory.

    Attributes
    ----------
    problem : BundleProblem
    reduced : ReducedSystem
        Of the adjusted network.
    products : SightingProducts
    options : PullOptions
    variance : float
        Factor of the dots' variances by which the median target contradicts itself as chance has it.
    """

    problem: BundleProblem
    reduced: ReducedSystem
    products: SightingProducts
    options: PullOptions
    variance: float = 1.0

    def __len__(self) -> int:
        return int((self.problem.sightings.rays() >= self.options.fewest).sum())

    def __iter__(self) -> Iterator[TargetPulls]:
        return (self._known(part).weighted(self.variance) for part in self._parts())

    def scaled(self) -> PulledTargets:
        """The same with the variance that a sample of the targets tells."""
        step = max(1, len(self) // SCALING_TARGETS)
        return replace(self, variance=_variance([self._known(part) for part in islice(self._parts(), 0, None, step)]))

    def _parts(self) -> Iterator[TargetPart]:
        fronts = inverse_parts(self.reduced, self.problem.sightings)
        return (part for front in fronts for part in front.targets if len(part.rows) >= self.options.fewest)

    def _known(self, part: TargetPart) -> _Known:
        taken = self.options.taken(len(part.rows))
        pulls = _cancelled(self.products, part.rows)[taken]
        return _Known(part, taken, *_covariances(self, part, taken), pulls)


def target_pulls(
    problem: BundleProblem, network: Network, loss: RobustLoss, options: PullOptions = PullOptions()
) -> PulledTargets:
    """Pulls at all targets with sightings enough.

    Parameters
    ----------
    problem : BundleProblem
    network : Network
        Adjusted with that loss.
    loss : RobustLoss
    options : PullOptions

    Raises
    ------
    SurveyFailed
        Reason ``weak-network`` when the observations leave something undetermined.
    """
    reduced = reduced_at(problem, network, loss)
    scatters = [camera.scatter for camera in self_calibrate(problem, network, reduced.factor.border_inverse())]
    return PulledTargets(problem, reduced, sighting_products(problem, network, loss, scatters), options).scaled()


@dataclass(frozen=True)
class _Known:
    """A target's pulls (n, 6) and the two parts of their covariance: of the dots, as stated, and of the lens.

    The first is also how the pulls respond to steps of the target: what is redundant of the sightings' information.
    ``taken`` are the n sightings among all of the target.
    """

    part: TargetPart
    taken: Index
    of_dots: Array
    of_lens: Array
    pulls: Array

    @property
    def freedom(self) -> int:
        """Steps of these sightings against each other and the target's others."""
        return POSE_COUNT * min(len(self.taken), len(self.part.rows) - 1)

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
            self.part.rows[self.taken],
            pulls.reshape(self.pulls.shape),
            information.reshape(self.of_dots.shape),
            float(self.pulls.ravel() @ solved[:, 0]),
            self.freedom,
        )


def _variance(known: Sequence[_Known]) -> float:
    """Factor of the dots' variances by which the median target contradicts itself as chance has it."""
    variance = 1.0
    for _ in range(SCALINGS if known else 0):
        variance *= float(np.median([one.squares(variance) / one.freedom for one in known]))
        variance = max(variance, LEAST_VARIANCE)
    return variance


def _cancelled(products: SightingProducts, rows: Index) -> Array:
    """A target's pulls, shape (n, 6), without what the last step of the adjustment has left of their sum."""
    own, pulls = products.information[rows], products.pulls[rows]
    return np.asarray(pulls - own @ np.linalg.solve(own.sum(axis=0), pulls.sum(axis=0)))


def _covariances(pulled: PulledTargets, part: TargetPart, taken: Index) -> tuple[Array, Array]:
    """Of some of a target's pulls, shape (n, 6, n, 6) each: of the dots, by their stated sigmas, and of the lens."""
    own, count, every = pulled.products.information[part.rows], len(taken), np.arange(len(taken))
    followed = _followed(pulled, part, taken)
    stacked = own[taken].reshape(-1, POSE_COUNT)
    derivative = stacked @ part.gain + followed
    fitted = stacked @ pulled.reduced.target_inverse[part.target] @ stacked.T + derivative @ part.inverse @ derivative.T
    of_dots = -fitted.reshape(count, POSE_COUNT, count, POSE_COUNT)
    of_dots[every, :, every] += own[taken] * (1.0 + RIDGE)
    # The target follows what the lens does in all of its photographs.
    lens = pulled.products.lens[part.rows]
    step = np.linalg.solve(own.sum(axis=0), np.swapaxes(lens, 0, 1).reshape(POSE_COUNT, -1))
    of_lens = -(own[taken] @ step).reshape(count, POSE_COUNT, len(part.rows), SCATTERED_COUNT)
    of_lens[every, :, taken] += lens[taken]
    flat = of_lens.reshape(count * POSE_COUNT, -1)
    return of_dots, (flat @ flat.T).reshape(of_dots.shape)


def _followed(pulled: PulledTargets, part: TargetPart, taken: Index) -> Array:
    """Derivative of n of a target's m pulls by its photographs and the shared unknowns, shape (6 n, 6 m + f)."""
    problem, products, rows, count = pulled.problem, pulled.products, part.rows[taken], len(taken)
    photos = np.zeros((count, POSE_COUNT, len(part.rows), POSE_COUNT))
    photos[np.arange(count), :, taken] = products.information[rows] @ products.turned[rows]
    shared = np.zeros((count, POSE_COUNT, part.inverse.shape[0] - POSE_COUNT * len(part.rows)))
    cameras = problem.camera_of_photo[problem.sightings.photo[rows]]
    for camera in np.unique(cameras):
        columns, places = shared_columns(problem, int(camera), int(problem.prints.batch[part.target]))
        of_camera = np.flatnonzero(cameras == camera)
        shared[np.ix_(of_camera, np.arange(POSE_COUNT), places)] = products.by_columns[rows[of_camera]][..., columns]
    flat = POSE_COUNT * count
    return np.concatenate([photos.reshape(flat, -1), shared.reshape(flat, -1)], axis=1)
