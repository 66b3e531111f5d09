"""A step, its error and what lies within it, as SciPy's own pair of Dormand and Prince has them.

scipy.integrate.RK45 documents its tableau as attributes A, B, C, E and P; its error norm is Hairer, Norsett & Wanner
(1993), eq. (II.4.11).
"""

import numpy as np
import pytest
from scipy.integrate import RK45

from rocking.solvers.numba import runge_kutta

RTOL, ATOL = 1e-5, 1e-8


@pytest.fixture(scope="module")
def stepped() -> RK45:
    """A pendulum of large swings, one step on."""
    solver = RK45(
        lambda t, y: np.array([y[1], -9.0 * np.sin(y[0]), y[0] * y[1]]), 0.3, [1.2, -0.4, 0.7], 10.0,
        first_step=0.05, rtol=RTOL, atol=ATOL,
    )  # fmt: skip
    solver.step()
    assert solver.t_old == 0.3
    return solver


def test_the_error_of_a_step_is_the_root_mean_square_over_the_tolerance(stepped: RK45) -> None:
    h, y, y_new = stepped.t - stepped.t_old, np.array([1.2, -0.4, 0.7]), stepped.y
    scale = ATOL + RTOL * np.maximum(np.abs(y), np.abs(y_new))
    wanted = np.sqrt(np.mean((h * (stepped.K.T @ RK45.E) / scale) ** 2))
    # SciPy's E is the difference the other way round.
    assert runge_kutta.error_norm(y, y_new, h, stepped.K, RTOL, ATOL) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_what_lies_within_a_step_is_on_the_dense_output(stepped: RK45, share: float) -> None:
    h, out = stepped.t - stepped.t_old, np.empty(3)
    runge_kutta.dense(np.array([1.2, -0.4, 0.7]), h, share, stepped.K, out)
    assert out == pytest.approx(stepped.dense_output()(stepped.t_old + share * h), rel=1e-12)
