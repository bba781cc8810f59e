"""Dot centres in pixels, with a covariance each, from fitted plates."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from app.vision.homography import PLATE_DOTS_U
from app.vision.inks import InkReading
from app.vision.kernels.places import locate_all
from app.vision.kernels.refinement import refine_all
from app.vision.kernels.scatter import scale_covariances
from app.vision.measurement import PlateFits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# JPEG's luma and chroma of blue, green, red (ITU-R BT.601): their noise is independent, that of the colours is not.
YCC_FROM_BGR = np.array([[0.114, 0.587, 0.299], [0.5, -0.3313, -0.1687], [-0.0813, -0.4187, 0.5]])


@dataclass(frozen=True)
class CentreOptions:
    """When a dot counts as measured.

    Attributes
    ----------
    sigma_max_u : float
        Greatest predicted standard deviation of a centre: a fifth of a radius; beyond, noise moved it.
    offset_max_u : float
        Farthest a dot may be found from where its plate expects it: half its radius; beyond, the linear model ends.
    border_u : float
        What must lie inside the photograph around a dot's centre: the dot itself.
    unseen_factor : float
        Variance over what the dots' misfit to their plates shows: compression moves neighbouring dots together, and
        that part a plate's homography absorbs (``benchmarks/accuracy.py`` prints the normalised errors it leads to).
    prior_redundancy : float
        Weight of the template fit's own noise estimate beside the misfits of the photograph's plates.
    rescale_max : float
        How many times larger or smaller its dots may make a plate: far more than a first look errs by.
    covariance_floor_px : float
        Errors that no noise estimate sees (interpolation, chroma siting): 0.01 px.
    covariance_floor_u : float
        The same of large plates, whose samples stand farther apart: 0.07 px at 16 px per u, where 0.1 is found.
    """

    sigma_max_u: float = 0.2
    offset_max_u: float = 0.5
    border_u: float = 1.0
    unseen_factor: float = 1.6
    prior_redundancy: float = 20.0
    rescale_max: float = 1.5
    covariance_floor_px: float = 0.01
    covariance_floor_u: float = 0.005


@dataclass(frozen=True)
class DotCentres:
    """Dots of P plates.

    Attributes
    ----------
    centres_px : ndarray of shape (P, 16, 2)
        Images of the dots' centres; the plate's prediction where not measured.
    covariances_u2 : ndarray of shape (P, 16, 2, 2)
        In plate coordinates.
    px_by_u : ndarray of shape (P, 16, 2, 2)
        Derivatives of pixels by plate coordinates at the dots.
    measured : ndarray of shape (P, 16), bool
    inside : ndarray of shape (P, 16), bool
        Whether the dot lies wholly inside the photograph.
    """

    centres_px: Array
    covariances_u2: Array
    px_by_u: Array
    measured: npt.NDArray[np.bool_]
    inside: npt.NDArray[np.bool_]

    def select(self, chosen: npt.NDArray[np.intp]) -> DotCentres:
        """The dots of some plates."""
        return DotCentres(*(getattr(self, part.name)[chosen] for part in fields(self)))


def locate_dots(
    fits: PlateFits, inks: InkReading, size_px: tuple[int, int], options: CentreOptions = CentreOptions()
) -> DotCentres:
    """Centres of all coloured dots from a template fit; ``size_px`` is the photograph's width and height.

    Notes
    -----
    A disc moved by d adds ``amplitude * derivative . d`` in every channel: d is the least-squares ratio over luma and
    chroma. It is found in the plate's own plane, so that a circle's image is compared with a circle and the offset
    between an ellipse's centre and the image of the circle's centre does not arise.
    """
    shape = fits.amplitudes.shape[:2]
    dots = DotCentres(
        centres_px=np.empty((*shape, 2)),
        covariances_u2=np.empty((*shape, 2, 2)),
        px_by_u=np.empty((*shape, 2, 2)),
        measured=inks.coloured,
        inside=np.empty(shape, dtype=np.bool_),
    )
    fitted = (fits.image_from_plate, fits.amplitudes, fits.slopes, fits.residual_rms, fits.offset_cofactors)
    bounds = (options.offset_max_u, options.sigma_max_u, options.border_u)
    written = (dots.centres_px, dots.covariances_u2, dots.px_by_u, dots.measured, dots.inside)
    locate_all(
        tuple(np.ascontiguousarray(part) for part in fitted), (PLATE_DOTS_U, YCC_FROM_BGR), size_px, bounds, written
    )
    return dots


def refine_homographies(fits: PlateFits, dots: DotCentres, options: CentreOptions = CentreOptions()) -> Array:
    """Homographies through the measured dots, weighted by their precision; the old ones where too few were."""
    before = np.ascontiguousarray(fits.image_from_plate)
    refined = np.empty(before.shape)
    located = (
        np.ascontiguousarray(dots.centres_px),
        np.ascontiguousarray(dots.covariances_u2),
        np.ascontiguousarray(dots.px_by_u),
        np.ascontiguousarray(dots.measured),
    )
    refine_all(PLATE_DOTS_U, before, located, options.rescale_max, refined)
    return refined


def calibrate_covariances(
    dots: DotCentres,
    image_from_plate: Array,
    which: tuple[Mask, Mask],
    options: CentreOptions,
    covariances_px2: Array,
) -> None:
    """Covariances of plates of one kind, scaled to how a photograph's dots scatter about them.

    Parameters
    ----------
    dots : DotCentres
    image_from_plate : ndarray of shape (P, 3, 3)
        Homographies through the measured dots.
    which : tuple of ndarray of shape (P,), bool
        The plates of this kind, and those of them that count; bent ones and false ones must not.
    options : CentreOptions
    covariances_px2 : ndarray of shape (P, 16, 2, 2), written for those plates
    """
    located = (
        np.ascontiguousarray(dots.centres_px),
        np.ascontiguousarray(dots.covariances_u2),
        np.ascontiguousarray(dots.px_by_u),
        np.ascontiguousarray(dots.measured),
    )
    bounds = (
        options.covariance_floor_u**2,
        options.covariance_floor_px**2,
        options.prior_redundancy,
        options.unseen_factor,
    )
    plates = (np.ascontiguousarray(image_from_plate), PLATE_DOTS_U)
    scale_covariances(plates, located, which, bounds, covariances_px2)
