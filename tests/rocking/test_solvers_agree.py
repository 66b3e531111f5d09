"""Every installed solver tells the same story, and a solver of another package is found by its entry point."""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from excitation import PiecewiseLinear, RampedSinusoid, RectangularPulse, SampledMotion
from rocking import G_STANDARD, Block, Method1, Method2, Mode, Outcome, solve
from rocking.effects import compose
from rocking.effects.base_adhesion import BaseAdhesion
from rocking.solvers import available, load
from rocking.trajectory import BALANCE

G = 9.81
OTHERS = [name for name in available() if name != "scipy"]


def seldom(names: Iterable[str]) -> list[Any]:
    """Diffrax marked slow: it compiles each kind of system and motion anew, for seconds.

    Of the default tests two run it, that of shaking by Method 1 and that of the modes of Method 2.
    """
    return [pytest.param(name, marks=pytest.mark.slow if name == "diffrax" else ()) for name in names]


def test_the_two_built_in_solvers_are_installed() -> None:
    assert {"numba", "scipy"} <= set(available())
    assert list(available()) == sorted(available())


def skip_if_declined(name: str, system: Any, motion: Any) -> None:
    """Skip the case of a solver that declines the system or the motion, with its sentence."""
    refusal = load(name).declines(system, motion)
    if refusal is not None:
        pytest.skip(f"{name} declines: {refusal}")


def pair(name: str, system: Any, motion: Any, impacts: int, **options: Any) -> tuple[Any, Any]:
    """Runs by scipy and by the solver of that name over the first `impacts` impacts, with sharp tolerances.

    Later ones say nothing: under shaking a difference grows with each impact, as the motion is chaotic.
    """
    skip_if_declined(name, system, motion)
    options |= {"rtol": 1e-12, "atol": 1e-15}
    one = solve(system, motion, solver="scipy", **options)
    assert len(one.impact_times) >= impacts, f"the case has {len(one.impact_times)} impacts only"
    if len(one.impact_times) > impacts:
        options["t_end"] = float(np.mean(one.impact_times[impacts - 1 : impacts + 1]))
        one = solve(system, motion, solver="scipy", **options)
    return one, solve(system, motion, solver=name, **options)


def must_agree(one: Any, other: Any) -> None:
    """Same events in the same order, impact times to 1e-8 s, and the same end."""
    np.testing.assert_array_equal(one.events.guard, other.events.guard)
    np.testing.assert_array_equal(one.events.mode_after, other.events.mode_after)
    np.testing.assert_array_equal(one.events.s_after, other.events.s_after)
    # The promise of the solvers: each locates impacts to 1e-8 s.
    np.testing.assert_allclose(other.impact_times, one.impact_times, rtol=0.0, atol=1e-8)
    assert one.outcome is other.outcome
    assert other.t_end == pytest.approx(one.t_end, abs=1e-8)
    # Accelerations of up to 20 m/s^2 and 20 rad/s^2 turn that into 2e-7 of a velocity, a few times over.
    np.testing.assert_allclose(other.events.y_after, one.events.y_after, rtol=0.0, atol=1e-6)
    np.testing.assert_array_equal(one.t, other.t)
    np.testing.assert_allclose(other.y[-1], one.y[-1], rtol=0.0, atol=1e-6)


def still_base() -> Any:
    """A base at rest."""
    from rocking.motion import Still

    return Still()


