import numpy as np
import pytest

from app.geometry.kernels.general import solve_general
from app.geometry.kernels.symmetric import solve_symmetric


@pytest.mark.parametrize("count", [1, 2, 6, 15])
def test_symmetric_equations(count: int) -> None:
    rng = np.random.default_rng(count)
    root = rng.normal(size=(count + 2, count))
    normals, right = root.T @ root, rng.normal(size=count)
    solved, lower = right.copy(), np.tril(normals)  # the upper triangle is not read
    solve_symmetric(lower, solved)
    np.testing.assert_allclose(solved, np.linalg.solve(normals, right), rtol=1e-8)


@pytest.mark.parametrize("count", [1, 2, 6])
def test_equations_that_need_pivots(count: int) -> None:
    rng = np.random.default_rng(count)
    matrix, right = np.roll(np.diag(rng.uniform(1.0, 2.0, count)), 1, axis=0), rng.normal(size=(count, 4))
    matrix += 0.1 * rng.normal(size=(count, count)) * (matrix != 0)
    solved = right.copy()
    solve_general(matrix.copy(), solved)
    np.testing.assert_allclose(solved, np.linalg.solve(matrix, right), rtol=1e-10)
