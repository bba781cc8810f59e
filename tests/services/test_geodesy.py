from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.services.geodesy import ECCENTRICITY_2, SEMI_MAJOR_M, geodetic
from app.storage.records import GeoAnchor

REACH_M = 100.0
# What the tangent plane neglects: d^2 / 2R of height, and d^2 tan(latitude) / R of north.
NEGLECTED_M = 1.1 * REACH_M**2 / 6.3e6 * (1 + np.tan(np.radians(80)))

anchors = st.builds(GeoAnchor, st.floats(-80, 80), st.floats(-180, 180), st.floats(-100, 5000), st.floats(-180, 180))
offsets_m = st.lists(st.floats(-REACH_M / 2, REACH_M / 2), min_size=3, max_size=3).map(np.array)


def earth_centred_m(longitude_deg: float, latitude_deg: float, height_m: float) -> np.ndarray:
    """The textbook's closed form."""
    longitude, latitude = np.radians([longitude_deg, latitude_deg])
    normal_m = SEMI_MAJOR_M / np.sqrt(1 - ECCENTRICITY_2 * np.sin(latitude) ** 2)
    across_m = (normal_m + height_m) * np.cos(latitude)
    up_m = (normal_m * (1 - ECCENTRICITY_2) + height_m) * np.sin(latitude)
    return np.array([across_m * np.cos(longitude), across_m * np.sin(longitude), up_m])


def east_north_up(anchor: GeoAnchor) -> np.ndarray:
    longitude, latitude = np.radians([anchor.longitude_deg, anchor.latitude_deg])
    east = [-np.sin(longitude), np.cos(longitude), 0.0]
    up = [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)]
    return np.array([east, np.cross(up, east), up])


@given(anchors, offsets_m)
def test_a_point_stands_where_the_ellipsoid_says(anchor: GeoAnchor, site_m: np.ndarray) -> None:
    origin_m = earth_centred_m(anchor.longitude_deg, anchor.latitude_deg, anchor.height_m)
    point_m = earth_centred_m(*geodetic(site_m, anchor))
    found_m = east_north_up(anchor) @ (point_m - origin_m)
    azimuth = np.radians(anchor.azimuth_deg)  # of the site's Y axis, clockwise from north
    y_axis, x_axis = np.array([np.sin(azimuth), np.cos(azimuth)]), np.array([np.cos(azimuth), -np.sin(azimuth)])
    expected_m = np.append(site_m[0] * x_axis + site_m[1] * y_axis, site_m[2])
    np.testing.assert_allclose(found_m, expected_m, atol=NEGLECTED_M)


def test_the_origin_stands_at_the_anchor() -> None:
    anchor = GeoAnchor(48.15, 11.57, 515.0, 30.0)
    np.testing.assert_array_equal(geodetic(np.zeros(3), anchor), [11.57, 48.15, 515.0])
