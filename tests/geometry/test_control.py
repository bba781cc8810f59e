import numpy as np
import pytest

from app.geometry.control import ControlPoint


@pytest.mark.parametrize(("dot", "cell"), [("A", 0), ("E", 5), ("r3c2", 14), ("centre", None)])
def test_a_control_point_knows_its_cell(dot: str, cell: int | None) -> None:
    assert ControlPoint("P1", 389, dot, np.zeros(3), 0.001, "control").cell == cell


@pytest.mark.parametrize(
    ("dot", "position_m", "sigma_m", "role"),
    [
        ("Z", np.zeros(3), 0.001, "control"),
        ("A", np.zeros(2), 0.001, "control"),
        ("A", np.array([0.0, np.nan, 0.0]), 0.001, "control"),
        ("A", np.zeros(3), 0.0, "control"),
        ("A", np.zeros(3), np.nan, "check"),
        ("A", np.zeros(3), 0.001, "tie"),
    ],
)
def test_impossible_control_points_are_refused(dot: str, position_m: np.ndarray, sigma_m: float, role: str) -> None:
    with pytest.raises(ValueError, match=r"dot 'Z'|control point P1"):
        ControlPoint("P1", 389, dot, position_m, sigma_m, role)  # type: ignore[arg-type]
