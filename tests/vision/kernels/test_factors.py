import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.vision.kernels.factors import factorise, invert_lower, solve_by_inverse


@given(size=st.integers(1, 60), seed=st.integers(0, 2**32 - 1))
def test_equations_are_solved_by_the_inverse_of_their_factor(size: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(2 * size, size))
    matrix, right = rows.T @ rows + np.eye(size), rng.normal(size=(3, size))
    factor, inverse, solved = matrix.copy(), np.empty((size, size)), np.empty((3, size))
    begins = np.empty(size, dtype=np.int64)
    factorise(factor, begins)
    invert_lower(factor, begins, inverse)
    solve_by_inverse(inverse, right, solved)
    np.testing.assert_allclose(np.tril(factor), np.linalg.cholesky(matrix), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(inverse @ np.tril(factor), np.eye(size), atol=1e-9)
    np.testing.assert_allclose(solved @ matrix, right, atol=1e-8)
