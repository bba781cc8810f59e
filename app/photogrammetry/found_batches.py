"""Find the print batches that nobody listed: plates whose size differs from their neighbours' by one common factor.

A plate of another size stands at another depth in each photograph, which the other targets contradict; so the network
tells each plate's own print scale (``plate_faults``). Scales that several plates share are no fault of single plates
but another printer, another driver or another module, and the map takes those plates as they are.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.plate_faults import PlateFits
from app.photogrammetry.prints import PRINT_COUNT, Prints
from app.photogrammetry.two_sizes import TwoSizesOptions, two_sizes

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

UNKNOWN_SIGMA = 0.2  # of the scale of a batch that nobody measured and that is not like the rest


@dataclass(frozen=True)
class BatchOptions:
    """When plates make a print batch of their own.

    Attributes
    ----------
    scatter : float
        Of the scales within a batch, relative: paper takes up moisture and stretches by a tenth of a percent.
    stranger_sigmas : float
        A plate further than this from its batch is not of it.
    member_sigmas : float
        Plates nearer than this to a common scale may share it.
    least_apart : float
        Batches that differ by less, relative, are one: one and a half of what a printed length is trusted to.
    fewest : int
        Plates of a batch: one that is of another size is taken for deformed, and two may be by chance.
    fewest_mixed : int
        Plates among which two sizes are sought that no single plate shows.
    two_sizes : TwoSizesOptions
    most_centres : int
        Strangers, taken evenly, that are tried as the middle of a batch.
    most_batches : int
        That are found at once.
    early_apart : float
        While the network grows a plate further than this from its batch, relative, is given its own scale: less
        hardly bends the few photographs that stand.
    most_off : float
        And if it is not further than this from it: more is no print but a false code.
    """

    scatter: float = 0.001
    stranger_sigmas: float = 5.0
    member_sigmas: float = 3.5
    least_apart: float = 0.003
    fewest: int = 3
    fewest_mixed: int = 20
    two_sizes: TwoSizesOptions = field(default_factory=TwoSizesOptions)
    most_centres: int = 300
    most_batches: int = 5
    early_apart: float = 0.01
    most_off: float = 0.35


@dataclass(frozen=True)
class PlateScales:
    """Print scales of T plates by themselves, shape (T, 2), and covariances without and with the scatter of prints."""

    values: Array
    covariances: Array
    information: Array  # inverse, with the scatter

    @classmethod
    def of(cls, fits: PlateFits, print_scale: Array, sigma0: float, options: BatchOptions) -> PlateScales:
        """From faults fitted at a network with residuals ``sigma0`` times the stated ones."""
        covariances = fits.stretch_covariance * sigma0**2
        scattered = covariances + options.scatter**2 * np.eye(PRINT_COUNT)
        return cls(print_scale + fits.stretch, covariances, np.asarray(np.linalg.inv(scattered), dtype=np.float64))

    def squared_off(self, centre: Array) -> Array:
        """Squared distances from a scale (2,), or from one of each plate (T, 2), in variances, shape (T,)."""
        off = self.values - centre
        return np.einsum("ti,tij,tj->t", off, self.information, off)

    def mean(self, chosen: Mask) -> Array:
        """Weighted mean scale of some plates, shape (2,)."""
        information = self.information[chosen]
        right = (information @ self.values[chosen][..., None]).sum(axis=0)
        return np.asarray(np.linalg.solve(information.sum(axis=0), right)[:, 0])


def regrouped(prints: Prints, print_scale: Array, scales: PlateScales, options: BatchOptions) -> tuple[Prints, Array]:
    """The batches with those that are found among their strangers, and the scale of each plate, shape (T, 2)."""
    centres = prints.expected + prints.off(_batch_medians(prints, print_scale))
    own = scales.squared_off(centres[prints.batch])
    strange = (own > options.stranger_sigmas**2) & (
        np.abs(scales.values - centres[prints.batch]).max(axis=-1) > options.least_apart
    )
    found = _common_scales(scales, strange, centres, options)
    if not found:
        found = _hidden_scales(prints, scales, centres, options)
    if found:
        prints, centres = _with_found(prints, np.array(found)), np.concatenate([centres, found])
    return _joined(prints, centres, scales, options)


def own_sizes(prints: Prints, print_scale: Array, scales: PlateScales, options: BatchOptions) -> Array:
    """The scale of each plate, shape (T, 2), in a network that still grows: its own where it is not its batch's."""
    centres = (prints.expected + prints.off(_batch_medians(prints, print_scale)))[prints.batch]
    off = np.abs(scales.values - centres).max(axis=-1)
    strange = scales.squared_off(centres) > options.stranger_sigmas**2
    strange &= (off > options.early_apart) & (off < options.most_off)
    return np.where(strange[:, None], scales.values, centres)


