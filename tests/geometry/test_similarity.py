import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import DegenerateGeometry
from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity, estimate_similarity

vectors = st.lists(st.floats(-1.8, 1.8), min_size=3, max_size=3).map(np.array)
similarities = st.builds(
    lambda scale, turn, shift: Similarity(scale, exp_rotation(turn), shift), st.floats(0.1, 10.0), vectors, vectors
)
POINTS_M = np.random.default_rng(5).uniform(-3.0, 3.0, (12, 3))


@given(similarities)
def test_noise_free_points_give_the_similarity_back(site_from_model: Similarity) -> None:
    estimated = estimate_similarity(POINTS_M, site_from_model.apply(POINTS_M))
    assert estimated.scale == pytest.approx(site_from_model.scale, rel=1e-10)
    np.testing.assert_allclose(estimated.rotation, site_from_model.rotation, atol=1e-10)
    np.testing.assert_allclose(estimated.translation_m, site_from_model.translation_m, atol=1e-9)


@given(similarities)
def test_three_points_are_enough(site_from_model: Similarity) -> None:
    three_m = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    estimated = estimate_similarity(three_m, site_from_model.apply(three_m))
    np.testing.assert_allclose(estimated.apply(POINTS_M), site_from_model.apply(POINTS_M), atol=1e-9)


@given(similarities, vectors)
def test_inverse_takes_points_back(site_from_model: Similarity, point_m: np.ndarray) -> None:
    points_m = point_m[None]
    there_and_back = site_from_model.inverse().apply(site_from_model.apply(points_m))
    np.testing.assert_allclose(there_and_back, points_m, atol=1e-11)


def test_noise_spreads_over_the_residuals_as_least_squares_says() -> None:
    rng, sigma_m, trials = np.random.default_rng(6), 1e-3, 200
    truth = Similarity(2.0, exp_rotation(np.array([0.4, -0.3, 1.1])), np.array([1.0, 2.0, 3.0]))
    squares = []
    for _ in range(trials):
        noisy_m = truth.apply(POINTS_M) + rng.normal(0.0, sigma_m, POINTS_M.shape)
        squares.append(((estimate_similarity(POINTS_M, noisy_m).apply(POINTS_M) - noisy_m) ** 2).sum() / sigma_m**2)
    redundancy = POINTS_M.size - 7
    # The mean of 200 chi-squares scatters by sqrt(2 r / 200); four of these keep chance out.
    assert np.mean(squares) == pytest.approx(redundancy, abs=4.0 * np.sqrt(2.0 * redundancy / trials))


def test_mirrored_points_get_a_proper_rotation() -> None:
    estimated = estimate_similarity(POINTS_M, POINTS_M * [1.0, 1.0, -1.0])
    assert np.linalg.det(estimated.rotation) == pytest.approx(1.0)


def test_points_on_a_line_are_refused_with_advice() -> None:
    line_m = np.outer(np.arange(4.0), [1.0, 2.0, 3.0])
    with pytest.raises(DegenerateGeometry, match="off that line"):
        estimate_similarity(line_m, line_m + 1.0)


@pytest.mark.parametrize(("scale", "rotation"), [(0.0, np.eye(3)), (-1.0, np.eye(3)), (1.0, np.diag([1.0, 1.0, -1.0]))])
def test_what_is_no_similarity_is_refused(scale: float, rotation: np.ndarray) -> None:
    with pytest.raises(ValueError, match="must be"):
        Similarity(scale, rotation, np.zeros(3))
