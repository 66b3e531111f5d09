"""Displacements integrated from two accelerometers on a block: for how long that works, and on what it hangs.

The pickups sit at the middle of the top, along and across the block, and turn with it.  With readings r_X and r_Z, the
displacement x of the top relative to the base and theta = asin(x/h),

    x'' = r_X cos(theta) + r_Z sin(theta) - a_x

Since r_Z is near g, an error of x grows as exp(sqrt(g/h) t): by e^22 in 7 s for a block of 1 m.  "Altered" finds the
initial angle with which the integration does not run away to either side, by bisection, as the paper did by trial.

See          an integration from the best known angle runs away in seconds; altered, it follows 7 s, and never 90 s.
Paper says   it worked for a free vibration of 7 s after the initial angle had been altered many times, and would have
             been infeasible for 90 s; the initial angle matters most, then the calibration.
Run          python -m studies.dead_reckoning [--quick]  ->  build/studies/dead_reckoning.nc, then .png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator
from numpy.typing import NDArray

from excitation import RampedSinusoid
from rocking import Method1, solve
from rocking.instruments import accelerometer, marker
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import G
from studies.criteria.free_vibration import RELEASE
from studies.running.labelled import PAPER, gathered, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

Array = NDArray[np.float64]

BLOCK = 1
SAMPLE = 2e-3
KNOWN_TO, NOISE, CALIBRATION = 1e-4, 0.01, 1e-3
"""Errors of initial angle [rad], reading [m/s^2] and calibration [1]: standard deviations."""

PAPER_S = "90 s"
"""The long ramp of the paper, as a case is named."""


def cases(long: float) -> tuple[str, ...]:
    """Names of what is integrated; long: length of the ramp [s].

    A free vibration of 7 s, and a ramp, with the angle known to 0.1 mrad and with the angle altered until it does not
    run away; a free vibration with the angle wrong by 1 mrad, and with the calibration wrong by 1 %, all else exact.
    """
    ramp = f"{long:g} s"
    return "7 s", "7 s altered", ramp, f"{ramp} altered", "angle alone", "calibration alone"


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    seeds: int = 9
    long: float = 90.0


@dataclass(frozen=True)
class Job:
    """One reconstruction."""

    case: str
    seed: int
    long: float


def _truth(long: float | None) -> tuple[Array, Array, Array, Array, Array]:
    """(times, r_X, r_Z, base acceleration, displacement of the top) of a free vibration of 7 s or of a long ramp."""
    block = specimen(BLOCK)
    base = RampedSinusoid(3.0, 90.0 if long is None else long, 1e-9 if long is None else 0.8 * G)
    end = 7.0 if long is None else long
    t = np.arange(0.0, end, SAMPLE)
    theta0 = RELEASE * block.alpha if long is None else 0.0
    run = solve(Method1(block, form="nonlinear"), base, t_end=end, save_at=t, theta=theta0)
    top = (0.0, block.h)
    x = marker(run, top)[0]
    readings = (accelerometer(run, top, axis) for axis in ((1.0, 0.0), (0.0, 1.0)))
    # An impact is an impulse, of which a sample says nothing: what a pickup reads is the mean over its sample.
    r_X, r_Z = readings
    impulse = _impulses(run, top)
    return run.t, r_X + impulse[0] / SAMPLE, r_Z + impulse[1] / SAMPLE, base(run.t)[0], x


def _impulses(run: Any, top: tuple[float, float]) -> tuple[Array, Array]:
    """Changes of velocity [m/s] of the top in the impacts, across and along the block, in the sample of each."""
    h = top[1]
    along, across = np.zeros_like(run.t), np.zeros_like(run.t)
    omega = run.system.state_names.index("omega")
    half = 0.5 * specimen(BLOCK).b
    for i in np.flatnonzero(np.isin(run.events.t, run.impact_times)):
        k = min(int(np.searchsorted(run.t, run.events.t[i])), run.t.size - 1)
        before, after = float(run.events.y_before[i][omega]), float(run.events.y_after[i][omega])
        s = float(run.events.s_after[i])
        # About the corner s at (s b/2, 0) the top moves at omega times its arm; the block stands upright.
        across[k] += (after - before) * h
        along[k] += after * s * half + before * s * half
    return across, along


def reconstructed(t: Array, r_X: Array, r_Z: Array, a_x: Array, theta0: float, h: float) -> Array:
    """Displacement of the top [m] from the readings; NaN once it runs beyond the block's height."""
    step = float(t[1] - t[0])
    x, v = h * math.sin(theta0), 0.0
    found = np.full(t.size, math.nan)
    for k in range(t.size):
        found[k] = x
        if abs(x) >= 0.99 * h:
            break
        sin = x / h
        v += step * (r_X[k] * math.sqrt(1.0 - sin * sin) + r_Z[k] * sin - a_x[k])
        x += step * v
    return found