@pytest.mark.parametrize("name", seldom(OTHERS))
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
@pytest.mark.parametrize("seed", range(4))
def test_method_1_rocks_freely_with_the_same_impacts(name: str, form: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    block = Block(b=float(rng.uniform(0.1, 0.4)), h=float(rng.uniform(0.5, 2.0)))
    system = Method1(block, form=form, restitution=float(rng.uniform(0.9, 1.0)), g=G)
    theta = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 0.95)) * block.alpha
    must_agree(*pair(name, system, still_base(), 20, theta=theta, t_end=25.0))


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
@pytest.mark.parametrize("seed", range(4))
def test_method_1_under_shaking_has_the_same_impacts(window: Any, name: str, form: Any, seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    block = Block(b=float(rng.uniform(0.2, 0.4)), h=float(rng.uniform(0.5, 1.0)))
    system = Method1(block, form=form, g=G)
    amplitude = 0.9 * G * math.tan(block.alpha)
    x = (0.0, amplitude, float(rng.uniform(25.0, 35.0)), 0.3)
    motion = window(0.1, 30.0, x=x, z=(0.0, 1.5, float(rng.uniform(5.0, 50.0)), 1.0))
    must_agree(*pair(name, system, motion, 20, theta=0.3 * block.alpha, t_end=4.0))


# A motion that every solver knows, so that the closed form of the linear block meets the integrators too.
@pytest.mark.parametrize("name", seldom(OTHERS))
@pytest.mark.parametrize("frequency", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
def test_method_1_under_a_ramped_sinusoid_has_the_same_impacts(name: str, frequency: float, form: Any) -> None:
    motion = RampedSinusoid(frequency, 10.0, 8.0)
    system = Method1(Block(b=0.25, h=0.8), form=form, g=G)
    # At 1 Hz the block falls after two impacts.
    one, other = pair(name, system, motion, t_end=10.0, impacts=12 if frequency > 1.0 else 2)
    must_agree(one, other)
    assert other.peak_rotation == pytest.approx(one.peak_rotation, abs=1e-7)


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.parametrize("seed", range(6))
def test_method_2_moves_through_the_same_modes(window: Any, name: str, seed: int) -> None:
    rng = np.random.default_rng(200 + seed)
    block = Block(b=float(rng.uniform(0.2, 0.4)), h=float(rng.uniform(0.5, 1.0)))
    mu = float(rng.uniform(0.15, 0.8))
    system = Method2(
        block, friction=mu, kinetic_friction=0.8 * mu, normal_restitution=[0.0, 0.3][seed % 2],
        tangential_restitution=float(rng.uniform(-0.5, 0.5)), chatter_time=1e-3, g=G,
    )  # fmt: skip
    amplitude = 1.2 * G * min(mu, block.b / block.h)
    motion = window(0.1, 5.0, x=(0.0, amplitude, float(rng.uniform(15.0, 25.0)), 0.3), z=(0.0, 2.0, 23.0, 1.0))
    one, other = pair(name, system, motion, 2, theta=0.4 * block.alpha, t_end=2.0, max_events=5000)
    must_agree(one, other)


@pytest.mark.parametrize("name", seldom(OTHERS))
@pytest.mark.parametrize("e_n", [0.0, 0.4])
def test_method_2_rocks_freely_with_the_same_twenty_impacts(name: str, e_n: float) -> None:
    law: Any = {"impact_law": "two_corner", "restitution": 0.97} if e_n == 0.0 else {"normal_restitution": e_n}
    system = Method2(Block(b=0.2, h=0.8), friction=1.0, chatter_time=1e-3, g=G, **law)
    must_agree(*pair(name, system, still_base(), 20, theta=0.2, t_end=10.0))


# A jump in the base acceleration is a breakpoint of the motion: no step goes over it.  Written out: the block waits
# upright until 0.7 s, where 6 m/s^2 > (b/h) g sets in, and leaves rest there and not a step later.
@pytest.mark.parametrize("name", seldom(available()))
@pytest.mark.parametrize("method", [Method1, Method2])
def test_a_jump_in_the_push_starts_the_rocking_at_that_instant(window: Any, name: str, method: Any) -> None:
    system = method(Block(b=0.2, h=0.8), g=G, **({"friction": 1.0} if method is Method2 else {}))
    motion = window(0.7, 1.0, x=(6.0, 0.0, 0.0, 0.0))
    skip_if_declined(name, system, motion)
    run = solve(system, motion, t_end=0.9, solver=name)
    assert run.onset_time == pytest.approx(0.7, abs=1e-14)
    assert run.events.mode_after[0] == Mode.ROTATION
    # Newton at theta = 0, to first order in time: omega' = -p^2 (a_x/g cos(alpha) - sin(alpha)).
    i = np.searchsorted(run.t, 0.7) + 3
    p2 = 0.75 * G / (0.5 * math.hypot(0.2, 0.8))
    rate = -p2 * (6.0 / G * math.cos(math.atan(0.25)) - math.sin(math.atan(0.25)))
    omega = run.y[i, system.state_names.index("omega")]
    assert omega == pytest.approx(rate * (run.t[i] - 0.7), rel=1e-3)  # three milliseconds, tilt of 1e-5


# The error of the fifth impact time falls with the tolerance, to the rounding of a time.  The base is at rest, so that
# nothing but the tolerance limits a step.
@pytest.mark.parametrize("name", seldom(available()))
@pytest.mark.parametrize("method", [Method1, Method2])
def test_the_error_falls_as_the_tolerance_is_tightened(name: str, method: Any) -> None:
    system = method(Block(b=0.2, h=0.8), g=G, **({"friction": 1.2} if method is Method2 else {}))

    def fifth(rtol: float, solver: str) -> float:
        run = solve(system, theta=0.15, t_end=3.0, rtol=rtol, atol=1e-3 * rtol, solver=solver)
        return float(run.impact_times[4])

    skip_if_declined(name, system, still_base())
    truth = fifth(1e-13, "scipy")
    errors = [abs(fifth(rtol, name) - truth) for rtol in (1e-5, 1e-8, 1e-11)]
    # A local tolerance a thousand times smaller: at least thirty times less error, down to 1e-11 s.
    assert errors[1] < max(errors[0] / 30.0, 1e-11)
    assert errors[2] < max(errors[1] / 30.0, 1e-11)


@pytest.mark.parametrize("name", seldom(available()))
def test_samples_do_not_depend_on_how_many_are_asked_for(window: Any, name: str) -> None:
    system = Method1(Block(b=0.2, h=0.8), g=G)
    motion = window(0.0, 2.0, x=(0.0, 3.0, 15.0, 0.3))
    skip_if_declined(name, system, motion)
    few = solve(system, motion, theta=0.1, t_end=2.0, save_at=[0.0, 0.31, 0.77, 2.0], solver=name)
    many = solve(system, motion, theta=0.1, t_end=2.0, save_at=np.linspace(0.0, 2.0, 201), solver=name)
    # The same steps, but 0.31 and 31 times 0.01 may differ in the last bit of a time.
    np.testing.assert_allclose(few.y[:3], many.y[[0, 31, 77]], rtol=0.0, atol=1e-14)
    np.testing.assert_array_equal(few.events.t, many.events.t)


def test_an_unknown_solver_is_answered_with_the_installed_ones() -> None:
    with pytest.raises(ValueError, match=r"solver='euler': want one of .*numba.*scipy"):
        solve(Method1(Block(b=0.2, h=0.8)), t_end=1.0, solver="euler")


@pytest.fixture
def other_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed package with two solvers: one that works and picks its cases, and one that cannot be imported."""
    info = tmp_path / "borrowed_solvers-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: borrowed-solvers\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[rocking.solvers]\nborrowed = borrowed_solvers:Borrowed\nbroken = borrowed_solvers_missing:Broken\n"
    )
    (tmp_path / "borrowed_solvers.py").write_text(
        "from rocking.solvers.scipy_events import ScipyEvents\n"
        "class Borrowed(ScipyEvents):\n"
        "    name = 'borrowed'\n"
        "    def declines(self, system, motion):\n"
        "        return 'Method 1 alone is carried' if system.name != 'method1' else None\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_a_solver_of_another_package_is_found_and_used(other_package: Path) -> None:
    assert "borrowed" in available()
    system = Method1(Block(b=0.2, h=0.8), g=G)
    run = solve(system, theta=0.1, t_end=1.0, solver="borrowed")
    assert run.solver == "borrowed"
    np.testing.assert_array_equal(run.impact_times, solve(system, theta=0.1, t_end=1.0, solver="scipy").impact_times)


def test_a_solver_that_declines_says_why(other_package: Path) -> None:
    with pytest.raises(ValueError, match=r"solver='borrowed' declines: Method 1 alone is carried"):
        solve(Method2(Block(b=0.2, h=0.8), friction=0.5), t_end=1.0, solver="borrowed")


def test_a_broken_plugin_is_named_and_leaves_the_others_alone(other_package: Path) -> None:
    system = Method1(Block(b=0.2, h=0.8), g=G)
    with pytest.raises(ImportError, match=r"'broken' \(borrowed_solvers_missing:Broken\).*borrowed_solvers_missing"):
        solve(system, theta=0.1, t_end=1.0, solver="broken")
    assert solve(system, theta=0.1, t_end=1.0, solver="scipy").outcome is Outcome.MOVING


@pytest.mark.parametrize("name", seldom(available()))
def test_too_many_events_end_a_run_as_failed_with_the_reason(name: str) -> None:
    system = Method1(Block(b=0.2, h=0.8), form="linear", g=G)
    run = solve(system, theta=0.2, t_end=5.0, max_events=3, solver=name)
    assert run.outcome is Outcome.FAILED
    assert "max_events=3" in run.reason
    assert np.sum(run.events.guard != BALANCE) <= 4


# Three impacts in two seconds.
@pytest.mark.parametrize("name", seldom(available()))
def test_as_many_events_as_are_allowed_are_not_too_many(name: str) -> None:
    system = Method1(Block(b=0.2, h=0.8), form="linear", g=G)
    runs = [solve(system, theta=0.2, t_end=2.0, max_events=most, solver=name) for most in (2, 3)]
    assert [run.outcome for run in runs] == [Outcome.FAILED, Outcome.MOVING]
    assert len(runs[1].events.guard) == 3


# Sampled motions forgive a time a billionth of a step where they begin and end: a solver that comes that near to an
# edge sees what lies behind it.  The base jumps to 5 m/s^2, the block stands 2.45 m/s^2.
@pytest.mark.parametrize("name", seldom(available()))
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
@pytest.mark.parametrize("kind", [PiecewiseLinear, SampledMotion])
@pytest.mark.parametrize(("start", "t_start"), [(0.3, 0.0), (0.0, 0.0), (0.0, -0.5)])
def test_rocking_begins_at_the_very_jump_that_a_record_begins_with(
    name: str, form: Any, kind: Any, start: float, t_start: float
) -> None:
    system, motion = Method1(Block(0.2, 0.8), form=form, g=G), kind(0.25, [5.0, 5.0, -5.0, 2.0], start=start)
    skip_if_declined(name, system, motion)
    run = solve(system, motion, t_start=t_start, t_end=start + 0.2, solver=name, save_at=())
    np.testing.assert_array_equal(run.events.t, [start])
    np.testing.assert_array_equal(run.times_of("tip"), [start])
    np.testing.assert_array_equal(run.events.s_after, [-1.0])


@pytest.mark.parametrize("name", seldom(available()))
def test_a_record_that_ends_with_a_jump_pushes_to_its_end_and_no_longer(name: str) -> None:
    system, motion = Method1(Block(0.2, 0.8), g=G), PiecewiseLinear(0.25, [0.0, 0.0, 2.4], start=0.1)
    skip_if_declined(name, system, motion)
    assert solve(system, motion, t_end=1.0, solver=name, save_at=()).outcome is Outcome.AT_REST
    # Released, the block swings on through the end of the push: to the same end as by the reference.
    runs = [solve(system, motion, theta=0.1, t_end=1.0, solver=n, rtol=1e-12, atol=1e-15) for n in ("scipy", name)]
    must_agree(*runs)


def sizes_at_the_threshold() -> Iterator[tuple[str, Any, float]]:
    """Blocks of several b/h, each with the push that just does not end its rest."""
    for b, h in ((0.2, 0.8), (0.13, 0.37), (0.17, 0.61)):
        block, mu = Block(b, h), 0.6 * b / h
        yield f"tips {b} {h}", Method1(block), b / h * G_STANDARD
        yield f"tips linear {b} {h}", Method1(block, form="linear", onset="linear"), block.alpha * G_STANDARD
        yield f"tips or slides {b} {h}", Method2(block, friction=0.7), b / h * G_STANDARD
        yield f"slips {b} {h}", Method2(block, friction=mu, kinetic_friction=0.8 * mu), mu * G_STANDARD
        moment = 0.1  # [N m], besides that of the weight
        push = (0.5 * b * G_STANDARD + moment / block.mass) / (0.5 * h)
        yield f"adheres {b} {h}", compose(Method1(block), [BaseAdhesion(moment)]), push


THRESHOLDS = list(sizes_at_the_threshold())


# Equality is rest: the block needs more than West's (b/h) g, or mu g, to leave it.  A product is rounded by one solver
# and fused with the sum behind it by another, which decided between rest and a start that never got on.
@pytest.mark.parametrize("name", seldom(available()))
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("system", "push"), [case[1:] for case in THRESHOLDS], ids=[case[0] for case in THRESHOLDS])
def test_a_push_exactly_at_the_threshold_leaves_the_block_at_rest(
    name: str, sign: float, system: Any, push: float
) -> None:
    at, beyond = RectangularPulse(sign * push, 0.5), RectangularPulse(sign * push * (1.0 + 1e-12), 0.5)
    skip_if_declined(name, system, at)
    run = solve(system, at, t_end=1.0, solver=name)
    assert run.outcome is Outcome.AT_REST
    assert math.isnan(run.onset_time) and len(run.events) == 0
    assert solve(system, beyond, t_end=0.2, solver=name).onset_time == 0.0


@pytest.mark.parametrize("name", seldom(available()))
def test_arrays_that_may_only_be_read_serve_as_well(window: Any, name: str) -> None:
    system, times = Method1(Block(0.2, 0.8), form="linear", g=G), np.linspace(0.0, 1.0, 11)
    shaken, record = window(x=(0.0, 3.0, 15.0, 0.3)), np.array([0.0, 1.0, 2.0, 3.0, 0.0])
    for motion in (shaken, PiecewiseLinear(0.1, record)):
        if load(name).declines(system, motion) is not None:
            continue
        expected = solve(system, motion, theta=0.1, t_end=1.0, save_at=times, solver=name)
        for array in (times, motion.parameters, record):
            array.setflags(write=False)
        run = solve(system, motion, theta=0.1, t_end=1.0, save_at=times, solver=name)
        np.testing.assert_array_equal(run.y, expected.y)
        times = times.copy()
