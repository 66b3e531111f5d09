"""Displacements integrated from accelerometers: each reading has errors of its own."""

import math

import numpy as np
import pytest
import xarray as xr

from rocking import Method1, solve
from studies import dead_reckoning
from studies.dead_reckoning import BLOCK, CALIBRATION, KNOWN_TO, NOISE, SAMPLE, Job, _error, reconstructed
from studies.running.statements import HOLDS, UNDECIDED
from studies.running.study import parser_of
from studies.specimens import specimen

H = specimen(BLOCK).h
G = 9.80665


def test_readings_without_errors_give_back_the_motion_of_the_top() -> None:
    """A marker's place and its pickup's readings come from different formulas; the integration is of first order."""
    t, r_X, r_Z, a_x, x = dead_reckoning._truth(None)
    early = t < 1.0
    found = reconstructed(t[early], r_X[early], r_Z[early], a_x[early], np.arcsin(x[0] / H), H)
    assert found == pytest.approx(x[early], abs=2.0 * SAMPLE * np.abs(np.gradient(x, t)).max())


def test_impulses_are_across_and_along_the_block() -> None:
    """Upright, the top moves across at omega h and, by its corner, along at omega b/2: by the change of omega, which is
    (1 - e) omega across; along, the corner changes sides, and the block falls before and rises after: (1 + e) omega."""
    block = specimen(BLOCK)
    run = solve(Method1(block), theta=0.1, t_end=1.0, save_at=np.arange(0.0, 1.0, SAMPLE))
    across, along = dead_reckoning._impulses(run, (0.0, H))
    before = run.events.y_before[0][1]
    k = np.flatnonzero(across)[0]
    e = block.housner_restitution
    assert abs(across[k]) == pytest.approx((1.0 - e) * abs(before) * H, rel=1e-9)
    assert along[k] == pytest.approx((1.0 + e) * abs(before) * 0.5 * block.b, rel=1e-9)


@pytest.mark.parametrize("off", [0.005, -0.005])
@pytest.mark.parametrize("start", [0.05, -0.05])
def test_altering_the_angle_finds_the_path_that_runs_away_to_neither_side(start: float, off: float) -> None:
    """Readings that x = start cos(pi t) would give, without errors, and a guess that is wrong by 5 mrad.

    Wrong by that much, x is wrong by 2.5 mm e^(lambda t), lambda = sqrt(g/h), and a metre off within 2 s.
    """
    t = SAMPLE * np.arange(1751)  # to 3.5 s, where x is zero: what ends to either side of it is known to leave there
    x, x_2 = start * np.cos(np.pi * t), -(np.pi**2) * start * np.cos(np.pi * t)
    a_x, r_Z = np.sin(5.0 * t), np.full_like(t, G)
    r_X = (x_2 + a_x - r_Z * x / H) / np.sqrt(1.0 - (x / H) ** 2)
    guess = math.asin(x[0] / H) + off
    assert t[np.isnan(reconstructed(t, r_X, r_Z, a_x, guess, H))][0] < 2.0
    found = dead_reckoning._altered(t, r_X, r_Z, a_x, guess, H)
    # The first step takes a whole step's speed for half of one: start pi^2 SAMPLE / 2 in speed, over lambda in place.
    assert found == pytest.approx(x, abs=1.1 * abs(x_2[0]) * 0.5 * SAMPLE / math.sqrt(G / H))


def test_gains_and_noises_of_the_two_pickups_are_drawn_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against the readings as they are: a gain each (standard deviation 1e-3), and noise each."""
    seen = []

    def kept(t, r_X, r_Z, a_x, theta0, h):
        seen.append((r_X, r_Z, theta0))
        return reconstructed(t, r_X, r_Z, a_x, theta0, h)

    monkeypatch.setattr(dead_reckoning, "reconstructed", kept)
    _, *exact, _, x = dead_reckoning._truth(None)
    gains, noises, angles = [], [], []
    for seed in range(12):
        _error(Job("7 s", seed, 90.0))
        *readings, theta0 = seen.pop()
        fits = [float(a @ r / (a @ a)) for a, r in zip(exact, readings, strict=True)]
        gains.append(fits)
        noises.append([float(np.std(r - k * a)) for a, r, k in zip(exact, readings, fits, strict=True)])
        angles.append(theta0 - np.arcsin(x[0] / H))
    gains, noises = np.array(gains) - 1.0, np.array(noises)
    # Of 3500 samples of 0.01 m/s^2 a gain is read to 2e-5 along (readings near g) and to some 1e-4 across.
    assert noises == pytest.approx(NOISE, rel=0.05)
    assert gains.std(axis=0) == pytest.approx(CALIBRATION, rel=0.6)
    assert abs(np.corrcoef(gains.T)[0, 1]) < 0.75
    assert np.std(angles) == pytest.approx(KNOWN_TO, rel=0.6)


def _checked(long, error):
    names = dead_reckoning.cases(long)
    values = np.array([[error[name]] * 3 for name in names])
    over = ("case", "seed")
    ds = xr.Dataset({"error": (over, values), "good_until": (over, np.ones_like(values))}, {"case": list(names)})
    found = dead_reckoning.check(ds)
    verdicts = dict(zip(found.statement_key.values, found.statement_holds.values.tolist(), strict=True))
    return {key.partition(".")[2]: verdict for key, verdict in verdicts.items()}


def test_what_ran_away_has_no_error_to_compare() -> None:
    """1 mrad grows by e^22 in 7 s: past the height of the block whatever the sign, as 1 % of calibration does."""
    lost = [_error(Job(case, 0, 90.0)) for case in ("angle alone", "calibration alone")]
    assert [found["error"] for found in lost] == [math.inf, math.inf]
    assert all(0.5 < found["good_until"] < 3.0 for found in lost)
    errors = dict.fromkeys(dead_reckoning.cases(90.0), math.inf)
    assert _checked(90.0, errors)["angle"] == UNDECIDED
    assert _checked(90.0, errors | {"calibration alone": 0.5})["angle"] == HOLDS


def test_a_shorter_ramp_is_named_and_decides_nothing_of_90_s() -> None:
    quick = dead_reckoning.plan_of(parser_of(dead_reckoning.STUDY).parse_args(["--quick"]))
    names = dead_reckoning.cases(quick.long)
    assert f"{quick.long:g} s" in names and "90 s" not in names
    assert _checked(quick.long, dict.fromkeys(names, math.inf))["long"] == UNDECIDED
    assert _checked(90.0, dict.fromkeys(dead_reckoning.cases(90.0), math.inf))["long"] == HOLDS
