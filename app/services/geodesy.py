"""Between the site frame and latitude and longitude: a local tangent plane on the WGS 84 ellipsoid."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.storage.records import GeoAnchor

Array = npt.NDArray[np.float64]

SEMI_MAJOR_M = 6_378_137.0  # WGS 84
FLATTENING = 1.0 / 298.257223563  # WGS 84
ECCENTRICITY_2 = FLATTENING * (2.0 - FLATTENING)


def geodetic(site_m: Array, anchor: GeoAnchor) -> Array:
    """Longitude (deg), latitude (deg) and height (m), shape (..., 3), of points of shape (..., 3) of the site frame.

    Notes
    -----
    East and north offsets over the radii of curvature at the anchor (prime vertical N, meridian M): within 100 m of
    the anchor and 80 degrees of latitude the neglected curvature is below a millimetre.
    """
    east_m, north_m, up_m = np.moveaxis(site_m @ enu_from_site(anchor).T, -1, 0)
    east_radius_m, north_radius_m = _radii_m(anchor)
    longitude_deg = anchor.longitude_deg + np.degrees(east_m / east_radius_m)
    latitude_deg = anchor.latitude_deg + np.degrees(north_m / north_radius_m)
    return np.stack([longitude_deg, latitude_deg, anchor.height_m + up_m], axis=-1)


def site_of_geodetic(geodetic_deg_m: Array, anchor: GeoAnchor) -> Array:
    """The inverse of ``geodetic``: points of the site frame, shape (..., 3), of longitude, latitude and height."""
    east_radius_m, north_radius_m = _radii_m(anchor)
    # The shorter way round, for a site beside the 180th meridian.
    turn_deg = np.remainder(geodetic_deg_m[..., 0] - anchor.longitude_deg + 180.0, 360.0) - 180.0
    east_m = np.radians(turn_deg) * east_radius_m
    north_m = np.radians(geodetic_deg_m[..., 1] - anchor.latitude_deg) * north_radius_m
    enu_m = np.stack([east_m, north_m, geodetic_deg_m[..., 2] - anchor.height_m], axis=-1)
    return enu_m @ enu_from_site(anchor)


def enu_from_site(anchor: GeoAnchor) -> Array:
    """Rotation from the site's axes to east, north and up, shape (3, 3)."""
    azimuth_rad = np.radians(anchor.azimuth_deg)
    cosine, sine = np.cos(azimuth_rad), np.sin(azimuth_rad)
    return np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _radii_m(anchor: GeoAnchor) -> tuple[float, float]:
    """What an arc of one radian takes to the east and to the north at the anchor."""
    latitude_rad = np.radians(anchor.latitude_deg)
    w2 = 1.0 - ECCENTRICITY_2 * np.sin(latitude_rad) ** 2
    prime_vertical_m = SEMI_MAJOR_M / np.sqrt(w2)
    meridian_m = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_2) / w2**1.5
    east_m = (prime_vertical_m + anchor.height_m) * np.cos(latitude_rad)
    return float(east_m), float(meridian_m + anchor.height_m)
