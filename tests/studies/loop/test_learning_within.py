"""What swings, slips or creeps in the block or beside it is learned as it was planted, in free decays.

Planted by the laboratory that shares no code with the models, or by an integration of its own.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import solve
from studies.campaigns import Channel, Test
from studies.laboratory.parameters import G, World
from studies.loop.fits.estimating import sensor_covariance
from studies.loop.models.model import LoopModel
from studies.loop.swings.learning import inner, memories, profiles, readings
from studies.loop.swings.tracing import search
from studies.loop.swings.trials import Trial

from .released import DECLARED, IDEAL, LEANS, MASS, NOISE, STEP, E, calibrated, decays


def first_learned(world: World) -> Trial:
    """The form that explains most by itself, of those that are no single coefficient; nine tenths of what is left."""
    simulator, plain = decays(world)
    windows = plain.swing.windows
    pool = [c for form in (readings, profiles, memories) for c in form(DECLARED, windows)]
    best = search(simulator, plain, [*pool, *inner(DECLARED, True)], repeated=True).best
    assert best is not None
    # Two states are fitted to each window: what is left of pure noise.
    noise = best.swing.samples - 2 * len(windows)
    assert plain.swing.chi2 > 1.5 * noise
    assert best.swing.chi2 - noise < 0.1 * (plain.swing.chi2 - noise)
    return best


@pytest.mark.slow
def test_a_mass_that_hangs_in_the_block_is_learned_as_one_that_hangs() -> None:
    """1 % of the block on an arm of 0.3 m, which swings with sqrt(g / l) / 2 pi = 0.91 Hz while the block is still.

    It was weighed with the block: what is left of that has the declared mass, centre and inertia together with it.  The
    laboratory damps how the arm turns in space, the model how it turns in the block: numbers come out that much off.
    """
    inner_mass, height, mass = 0.3, 0.4 - 0.3, MASS - 0.3
    centre = (MASS * DECLARED.centre_height - inner_mass * height) / mass
    about_floor = DECLARED.I_c + MASS * DECLARED.centre_height**2 - inner_mass * height**2
    left = {"mass": mass, "centre_height": centre, "inertia": about_floor - mass * centre**2}
    hung = {"slosh_mass": inner_mass, "slosh_length": 0.3, "slosh_height": 0.4, "slosh_damping": 0.8}
    found = first_learned(replace(IDEAL, **left, **hung))
    assert found.names == ("learned[mode, hanging]",)
    values = found.swing.model.effects["learned_mode"]
    assert values["frequency"] == pytest.approx(math.sqrt(G / 0.3) / (2.0 * math.pi), rel=0.05)
    # 0.8 1/s of the arm's speed: over 2 w.
    assert values["damping_ratio"] == pytest.approx(0.8 / (2.0 * math.sqrt(G / 0.3)), rel=0.3)


@pytest.mark.slow
def test_a_mass_that_hangs_in_the_block_and_was_not_weighed_is_found_by_the_frequency_it_has() -> None:
    """1.2 % of the block on an arm of a quarter of the height of its centre, hung there.

    It swings for long, and far: from a frequency that was off by 16 per cent, a start among others that were the square
    root of two apart, no fit went there.
    """
    hung = {"slosh_mass": 0.012 * MASS, "slosh_length": 0.075, "slosh_height": 0.3, "slosh_damping": 0.4}
    simulator, plain = decays(replace(IDEAL, **hung))
    found = search(simulator, plain, inner(DECLARED, True), leading=True).best
    assert found is not None and found.names == ("learned[mode, hanging]",)
    assert found.swing.rms < 1.01 and plain.swing.rms > 3.0
    values = found.swing.model.effects["learned_mode"]
    assert values["frequency"] == pytest.approx(math.sqrt(G / 0.075) / (2.0 * math.pi), rel=0.01)
    # What the arm carries is that share of all, and hangs an arm's length below its hinge.
    assert values["mass_ratio"] == pytest.approx(0.012 / 1.012, rel=0.05)
    assert values["height_ratio"] == pytest.approx((0.3 - 0.075) / DECLARED.centre_height, rel=0.05)
    assert values["apart"] > 0.8


@pytest.mark.slow
def test_a_heavy_mode_is_found_wherever_it_lies_between_the_frequencies_tried() -> None:
    """An eighth of the block at 1.2 times the height of its centre, on a spring of 2.68 p; from 2 p and from 4 p the
    fit of one went elsewhere.  What is searched is at stake, not the equations: the runs are the package's own."""
    p = DECLARED.p()
    planted = {"mass_ratio": 0.12, "height_ratio": 1.2, "frequency": 2.68 * p / (2.0 * math.pi), "damping_ratio": 0.03}
    system = LoopModel(DECLARED, E, {"learned_mode": planted}, G).system
    rng, tests, time = np.random.default_rng(3), [], STEP * np.arange(1501)
    for k, lean in enumerate(LEANS):
        run = solve(system, theta=lean, t_end=float(time[-1]), save_at=time, solver="numba")
        rotation = run.theta + NOISE * rng.standard_normal(time.size)
        tests.append(Test(f"free-{k}", "free", time, (Channel("rotation", "rotation", NOISE),), {"rotation": rotation}))
    simulator, plain = calibrated(tests)
    swinging = next(c for c in inner(DECLARED, True) if c.name == "learned[mode]")
    found = search(simulator, plain, [swinging]).best
    # In a few swings the mass makes two peaks of one.
    assert found is not None and float(np.median(found.swing.by_window)) < 1.05
    for name, value in planted.items():
        assert found.swing.model.effects["learned_mode"][name] == pytest.approx(value, rel=0.1), name


