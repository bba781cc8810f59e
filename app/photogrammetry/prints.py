"""In which batches the plates of a survey were printed, and what is known of each batch in advance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

PRINT_SIGMA = 0.002  # of a printed length, relative, when nobody measured it (pipeline.md, section 3)
PRINT_COUNT = 2  # unknowns of a batch's print scale: across and along the paper, the plates' x and y


@dataclass(frozen=True)
class Prints:
    """B print batches of T targets; the targets of a batch share one print scale.

    Attributes
    ----------
    batch, listed : ndarray of shape (T,)
        Of each target: the one that it shows to be of, and the one that it was listed in.
    expected : ndarray of shape (B, 2)
        Printed over nominal length along the plates' x and y.
    sigma : ndarray of shape (B,)
        Standard deviation of each of the two.
    held : ndarray of shape (B,), bool
        Batches whose scale is no unknown.
    found : ndarray of shape (B,), bool
        Batches that nobody listed: the photographs show that their plates are not of the others' size.
    """

    batch: Index
    listed: Index
    expected: Array
    sigma: Array
    held: Mask
    found: Mask

    def __post_init__(self) -> None:
        shapes = {len(self.sigma), len(self.held), len(self.found)}
        if self.expected.shape != (len(self.sigma), PRINT_COUNT) or len(shapes) > 1:
            raise ValueError("each print batch needs two expected scales and a sigma")
        if not (self.sigma > 0).all() or not (self.expected > 0).all():
            raise ValueError("print scales and their sigmas are positive")

    @property
    def count(self) -> int:
        """Batches."""
        return len(self.sigma)

    @property
    def free(self) -> Mask:
        """Which of the 2 B scales are unknowns, batch by batch."""
        return np.repeat(~self.held, PRINT_COUNT)

    @property
    def of_targets(self) -> Array:
        """Expected scale of each target, shape (T, 2)."""
        return self.expected[self.batch]

    @property
    def sizes(self) -> Index:
        """Targets of each batch, shape (B,)."""
        return np.bincount(self.batch, minlength=self.count)

    def among(self, targets: Index) -> Prints:
        """Of some of the targets, renumbered by their place in the list; repeated ones count as often."""
        return replace(self, batch=self.batch[targets], listed=self.listed[targets])

    def off(self, print_scale: Array) -> Array:
        """Present minus expected scale of each batch, shape (B, 2); zero where no target shows it."""
        present, first = np.unique(self.batch, return_index=True)
        off = np.zeros(self.expected.shape)
        off[present] = print_scale[first] - self.expected[present]
        return off

    def freed(self) -> Prints:
        """With every scale an unknown."""
        return replace(self, held=np.zeros(self.count, dtype=np.bool_))

    def doubted(self, sigma: float) -> Prints:
        """With scales that are known no better than this in advance."""
        return replace(self, sigma=np.maximum(self.sigma, sigma))

    def held_at(self, batch: int) -> Prints:
        """With one batch's scale held, as a free network takes it, and the others unknown."""
        return replace(self, held=np.arange(self.count) == batch)

    def best_known(self, fewest: int) -> int:
        """The batch of least sigma among those of enough targets, the largest of equals; the largest where none has."""
        sizes = self.sizes
        enough = sizes >= min(fewest, int(sizes.max()))
        return int(np.lexsort([-sizes, np.where(enough, self.sigma, np.inf)])[0])


def one_batch(targets: int, sigma: float, held: bool = False) -> Prints:
    """All targets of one batch, printed at nominal size as far as is known."""
    batch, expected = np.zeros(targets, dtype=np.intp), np.ones((1, PRINT_COUNT))
    return Prints(batch, batch, expected, np.array([sigma]), held=np.array([held]), found=np.array([False]))
