"""Sightings: every target seen in every photograph, as arrays, so that nothing loops over dots.

One sighting is one target in one photograph: sixteen dots with the square root of their information.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.observations import Detection, TargetObservation
from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.plate_correlation import PlateModes, plate_basis
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Sightings:
    """M sightings among P photographs and T targets, ordered by photograph.

    Attributes
    ----------
    photo, target : ndarray of shape (M,)
        Which photograph sees which target; ``photo`` ascends.
    dots_px : ndarray of shape (M, 16, 2)
        Measured images of the dots' centres.
    whitening_per_px : ndarray of shape (M, 16, 2, 2)
        Square root of each dot's information, lower triangle: ``whitening @ residual_px`` has unit covariance. Zero
        where a dot was not measured.
    photo_count, target_count : int
        P and T.
    modes : PlateModes or None
        What the dots of a sighting have in common; None while they are taken as independent.
    """

    photo: Index
    target: Index
    dots_px: Array
    whitening_per_px: Array
    photo_count: int
    target_count: int
    modes: PlateModes | None = None

    def __post_init__(self) -> None:
        if (np.diff(self.photo) < 0).any():
            raise ValueError("sightings are ordered by photograph")
        if len({len(self.photo), len(self.target), len(self.dots_px), len(self.whitening_per_px)}) != 1:
            raise ValueError("sightings need a photograph, a target, dots and weights each")

    def __len__(self) -> int:
        return len(self.photo)

    @property
    def measured(self) -> Mask:
        """Which dots carry information, shape (M, 16)."""
        return self.whitening_per_px[..., 0, 0] > 0

    @cached_property
    def typical_weight_per_px(self) -> float:
        """Median of the measured dots' weights, the reciprocal of a standard deviation."""
        weights = self.whitening_per_px[..., 0, 0]
        return float(np.median(weights[weights > 0]))

    def select(self, chosen: Mask | Index | slice) -> Sightings:
        """The chosen sightings (by mask, by ascending rows, or a run) of the same photographs and targets."""
        return replace(
            self,
            photo=self.photo[chosen],
            target=self.target[chosen],
            dots_px=self.dots_px[chosen],
            whitening_per_px=self.whitening_per_px[chosen],
            modes=None if self.modes is None else self.modes.select(chosen),
        )

    def among(self, photos: Index, targets: Index) -> Sightings:
        """The sightings of some photographs (ascending) and targets, both renumbered by their place in the lists."""
        new_photo, new_target = np.full(self.photo_count, -1), np.full(self.target_count, -1)
        new_photo[photos], new_target[targets] = np.arange(len(photos)), np.arange(len(targets))
        kept = self.select((new_photo[self.photo] >= 0) & (new_target[self.target] >= 0))
        return replace(
            kept,
            photo=new_photo[kept.photo],
            target=new_target[kept.target],
            photo_count=len(photos),
            target_count=len(targets),
        )

    def reweighted(self, sigma0: float) -> Sightings:
        """The same sightings with all standard deviations multiplied by ``sigma0``."""
        return replace(self, whitening_per_px=self.whitening_per_px / sigma0)

    def correlated(self, sigmas: PlateSigmas) -> Sightings:
        """The same sightings with errors that the dots of a plate share."""
        return replace(self, modes=PlateModes(plate_basis(self.whitening_per_px), sigmas))

    def whiten(self, rows_px: Array) -> Array:
        """Rows of the sightings' equations, shape (M, 16, 2, k), px, as rows of unit covariance."""
        whitened = self.whitening_per_px @ rows_px
        return whitened if self.modes is None else self.modes.decorrelate(whitened)

    def in_pixels(self) -> Sightings:
        """The same sightings with every measured dot weighted by one, so that whitened residuals are in px."""
        return replace(self, whitening_per_px=self.measured[..., None, None] * np.eye(2), modes=None)

    def rays(self) -> Index:
        """How many photographs see each target, shape (T,)."""
        return np.bincount(self.target, minlength=self.target_count)

    def targets_per_photo(self) -> Index:
        """How many targets each photograph sees, shape (P,)."""
        return np.bincount(self.photo, minlength=self.photo_count)


def gather_sightings(detections: Sequence[Detection]) -> tuple[Sightings, Index]:
    """Sightings of a sequence of photographs, and the code of each target, shape (T,), ascending."""
    found = [(photo, seen) for photo, detection in enumerate(detections) for seen in detection.targets]
    codes, target = np.unique(np.array([seen.code for _, seen in found], dtype=np.intp), return_inverse=True)
    sightings = Sightings(
        photo=np.array([photo for photo, _ in found], dtype=np.intp),
        target=target.astype(np.intp),
        dots_px=np.array([seen.centres_px for _, seen in found]).reshape(-1, DOT_COUNT, 2),
        whitening_per_px=np.array([whitening_of(seen) for _, seen in found]).reshape(-1, DOT_COUNT, 2, 2),
        photo_count=len(detections),
        target_count=len(codes),
    )
    return sightings, codes


def whitening_of(seen: TargetObservation) -> Array:
    """Inverse Cholesky factors of the dots' covariances, shape (16, 2, 2), zero where not measured."""
    whitening = np.zeros((DOT_COUNT, 2, 2))
    whitening[seen.measured] = np.linalg.inv(np.linalg.cholesky(seen.covariances_px2[seen.measured]))
    return whitening