@pytest.mark.slow
def test_a_load_that_flows_to_the_low_side_is_learned_as_a_spring_that_pushes_and_yields() -> None:
    """y' = (c theta - y) / 0.4 s of the centre of mass, by DOP853 of SciPy from impact to impact: what it does, m g y,
    is m g c (theta - z), where z forgets in 0.4 s how the block has turned."""
    p, alpha, sinks, after = DECLARED.p(), DECLARED.alpha, 0.04, 0.4
    own = MASS * G * sinks / DECLARED.I_O
    rng, tests, time = np.random.default_rng(3), [], STEP * np.arange(1501)

    def rates(t: float, state: np.ndarray, side: float) -> tuple[float, float, float]:
        theta, omega, low = state
        return omega, -(p**2) * math.sin(side * alpha - theta) + own * low, (theta - low) / after

    def upright(t: float, state: np.ndarray, side: float) -> float:
        return float(state[0]) * side

    upright.terminal, upright.direction = True, -1.0  # type: ignore[attr-defined]
    for k, lean in enumerate(LEANS):
        rotation, begin, state = np.full(time.size, np.nan), 0.0, np.array([lean, 0.0, 0.0])
        side = math.copysign(1.0, lean)
        while begin < time[-1]:
            run = solve_ivp(
                rates, (begin, time[-1]), state, "DOP853", time[time >= begin], events=upright, args=(side,),
                rtol=1e-10, atol=1e-13,
            )  # fmt: skip
            if len(run.t):  # some are shorter than a sample
                rotation[np.searchsorted(time, run.t)] = run.y[0]
            if run.status != 1:
                break
            begin, state, side = run.t_events[0][0], run.y_events[0][0] * (0.0, E, 1.0), -side
            if abs(state[1]) < 1e-3:
                rotation[time >= begin] = 0.0
                break
        rotation += NOISE * rng.standard_normal(time.size)
        tests.append(Test(f"free-{k}", "free", time, (Channel("rotation", "rotation", NOISE),), {"rotation": rotation}))
    simulator, plain = calibrated(tests)
    found = search(simulator, plain, inner(DECLARED, True), leading=True).best
    assert found is not None and found.names == ("learned[relaxation beside a spring]",)
    assert found.swing.rms < 1.02
    assert found.swing.model.get("learned_hysteresis.time") == pytest.approx(after, rel=0.1)
    assert found.swing.model.get("learned_hysteresis.stiffness") == pytest.approx(own * DECLARED.I_O, rel=0.1)
    assert found.swing.model.get("learned_term.spring") == pytest.approx(own, rel=0.1)


@pytest.mark.slow
def test_a_layer_that_slips_is_learned_as_hysteresis() -> None:
    """A spring that slips at 0.05 rad by Bouc's law with the square: an exponent of two."""
    world = replace(IDEAL, layer=0.06 * MASS * G * math.hypot(0.1, 0.3), layer_width=0.05)
    found = first_learned(world)
    assert found.names == ("learned[hysteresis]",)
    assert found.swing.model.effects["learned_hysteresis"]["width"] == pytest.approx(0.05, rel=0.1)
    names = [p.name for p in found.swing.parameters]
    place = names.index("learned_hysteresis.exponent")
    sd = math.sqrt(sensor_covariance(decays(world)[0], found.swing)[place, place])
    assert abs(found.swing.values["learned_hysteresis.exponent"] - 2.0) < 3.0 * sd < 2.0