def _batch_medians(prints: Prints, print_scale: Array) -> Array:
    """Each plate's scale replaced by the median of its batch: single ones may have been given their own."""
    medians = print_scale.copy()
    for batch in np.unique(prints.batch):
        members = prints.batch == batch
        medians[members] = np.median(print_scale[members], axis=0)
    return medians


def _common_scales(scales: PlateScales, strange: Mask, known: Array, options: BatchOptions) -> list[Array]:
    """Scales that enough of the strangers share, those of most plates first."""
    found: list[Array] = []
    for _ in range(options.most_batches):
        places = np.flatnonzero(strange)
        tried = places[:: max(1, len(places) // options.most_centres)]
        support = [(strange & (scales.squared_off(scales.values[one]) < _reach(options))).sum() for one in tried]
        if not support or max(support) < options.fewest:
            break
        centre = scales.values[tried[int(np.argmax(support))]]
        members = strange & (scales.squared_off(centre) < _reach(options))
        centre = scales.mean(members)
        members |= strange & (scales.squared_off(centre) < _reach(options))
        strange = strange & ~members
        if all(np.abs(centre - other).max() > options.least_apart for other in (*known, *found)):
            found.append(scales.mean(members))
    return found


def _hidden_scales(prints: Prints, scales: PlateScales, centres: Array, options: BatchOptions) -> list[Array]:
    """The second scale of a batch whose plates are of two, though no single one is certain."""
    for batch in np.flatnonzero(prints.sizes >= options.fewest_mixed):
        plates = np.flatnonzero(prints.batch == batch)
        sizes = two_sizes(scales.values[plates], scales.covariances[plates], options.two_sizes)
        if sizes is None or sizes.second.sum() < options.fewest:
            continue
        # Of the two the one that is farther from what the batch was taken for is new.
        far = sizes.centres[int(np.abs(sizes.centres - centres[batch]).max(axis=-1).argmax())]
        if np.abs(np.diff(sizes.centres, axis=0)).max() > options.least_apart and all(
            np.abs(far - other).max() > options.least_apart / 2.0 for other in centres
        ):
            return [far]
    return []


def _reach(options: BatchOptions) -> float:
    return options.member_sigmas**2


def _with_found(prints: Prints, centres: Array) -> Prints:
    new = len(centres)
    return replace(
        prints,
        expected=np.concatenate([prints.expected, centres]),
        sigma=np.append(prints.sigma, np.full(new, UNKNOWN_SIGMA)),
        held=np.append(prints.held, np.zeros(new, dtype=np.bool_)),
        found=np.append(prints.found, np.ones(new, dtype=np.bool_)),
    )


def _joined(prints: Prints, centres: Array, scales: PlateScales, options: BatchOptions) -> tuple[Prints, Array]:
    """Every plate in the batch that it was listed in, or in a found one that it is nearer to."""
    batch = prints.listed.copy()
    least = scales.squared_off(centres[batch])
    for number in np.flatnonzero(prints.found):
        squared = scales.squared_off(centres[number])
        nearer = (squared < least) & (squared < _reach(options))
        batch[nearer], least[nearer] = number, squared[nearer]
    return replace(prints, batch=batch), centres[batch]
