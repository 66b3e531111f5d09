"""Constants, starts and intervals of lanes on devices, function by function: against formulas and samples.

`test_devices` has the compiled functions.
"""

import math

import numpy as np
from functions_of_exact import G, base_of, fixed_of
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.hybrid import REST
from rocking.solvers.exact import jax_lanes
from rocking.solvers.recording import REACHED_END


def test_constants_of_lanes_over_records_are_their_parameters_and_bounds() -> None:
    F, _ = fixed_of(False)
    for name, want in {
        "p": [3, 4], "p2": [9, 16], "alpha": [0.23, 0.3], "onset": [0.19, 0.25], "e": [0.8, 0.7], "dt": [0.02, 0.03],
        "omega_rest": [1e-3, 1e-4], "t_end": [1.0, 1.3], "origin": [0.25, 0.35], "k_last": [37, 31],
        "stop_last": [0.75 - 37 * 0.02, 0.95 - 31 * 0.03], "count": [39, 29], "limit": [1 / 48, 1 / 64],
        "grow": np.exp([0.06, 0.12]), "first": [0, 64], "scale": [1.5 / G, -2.0 / 9.7], "omega": [0, 0],
        "phase": [0, 0], "rate": [0, 0],
    }.items():  # fmt: skip
        np.testing.assert_allclose(getattr(F, name), np.array(want), rtol=1e-12, err_msg=name)
    most, step_, dt = np.array([6.0 / G, 6.0 / 9.7]), np.array([0.02, 1 / 64]), F.dt
    longest = np.array([1 / 48, 0.03])
    for found, least in (
        (F.bulge, F.p2 * (0.5 * math.pi + most) * step_**2 / 8.0),
        (F.swell, F.p2 * (F.alpha + most) * dt**2 / 8.0),
        (F.clear, (most - F.alpha) * (np.cosh(0.5 * F.p * longest) - 1.0)),
    ):
        assert np.all(found >= least)
        np.testing.assert_allclose(found, least, rtol=1e-5)


def test_constants_of_lanes_over_sines_are_their_parameters_and_bounds() -> None:
    F, _ = fixed_of(True)
    for name, want in {
        "dt": [1.5 / 72, 1.25 / 90], "count": [72, 90], "limit": [1 / 48, 1 / 72], "origin": [0, 0], "scale": [0, 0],
        "rate": [1.7 / G, 2.0 / 9.7], "omega": [5, 9], "phase": [0.4, 0.1], "k_last": [47, 93], "first": [0, 0],
        "stop_last": [1.5 / 72, 1.3 - 93 * 1.25 / 90],
    }.items():  # fmt: skip
        np.testing.assert_allclose(getattr(F, name), np.array(want), rtol=1e-12, err_msg=name)
    most = np.array([1.7 / G * 1.0, 2.0 / 9.7 * 1.25])
    np.testing.assert_allclose(F.swell, F.p2 * (F.alpha + most) * F.dt**2 / 8.0, rtol=1e-5)


def test_a_run_of_lanes_begins_where_its_start_lies() -> None:
    F, starts = fixed_of(False)
    M = jax_lanes.begun(F, starts)
    assert M.k.tolist() == [-13, 1]
    np.testing.assert_allclose(jax_lanes.moment(F, M.k, M.tau), [0.0, 0.4], atol=1e-15)
    assert (M.x.tolist(), M.v.tolist(), M.s.tolist()) == ([0.1, 0.2], [0.0, 0.3], [1.0, -1.0])
    assert M.rests.tolist() == [starts[0, 0] == REST, starts[1, 0] == REST]
    assert M.peak.tolist() == [0.1, 0.2] and M.passage.tolist() == [0.0, 0.4]
    assert not M.tipped.any() and np.isinf(M.cap).all() and np.isnan(M.onset_time).all()
    assert (M.last == -math.inf).all() and (M.status == jax_lanes.RUNNING).all()
    for count in (M.impacts, M.events, M.stalls):
        assert count.tolist() == [0, 0]
    assert (jax_lanes.idle(M).status == REACHED_END).all()


def test_ends_of_an_interval_are_the_samples_there_and_zero_outside() -> None:
    (F, _), base = fixed_of(False), base_of()
    for k in (-2, 0, 5, 28, 29, 38, 39, 50):
        found = np.array(jax_lanes.ends_of_interval(F, base, np.full(2, k)))
        want = np.zeros((2, 2))
        for lane, (first, count, scale) in enumerate(((0, 39, 1.5 / G), (64, 29, -2.0 / 9.7))):
            if 0 <= k < count:
                want[:, lane] = scale * base.values[first + k : first + k + 2]
        np.testing.assert_allclose(found, want, rtol=1e-14)
    assert jax_lanes.stop_of(F, np.array([37, 30])).tolist() == [F.stop_last[0], F.dt[1]]
    W, _ = fixed_of(True)
    assert jax_lanes.rate_at(W, np.array([72, 0])).tolist() == [0.0, W.rate[1]]
    assert jax_lanes.rate_at(W, np.array([71, -1])).tolist() == [W.rate[0], 0.0]
    t, sine, cosine = jax_lanes.turns(W, np.array([3, 7]), np.array([0.01, 0.002]))
    np.testing.assert_allclose(t, [3 * 1.5 / 72 + 0.01, 7 * 1.25 / 90 + 0.002])
    np.testing.assert_allclose(np.array([sine, cosine]), [np.sin(W.omega * t + W.phase), np.cos(W.omega * t + W.phase)])
