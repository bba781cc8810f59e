"""From the site frame to latitude and longitude: a local tangent plane on the WGS 84 ellipsoid."""

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
    azimuth, latitude = np.radians(anchor.azimuth_deg), np.radians(anchor.latitude_deg)
    x, y, z = site_m[..., 0], site_m[..., 1], site_m[..., 2]
    east_m = x * np.cos(azimuth) + y * np.sin(azimuth)
    north_m = -x * np.sin(azimuth) + y * np.cos(azimuth)
    w2 = 1.0 - ECCENTRICITY_2 * np.sin(latitude) ** 2
    prime_vertical_m = SEMI_MAJOR_M / np.sqrt(w2)
    meridian_m = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_2) / w2**1.5
    longitude_deg = anchor.longitude_deg + np.degrees(
        east_m / ((prime_vertical_m + anchor.height_m) * np.cos(latitude))
    )
    latitude_deg = anchor.latitude_deg + np.degrees(north_m / (meridian_m + anchor.height_m))
    return np.stack([longitude_deg, latitude_deg, anchor.height_m + z], axis=-1)
