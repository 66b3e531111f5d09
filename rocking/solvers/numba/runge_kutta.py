"""Dormand-Prince 5(4) with dense output, for compiled loops.

Source   Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19-26, for the pair; Shampine (1986), Math. Comput. 46,
         135-150, for the dense output of order 4.
"""

from __future__ import annotations

import numpy as np

from rocking.hybrid import Base
from rocking.solvers.numba.compiling import borrowing

C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
E = np.array([-71 / 57600, 0.0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
"""Weights of the difference between the fifth- and the fourth-order solution."""

P = np.array(
    [
        [1.0, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0.0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0.0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0.0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0.0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)
"""Dense output: y(t + x h) = y + h sum_i k_i (P_i0 x + P_i1 x^2 + P_i2 x^3 + P_i3 x^4)."""

STAGES = 7


@borrowing
def base_at(motion, t, low, high, motion_par):
    """What the base does at t; at an edge of a smooth stretch, its limit from within."""
    a_x, a_z, pitch, pitch_acceleration = motion(min(max(t, low), high), motion_par)
    return Base(a_x, a_z, pitch, pitch_acceleration)


@borrowing
def argument(i, y, h, k, out):
    """y + h sum_m A_im k_m, where stage i takes its slope, into `out`; written out, since loops over m take longer."""
    n = y.size
    if i == 1:
        for j in range(n):
            out[j] = y[j] + h * (A[1, 0] * k[0, j])
    elif i == 2:
        for j in range(n):
            out[j] = y[j] + h * (A[2, 0] * k[0, j] + A[2, 1] * k[1, j])
    elif i == 3:
        for j in range(n):
            out[j] = y[j] + h * (A[3, 0] * k[0, j] + A[3, 1] * k[1, j] + A[3, 2] * k[2, j])
    elif i == 4:
        for j in range(n):
            total = A[4, 0] * k[0, j] + A[4, 1] * k[1, j] + A[4, 2] * k[2, j]
            out[j] = y[j] + h * (total + A[4, 3] * k[3, j])
    elif i == 5:
        for j in range(n):
            total = A[5, 0] * k[0, j] + A[5, 1] * k[1, j] + A[5, 2] * k[2, j]
            out[j] = y[j] + h * (total + A[5, 3] * k[3, j] + A[5, 4] * k[4, j])
    else:
        for j in range(n):
            total = A[6, 0] * k[0, j] + A[6, 2] * k[2, j] + A[6, 3] * k[3, j]
            out[j] = y[j] + h * (total + A[6, 4] * k[4, j] + A[6, 5] * k[5, j])


@borrowing
def step(flow, motion, t, y, h, q, par, motion_par, low, high, k, y_stage, y_new):
    """One step of length h from (t, y) into `y_new`; `k`, shape (7, state), holds dy/dt at (t, y) in its first row."""
    n = y.size
    for i in range(1, STAGES):
        argument(i, y, h, k, y_stage)
        if i < STAGES - 1:  # the last two stages are at the same time
            base = base_at(motion, t + C[i] * h, low, high, motion_par)
        slope = flow(y_stage, q, base, par)
        for j in range(n):
            k[i, j] = slope[j]
    # The last stage stands at the end of the step: its argument is the fifth-order solution.
    for j in range(n):
        y_new[j] = y_stage[j]


@borrowing
def error_norm(y, y_new, h, k, rtol, atol):
    """Root mean square of the local error against the tolerance; 1 is just accepted."""
    n = y.size
    total = 0.0
    for j in range(n):
        error = E[0] * k[0, j] + E[2] * k[2, j] + E[3] * k[3, j] + E[4] * k[4, j] + E[5] * k[5, j] + E[6] * k[6, j]
        scale = atol + rtol * max(abs(y[j]), abs(y_new[j]))
        total += (h * error / scale) ** 2
    return np.sqrt(total / n)


@borrowing
def weight(i, x):
    """Of the slope of stage i in the state at the share x of the step."""
    return x * (P[i, 0] + x * (P[i, 1] + x * (P[i, 2] + x * P[i, 3])))


@borrowing
def dense(y, h, x, k, out):
    """State at the share x of the step into `out`."""
    w0, w2, w3, w4, w5, w6 = weight(0, x), weight(2, x), weight(3, x), weight(4, x), weight(5, x), weight(6, x)
    for j in range(y.size):
        total = w0 * k[0, j] + w2 * k[2, j] + w3 * k[3, j]
        out[j] = y[j] + h * (total + w4 * k[4, j] + w5 * k[5, j] + w6 * k[6, j])