def _altered(t: Array, r_X: Array, r_Z: Array, a_x: Array, guess: float, h: float) -> Array:
    """The reconstruction from the initial angle between those that run away to either side."""
    low, high = guess - 0.02, guess + 0.02
    found = reconstructed(t, r_X, r_Z, a_x, guess, h)
    for _ in range(60):
        middle = 0.5 * (low + high)
        path = reconstructed(t, r_X, r_Z, a_x, middle, h)
        if np.isnan(path).sum() <= np.isnan(found).sum():
            found = path
        known = path[~np.isnan(path)]
        low, high = (low, middle) if known[-1] > 0.0 else (middle, high)
    return found


def _error(job: Job) -> dict[str, Any]:
    """Error over the peak displacement, infinite where the reconstruction ran away, and until when it is small."""
    random = np.random.default_rng(job.seed)
    long = job.case.startswith(f"{job.long:g} s")
    t, r_X, r_Z, a_x, x = _truth(job.long if long else None)
    h = specimen(BLOCK).h
    theta0 = math.asin(x[0] / h)
    if job.case.endswith("alone"):
        sign = random.choice((-1.0, 1.0))
        angle = theta0 + sign * (1e-3 if job.case.startswith("angle") else 0.0)
        gain = 1.0 + sign * (0.01 if job.case.startswith("calibration") else 0.0)
        path = reconstructed(t, gain * r_X, gain * r_Z, a_x, angle, h)
    else:
        gains = 1.0 + CALIBRATION * random.standard_normal(2)
        noise = NOISE * random.standard_normal((2, t.size))
        readings = (gains[0] * r_X + noise[0], gains[1] * r_Z + noise[1])
        angle = theta0 + KNOWN_TO * random.standard_normal()
        integrate = _altered if job.case.endswith("altered") else reconstructed
        path = integrate(t, *readings, a_x, angle, h)
    # How far it had come when it was given up says nothing: the block's height, whatever the cause.
    largest = math.inf if np.isnan(path).any() else float(np.max(np.abs(path - x)))
    wrong = np.flatnonzero(~(np.abs(path - x) < 0.2 * np.abs(x).max()))
    return {
        "error": largest / float(np.abs(x).max()),
        "good_until": float(t[wrong[0]]) if wrong.size else float(t[-1]),
    }


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Errors over (case, seed), and one reconstruction of 7 s over time."""
    names = cases(plan.long)
    jobs = [Job(case, seed, plan.long) for case, seed in product(names, range(plan.seeds))]
    results = parts.results(jobs, _error, "dead_reckoning")
    labels = {
        "error": ("1", "largest error of the displacement of the top over its peak, infinite if it ran away"),
        "good_until": ("s", "time until which the error stays below a fifth of the peak"),
    }
    ds = xr.Dataset(gathered(results, ("case", "seed"), (len(names), plan.seeds), labels))
    ds = ds.assign_coords(names_axis("case", names, "what is integrated"))
    ds = ds.assign_coords(seed=("seed", list(range(plan.seeds)), {"units": "1", "long_name": "seed of the errors"}))
    t, r_X, r_Z, a_x, x = _truth(None)
    h, theta0 = specimen(BLOCK).h, math.asin(x[0] / specimen(BLOCK).h)
    random = np.random.default_rng(0)
    noisy = (r_X + NOISE * random.standard_normal(t.size), r_Z + NOISE * random.standard_normal(t.size))
    m = {"units": "m"}
    ds = ds.assign_coords(time=("time", t, {"units": "s", "long_name": "time"}))
    ds["true"] = ("time", x, m | {"long_name": "displacement of the top"})
    plain = reconstructed(t, *noisy, a_x, theta0 + KNOWN_TO, h)
    ds["known"] = ("time", plain, m | {"long_name": "integrated, angle wrong by 0.1 mrad"})
    altered = _altered(t, *noisy, a_x, theta0 + KNOWN_TO, h)
    ds["altered"] = ("time", altered, m | {"long_name": "integrated, angle altered"})
    return ds.assign_attrs(references=f"{PAPER}, Material parameters", block=BLOCK, long=plan.long)


def figure(ds: xr.Dataset) -> Figure:
    """One reconstruction (left), and for how long each case works (right)."""
    fig = new_figure(12.0, 4.4)
    left, right = fig.subplots(1, 2, width_ratios=[1.4, 1.0])
    left.plot(ds.time, 1e3 * ds.true, color="k", lw=2, label="true")
    left.plot(ds.time, 1e3 * ds.known, color="#D55E00", ls=":", lw=1.8, label="integrated, angle wrong by 0.1 mrad")
    left.plot(ds.time, 1e3 * ds.altered, color="#0072B2", ls="--", lw=1.3, label="integrated, angle altered")
    limit = 1.6e3 * float(np.abs(ds.true).max())
    left.set_ylim(-limit, limit)
    left.set_xlabel("Time [s]")
    left.set_ylabel("Displacement of the top [mm]")
    left.legend(fontsize=8)
    left.grid(alpha=0.3)
    rows = np.arange(ds.sizes["case"])
    for row, case in zip(rows, ds.case.values, strict=True):
        times = ds.good_until.sel(case=case)
        right.plot(times, np.full(times.size, row), ls="none", marker="o", mfc="none", color="#0072B2", ms=5)
    right.set_yticks(rows, [str(case) for case in ds.case.values])
    right.set_xscale("log")
    right.xaxis.set_major_locator(FixedLocator([1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 90.0]))
    right.xaxis.set_major_formatter("{x:g}")
    right.xaxis.set_minor_locator(NullLocator())
    right.set_xlim(0.9, 1.1 * float(ds.attrs["long"]))
    right.invert_yaxis()
    right.set_xlabel("Error below a fifth of the peak until [s]")
    right.grid(alpha=0.3)
    caption(
        fig,
        f"Displacement of the top of Block {ds.attrs['block']} integrated from two accelerometers on it. Notice: "
        "gravity makes every error grow e-fold each third of a second, so an angle known to 0.1 mrad is good for a few "
        "seconds; altered until the integration does not run away, it lasts for longer (right: whether for all of a "
        f"ramp of {float(ds.attrs['long']):g} s).",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on integrating the pickups; runs that are all lost have no ratio of errors."""
    error = ds.error.median("seed")
    by_case = {str(case): float(error.sel(case=case)) for case in ds.case.values}
    ratio = by_case["angle alone"] / by_case["calibration alone"]
    long, altered = (by_case.get(case, math.nan) for case in (PAPER_S, f"{PAPER_S} altered"))
    good = {str(case): float(ds.good_until.median("seed").sel(case=case)) for case in ds.case.values}
    until = "good until [s]: " + listed(good)
    return table(
        [
            Finding(CLAIMS["dead_reckoning.short"], by_case["7 s"], until),
            Finding(CLAIMS["dead_reckoning.altered"], by_case["7 s altered"], until),
            Finding(CLAIMS["dead_reckoning.long"], long, f"altered {altered:.3g}; {until}"),
            Finding(CLAIMS["dead_reckoning.angle"], ratio, until),
        ]
    )


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for."""
    return Plan(2, 20.0) if options.quick else Plan()


STUDY = Study(
    name="dead_reckoning",
    title="Displacements integrated from accelerometers on a block, over 7 and over 90 s",
    about="For how long can the motion of a block be integrated from two accelerometers that turn with it?",
    plan=plan_of,
    dataset=dataset,
    figures={"dead_reckoning": figure},
    check=check,
    example='ds.error.median("seed").to_series()',
)

if __name__ == "__main__":
    STUDY.run()
