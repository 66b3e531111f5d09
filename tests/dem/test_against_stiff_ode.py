"""The contact law in free rocking against SciPy on the same springs and dashpots, integrated between located events.

Written out here from Newton's law: a rectangle over two bottom corners, each pressing with N = kn d - c v_n while that
is positive (d its overlap) and held tangentially by a spring from where it began to press, and a dashpot (no slip).
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dem

B, H, DEPTH, DENSITY, G = 0.30, 1.00, 0.50, 597.0, 9.80665
MASS = DENSITY * B * H * DEPTH
INERTIA = MASS * (B * B + H * H) / 12.0
CORNERS = ((0.5 * B, -0.5 * H), (-0.5 * B, -0.5 * H))
K = 1.98e7


def corner(y, i):
    """Position and velocity of corner i; y = x, z, theta, their rates."""
    x, z, theta, vx, vz, omega = y
    along, up = CORNERS[i]
    r_x = along * math.cos(theta) + up * math.sin(theta)
    r_z = up * math.cos(theta) - along * math.sin(theta)
    return (r_x, r_z), (x + r_x, z + r_z), (vx + omega * r_z, vz - omega * r_x)


def normal(y, i, c):
    _, (_, height), (_, v_n) = corner(y, i)
    return -K * height - c * v_n


def rates(y, anchors, c):
    force = [0.0, -MASS * G, 0.0]
    for i, anchor in enumerate(anchors):
        if anchor is not None:
            (r_x, r_z), (x, _), (v_t, _) = corner(y, i)
            N, F = normal(y, i, c), -K * (x - anchor) - c * v_t
            force = [force[0] + F, force[1] + N, force[2] + r_z * F - r_x * N]
    return [*y[3:], force[0] / MASS, force[1] / MASS, force[2] / INERTIA]


def presses(y, i, c):
    """Positive while corner i would press: overlap there, and a force that pushes."""
    _, (_, height), _ = corner(y, i)
    return min(-height / 1e-9, normal(y, i, c))


def reference(theta0, c, t_end, times):
    """theta at `times`, released at theta0 on the +x corner, which carries the weight."""
    lever = math.hypot(B, H) / 2.0
    psi = math.atan2(B, H) - theta0
    y = np.array([0.0, lever * math.cos(psi) - MASS * G / 2.0 / K, theta0, 0.0, 0.0, 0.0])
    anchors = [corner(y, 0)[1][0], None]
    t, out = 0.0, np.full(times.size, np.nan)
    while t < t_end:
        events = []
        for i in (0, 1):

            def event(_, y, i=i):
                return presses(y, i, c) if anchors[i] is None else normal(y, i, c)

            event.terminal, event.direction = True, 1 if anchors[i] is None else -1
            events.append(event)
        run = solve_ivp(
            lambda _, y: rates(y, anchors, c), (t, t_end), y, "DOP853", events=events, dense_output=True,
            rtol=1e-10, atol=1e-12, max_step=2e-3,
        )  # fmt: skip
        inside = (times >= t) & (times <= run.t[-1])
        if inside.any():
            out[inside] = run.sol(times[inside])[2]
        t, y = run.t[-1], run.y[:, -1]
        for i in (0, 1):
            if len(run.t_events[i]):
                anchors[i] = corner(y, i)[1][0] if anchors[i] is None else None
                t, y = t + 1e-9, y + 1e-9 * np.array(rates(y, anchors, c))  # past the root, which is no new event
    return out


@pytest.mark.parametrize("xi", [0.05, 0.3, 1.0])
def test_free_rocking_on_springs_and_dashpots_agrees_with_scipy(xi):
    theta0, t_end = 0.12, 0.9
    c = 2.0 * xi * math.sqrt(K * MASS)
    errors = []
    for dt in (4e-6, 2e-6):
        run = dem.simulate(
            dem.single_block(B, H, DEPTH, DENSITY), t_end=t_end, dt=dt, mu=math.inf, damping=c, theta0=theta0,
            gap0=-MASS * G / 2.0 / K, save_every=round(1e-3 / dt),
        )  # fmt: skip
        errors.append(np.abs(run.theta - reference(theta0, c, t_end, run.time)).max())
    # Two impacts lie in the run.  The dashpots lag by half a step, an error of first order, xi om dt of the rebound:
    # with om ~ 1e3 1/s that is 2e-3 at 2e-6 s and xi = 1, of a tilt of 0.09 rad.
    assert errors[1] < max(2e-3 * xi, 2e-4) * 0.09
    assert errors[1] < 0.7 * errors[0] or errors[1] < 1e-6
