"""Whether a target stands elsewhere than the map says, by many snapshots of it: a sequential test.

The newest 4, 8, 16, ... sightings are each asked for the one displacement that explains most of them. It counts when
chance would give it less often than a stated probability, and still does without any one of the places from which the
target was seen: neither a misread code nor a bad snapshot, however often repeated from there, speaks alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

FREEDOM = 3  # coordinates of a displacement


@dataclass(frozen=True)
class DisplacementOptions:
    """When a displacement counts.

    Attributes
    ----------
    false_alarm_probability : float
        Of one test of one target. A site of 100 targets that is tested after each of 10,000 snapshots at ten lengths
        raises one false alarm in a thousand such histories, were the tests independent and the noise normal; what
        realistic errors give is measured by ``benchmarks.alerts``.
    fewest_snapshots, fewest_places : int
        Sightings, and places from which they were made, before anything is said.
    fewest_supporters : float
        Share of the sightings (places weighing alike) that must fit the displacement better than none.
    outlier_probability : float
        A sighting that fits the displacement worse than this loses weight.
    rounds : int
        Of reweighting; it settles in three or four.
    starts : int
        Newest sightings that the search starts from: one of them is sound unless all are wrong.
    """

    false_alarm_probability: float = 1e-10
    fewest_snapshots: int = 4
    fewest_places: int = 3
    fewest_supporters: float = 2.0 / 3.0
    outlier_probability: float = 0.01
    rounds: int = 5
    starts: int = 16

    @property
    def limit(self) -> float:
        """Chi-square that chance exceeds with the stated probability."""
        return float(chdtri(FREEDOM, self.false_alarm_probability))

    @property
    def outlier_chi2(self) -> float:
        """Chi-square from which a sighting loses weight."""
        return float(chdtri(FREEDOM, self.outlier_probability))


@dataclass(frozen=True)
class Sightings:
    """Sightings of one target in the order of time.

    Attributes
    ----------
    displacements_m : ndarray of shape (N, 3)
        Against the other targets of the same snapshot.
    information : ndarray of shape (N, 3, 3)
        Inverse covariance of each.
    places : ndarray of shape (N,), int
        From which place; what is seen from one place errs together.
    """

    displacements_m: Array
    information: Array
    places: Index

    def __len__(self) -> int:
        return len(self.places)

    def newest(self, count: int) -> Sightings:
        """The last so many."""
        return Sightings(self.displacements_m[-count:], self.information[-count:], self.places[-count:])

    def chi2(self, displacement_m: Array) -> Array:
        """How badly each sighting fits a displacement, shape (N,)."""
        off_m = self.displacements_m - displacement_m
        return np.asarray(np.einsum("ni,nij,nj->n", off_m, self.information, off_m))

    def shares(self) -> Array:
        """Weight of each sighting: those of one place together count as one."""
        _, inverse, counts = np.unique(self.places, return_inverse=True, return_counts=True)
        return np.asarray(1.0 / counts[inverse])


@dataclass(frozen=True)
class Displacement:
    """Where a target stands less where the map has it.

    Attributes
    ----------
    value_m : ndarray of shape (3,)
    covariance_m2 : ndarray of shape (3, 3)
    excess : float
        Chi-square over its limit, the strongest place left out; above 1 the target stands elsewhere.
    first : int
        Number (from 0) of the sighting since which it does.
    snapshots, places : int
        Since then.
    """

    value_m: Array
    covariance_m2: Array
    excess: float
    first: int
    snapshots: int
    places: int


@dataclass(frozen=True)
class _Mean:
    """A weighted mean: with its weights, by what the scatter widens its covariance, and that covariance.

    What all sightings share is not in it.
    """

    value_m: Array
    weights: Array
    factor: float
    covariance_m2: Array

    def chi2(self, shared_m2: Array) -> float:
        """How badly the mean fits no displacement."""
        return float(self.value_m @ np.linalg.solve(self.covariance_m2 + shared_m2, self.value_m))


def find_displacement(sightings: Sightings, shared_m2: Array, options: DisplacementOptions) -> Displacement | None:
    """The displacement that counts most, None when none of the lengths shows one.

    Parameters
    ----------
    sightings : Sightings
    shared_m2 : ndarray of shape (3, 3)
        Covariance of what errs alike in all sightings: the target's own uncertainty in the map.
    options : DisplacementOptions
    """
    tested = (_test(sightings.newest(count), shared_m2, options) for count in _lengths(len(sightings), options))
    found = max((item for item in tested if item is not None), key=lambda item: item.excess, default=None)
    return None if found is None else _since(sightings, found, shared_m2, options)


def mean_chi2(sightings: Sightings, shared_m2: Array, options: DisplacementOptions) -> float:
    """Chi-square of the mean of all sightings, which has three degrees of freedom."""
    return _robust_mean(sightings, options).chi2(shared_m2)


def _lengths(count: int, options: DisplacementOptions) -> list[int]:
    """Doubled from the fewest to all."""
    lengths, length = [], options.fewest_snapshots
    while length < count:
        lengths.append(length)
        length *= 2
    return [*lengths, count] if count >= options.fewest_snapshots else []


def _test(sightings: Sightings, shared_m2: Array, options: DisplacementOptions) -> Displacement | None:
    """The displacement of all these sightings when it counts."""
    places = np.unique(sightings.places)
    if len(places) < options.fewest_places:
        return None
    mean = _robust_mean(sightings, options)
    shares = sightings.shares()
    supporting = sightings.chi2(mean.value_m) < sightings.chi2(np.zeros(FREEDOM))
    if shares[supporting].sum() < options.fewest_supporters * shares.sum():
        return None
    least = min(_without(sightings, mean, place).chi2(shared_m2) for place in places)
    if least <= options.limit:
        return None
    covariance_m2 = mean.covariance_m2 + shared_m2
    return Displacement(mean.value_m, covariance_m2, least / options.limit, 0, len(sightings), len(places))


def _robust_mean(sightings: Sightings, options: DisplacementOptions) -> _Mean:
    """The mean that most sightings agree on, from the best of some of them as start."""
    shares, starts = sightings.shares(), sightings.displacements_m[-options.starts :]
    losses = [float(shares @ np.minimum(sightings.chi2(start), options.outlier_chi2)) for start in starts]
    mean = _Mean(starts[int(np.argmin(losses))], shares, 1.0, np.zeros((FREEDOM, FREEDOM)))
    for _ in range(options.rounds):
        chi2 = sightings.chi2(mean.value_m)
        mean = _mean_of(sightings, shares * options.outlier_chi2 / np.maximum(chi2, options.outlier_chi2), 1.0)
    freedom = FREEDOM * max(len(np.unique(sightings.places)) - 1, 1)
    factor = max(1.0, float(mean.weights @ sightings.chi2(mean.value_m)) / freedom)
    return replace(mean, factor=factor, covariance_m2=factor * mean.covariance_m2)


def _without(sightings: Sightings, mean: _Mean, place: int) -> _Mean:
    """The mean without the sightings from one place, with the weights that were found for all."""
    return _mean_of(sightings, np.where(sightings.places == place, 0.0, mean.weights), mean.factor)


def _mean_of(sightings: Sightings, weights: Array, factor: float) -> _Mean:
    normal = np.einsum("n,nij->ij", weights, sightings.information)
    right = np.einsum("n,nij,nj->i", weights, sightings.information, sightings.displacements_m)
    covariance_m2 = np.linalg.inv(normal)
    return _Mean(covariance_m2 @ right, weights, factor, factor * covariance_m2)


def _since(
    sightings: Sightings, found: Displacement, shared_m2: Array, options: DisplacementOptions
) -> Displacement | None:
    """The same displacement, by all sightings since the one from which on they speak for it most; None when too few do.

    The greatest sum, from some sighting to the last, of by how much each fits it better than none: Page's CUSUM
    (Continuous Inspection Schemes, 1954), each summand bounded so that no sighting outweighs many.
    """
    gains = sightings.chi2(np.zeros(FREEDOM)) - sightings.chi2(found.value_m)
    gains = np.clip(gains, -options.outlier_chi2, options.outlier_chi2)
    count = int(np.argmax(np.cumsum(gains[::-1]))) + 1
    if count < options.fewest_snapshots:
        return None
    refined = _test(sightings.newest(count), shared_m2, options)
    return None if refined is None else replace(refined, first=len(sightings) - count)
