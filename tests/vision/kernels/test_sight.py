import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.targets.layout import PLATE_SIDE_U
from app.vision.covered_sides import LINES_U
from app.vision.kernels.sides import SIDES, from_side
from app.vision.kernels.sight import mark_seen, to_side

HALF_U = PLATE_SIDE_U / 2
places_u = st.floats(-HALF_U, HALF_U)


@given(side=st.integers(0, SIDES - 1), across_u=places_u, inwards_u=st.floats(0.0, PLATE_SIDE_U))
def test_points_from_a_side_and_back(side: int, across_u: float, inwards_u: float) -> None:
    np.testing.assert_allclose(to_side(side, *from_side(side, across_u, inwards_u)), (across_u, inwards_u), atol=1e-12)


@given(
    side=st.integers(0, SIDES - 1),
    depths=st.lists(st.floats(0.1, 5.0), min_size=5, max_size=5),
    across_u=places_u,
    off_u=st.floats(-1.0, 1.0).filter(lambda off_u: abs(off_u) > 1e-6),
)
def test_a_point_is_in_sight_beyond_the_depth_of_its_side(
    side: int, depths: list[float], across_u: float, off_u: float
) -> None:
    depths_u, seen = np.zeros((2, SIDES, len(LINES_U))), np.empty((2, 1), dtype=bool)
    depths_u[1, side] = depths
    inwards_u = np.interp(across_u, LINES_U, depths) + off_u
    mark_seen(depths_u, LINES_U, np.array([from_side(side, across_u, inwards_u)]), seen)
    assert seen[0, 0] and seen[1, 0] == (off_u > 0.0)
