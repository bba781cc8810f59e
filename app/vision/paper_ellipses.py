"""The published method, step 1: ellipses of red dots.

Source: Sensors 2019, "Smartphone Indoor Positioning Dynamic Ground Truth Reference System Using Robust Visual Encoded
Targets"; equation numbers are the paper's.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

GRID_PX = 0.5  # Canny's edges lie on whole pixels


@dataclass(frozen=True)
class EllipseOptions:
    """What counts as the image of a red dot.

    Attributes
    ----------
    red_gain : float
        Of the custom channel ``gain * (R - max(G, B))``: 2 spreads the print's red, 164 above green and blue in full
        light, over the 8-bit range even at half of the light.
    smoothing_px : float
        Standard deviation of the Gaussian that Canny's method begins with and OpenCV's leaves out: one pixel, which
        dots of two pixels' radius still survive.
    canny_low, canny_high : float
        Hysteresis thresholds on the custom channel's gradient (Sobel, L1). 60 and 150 are steps of 15 and of 38 levels:
        a twentieth of the range, which noise seldom reaches once smoothed, and an eighth.
    red_min : float
        Least level of the custom channel in an ellipse's middle: the step that the upper threshold asks of an edge.
    axis_ratio_min : float
        Smallest minor over major axis: a dot seen at 73 degrees.
    area_min_px2 : float
        The paper's 10 px.
    area_max_share : float
        Largest share of the picture: dots of a plate that just fills the frame cover 1/50 each.
    contour_points_min : int
        A conic takes five points; fewer than eight would follow the noise.
    fit_error_max : float
        Root mean square distance of the contour from the ellipse, over the minor semi-axis, plus half a pixel of the
        grid on which Canny's edges lie.
    """

    red_gain: float = 2.0
    smoothing_px: float = 1.0
    canny_low: float = 60.0
    canny_high: float = 150.0
    red_min: float = 38.0
    axis_ratio_min: float = 0.3
    area_min_px2: float = 10.0
    area_max_share: float = 0.02
    contour_points_min: int = 8
    fit_error_max: float = 0.15


@dataclass(frozen=True)
class Ellipse:
    """An ellipse in the picture.

    Attributes
    ----------
    centre_px : ndarray of shape (2,)
    semi_axes_px : tuple of float
        Major, then minor.
    shape_px2 : ndarray of shape (2, 2)
        ``p.T @ inv(shape) @ p = 1`` on the ellipse, about the centre.
    """

    centre_px: Array
    semi_axes_px: tuple[float, float]
    shape_px2: Array

    @property
    def area_px2(self) -> float:
        """Enclosed area."""
        return float(np.pi * self.semi_axes_px[0] * self.semi_axes_px[1])

    def reach_px(self, direction: Array) -> float:
        """How far the ellipse extends from its centre along a unit vector (its support)."""
        return float(np.sqrt(direction @ self.shape_px2 @ direction))


def red_channel(bgr: Pixels, gain: float) -> Pixels:
    """The custom channel in which red is deep and all else is black, shape (H, W), uint8."""
    blue, green, red = cv2.split(bgr)
    excess = cv2.subtract(red, cv2.max(green, blue))  # saturates at 0
    return np.asarray(cv2.convertScaleAbs(excess, alpha=gain), dtype=np.uint8)


def find_ellipses(bgr: Pixels, options: EllipseOptions) -> list[Ellipse]:
    """Ellipses of the red dots' edges that are large enough and not too flat."""
    red = red_channel(bgr, options.red_gain)
    smooth = cv2.GaussianBlur(red, (0, 0), options.smoothing_px)
    edges = cv2.Canny(smooth, options.canny_low, options.canny_high)
    # A closed edge has an outer and an inner contour: the outer one of each edge is taken.
    contours, hierarchy = cv2.findContours(edges, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    area_max_px2 = options.area_max_share * bgr.shape[0] * bgr.shape[1]
    ellipses = []
    for contour, (_, _, _, parent) in zip(contours, () if hierarchy is None else hierarchy[0], strict=True):
        if parent >= 0 or len(contour) < options.contour_points_min:
            continue
        points_px = contour[:, 0].astype(np.float64)
        ellipse = fit_ellipse(points_px)
        if ellipse is None or not options.area_min_px2 <= ellipse.area_px2 <= area_max_px2:
            continue
        major_px, minor_px = ellipse.semi_axes_px
        if minor_px < options.axis_ratio_min * major_px or not _fits(ellipse, points_px, options.fit_error_max):
            continue
        if _level_at(red, ellipse.centre_px) >= options.red_min:
            ellipses.append(ellipse)
    return ellipses


def fit_ellipse(points_px: Array) -> Ellipse | None:
    """Least-squares conic through points of shape (N, 2), N >= 5; None when it is no ellipse.

    Notes
    -----
    Equation 1: ``x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F = 0``, solved for B ... F about the points' mean and in
    units of their spread, which changes nothing but the rounding. Equation 2 gives the centre; its y0 is printed with
    C E where B D - E solves equation 1.
    """
    origin_px = points_px.mean(axis=0)
    spread_px = float(points_px.std())
    if spread_px == 0.0:
        return None
    x, y = ((points_px - origin_px) / spread_px).T
    design = np.column_stack([2 * x * y, y * y, 2 * x, 2 * y, np.ones_like(x)])
    (b, c, d, e, f), _, rank, _ = np.linalg.lstsq(design, -x * x, rcond=None)  # eq. 1
    determinant = c - b * b
    if rank < design.shape[1] or determinant <= 0:
        return None
    x0, y0 = (b * e - c * d) / determinant, (b * d - e) / determinant  # eq. 2
    level = -(f + d * x0 + e * y0)  # of the quadratic form on the ellipse, about its centre
    if level <= 0:
        return None
    shape = level * np.linalg.inv(np.array([[1.0, b], [b, c]])) * spread_px**2
    minor2, major2 = np.linalg.eigvalsh(shape)
    return Ellipse(origin_px + spread_px * np.array([x0, y0]), (float(np.sqrt(major2)), float(np.sqrt(minor2))), shape)


def _fits(ellipse: Ellipse, points_px: Array, error_max: float) -> bool:
    """Whether the contour follows its ellipse: other red things give conics too."""
    offsets_px = points_px - ellipse.centre_px
    radius = np.sqrt(np.einsum("ni,ij,nj->n", offsets_px, np.linalg.inv(ellipse.shape_px2), offsets_px))
    minor_px = ellipse.semi_axes_px[1]
    error_px = float(np.sqrt(np.mean((radius - 1.0) ** 2))) * minor_px
    return error_px <= error_max * minor_px + GRID_PX


def _level_at(channel: Pixels, point_px: Array) -> float:
    """Value of the nearest pixel; 0 outside of the picture."""
    column, row = np.rint(point_px).astype(int)
    inside = 0 <= row < channel.shape[0] and 0 <= column < channel.shape[1]
    return float(channel[row, column]) if inside else 0.0
