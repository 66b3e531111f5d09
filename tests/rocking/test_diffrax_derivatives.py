"""Forward derivatives through the impacts against differences of the scipy solver; batches against single runs."""

import copy
import doctest
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, solve
from rocking.hybrid import Discrete

jax = pytest.importorskip("jax")

from rocking.solvers.diffrax import parameters as diffrax_parameters  # noqa: E402
from rocking.solvers.diffrax import response as diffrax_response  # noqa: E402
from rocking.solvers.diffrax.parameters import parameters_for  # noqa: E402
from rocking.solvers.diffrax.response import batch, response, sensitivity  # noqa: E402

G = 9.81
AT = 1.6  # [s]: after four impacts and more of the runs below
SHARP: dict[str, Any] = {"rtol": 1e-12, "atol": 1e-15}
SYSTEM = Method1(Block(b=0.2, h=0.8), restitution=0.9, g=G)
MOTION = RampedSinusoid(frequency=1.5, duration=10.0, final_amplitude=10.0)
SLIDING = Method2(Block(b=0.2, h=0.8), friction=0.16, g=G)


def with_parameters(system: Any, parameters: Any) -> Any:
    """The system, run with these parameters."""
    clone = copy.copy(system)
    vars(clone)["parameters"] = parameters
    return clone


def difference(f: Callable[[float], Any], x: float, h: float) -> Any:
    """Derivative by central differences with one extrapolation: error of order h^4, and 1e-12 / h of the runs."""

    def central(h: float) -> Any:
        return (f(x + h) - f(x - h)) / (2.0 * h)

    return (4.0 * central(0.5 * h) - central(h)) / 3.0


def shaken(x: dict[str, Any], **options: Any) -> Any:
    """A block released and shaken, as a function of sizes, coefficients and the rate of the shaking."""
    par = parameters_for(SYSTEM, b=x["b"], g=x["g"], restitution=x["e"])
    par = par._replace(p2=par.p2 * x["p2"], alpha=par.alpha * x["alpha"])
    array = jax.numpy.asarray(MOTION.parameters).at[2].set(x["rate"]).at[3].set(x["duration"])
    edges = jax.numpy.stack([0.0 * x["duration"], x["duration"]])
    return response(
        SYSTEM, MOTION, parameters=par, motion_parameters=array, breakpoints=edges, theta=0.04, t_end=x["t_end"],
        keep_impacts=3, save_at=[AT], rtol=1e-11, atol=1e-14,
    )  # fmt: skip


NUMBERS = {"b": 0.2, "g": G, "e": 0.9, "p2": 1.0, "alpha": 1.0, "rate": 2.0, "duration": 1.5}  # it ends before AT


def shaken_by_scipy(t_end: float, **x: float) -> Any:
    """The same run by the reference."""
    v = NUMBERS | x
    system = replace(SYSTEM, block=Block(b=v["b"], h=0.8), g=v["g"], restitution=v["e"])
    par = system.parameters
    system = with_parameters(system, par._replace(p2=par.p2 * v["p2"], alpha=par.alpha * v["alpha"]))
    motion = replace(MOTION, duration=v["duration"], final_amplitude=v["rate"] * v["duration"])
    return solve(system, motion, theta=0.04, t_end=t_end, save_at=[AT], solver="scipy", **SHARP)


@pytest.fixture(scope="module")
def slopes() -> Any:
    """(value, slope) of the run of `shaken` up to 1.8 s."""
    return sensitivity(lambda x: shaken({**x, "t_end": 1.8}), NUMBERS)


# Differences of runs of accuracy 1e-12 over steps of 2e-4 are good to some 1e-8 of the derivative.
@pytest.mark.parametrize("name", NUMBERS)
def test_derivatives_through_four_impacts_are_differences_of_the_reference(slopes: Any, name: str) -> None:
    value, slope = slopes
    assert value.impacts >= 4
    assert value.impact_times[2] < AT

    def reference(x: float) -> Any:
        run = shaken_by_scipy(1.8, **{name: x})
        return np.array([*run.impact_times[:3], run.peak_rotation, *run.y[0]])

    expected = difference(reference, NUMBERS[name], 2e-4 * NUMBERS[name])
    found = [*slope.impact_times[name], slope.peak_rotation[name], *slope.y[name][0]]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7)


def test_the_peak_lies_within_the_run_and_the_margin_is_what_is_left_to_theta_c(slopes: Any) -> None:
    value, slope = slopes
    alpha = SYSTEM.block.alpha
    assert 4.0 * 0.04 < value.peak_rotation < alpha  # released at 0.04
    assert value.margin == pytest.approx(alpha - value.peak_rotation, rel=1e-14)
    assert slope.margin["alpha"] == pytest.approx(alpha - slope.peak_rotation["alpha"], rel=1e-12)
    assert slope.margin["rate"] == pytest.approx(-slope.peak_rotation["rate"], rel=1e-12)
    assert slope.overturned is None


def test_the_overturning_time_moves_with_the_shaking_as_in_the_reference() -> None:
    value, slope = sensitivity(lambda x: shaken({**x, "t_end": 8.0}), NUMBERS | {"rate": 4.0, "duration": 10.0})
    assert value.overturned
    assert value.peak_rotation == pytest.approx(0.5 * math.pi, abs=1e-9)
    expected = difference(lambda x: shaken_by_scipy(8.0, rate=x, duration=10.0).overturning_time, 4.0, 1e-5)
    # A passage of the balance is slow and hangs on all that came before: steps of 1e-5 leave 1e-6.
    assert slope.overturning_time["rate"] == pytest.approx(expected, rel=1e-5)


@pytest.mark.slow
def test_derivatives_with_friction_are_those_of_the_reference_while_the_block_slides() -> None:
    def run(x: dict[str, Any]) -> Any:
        par = parameters_for(SLIDING, friction=x["friction"])
        return response(
            SLIDING, parameters=par, theta=0.2, t_end=2.0, keep_impacts=3, save_at=[1.3], rtol=1e-11, atol=1e-14
        )

    def reference(friction: float) -> Any:
        system = replace(SLIDING, friction=friction)
        run = solve(system, theta=0.2, t_end=2.0, save_at=[1.3], solver="scipy", **SHARP)
        assert Mode.SLIDE_ROTATION in run.events.mode_after
        return np.array([*run.impact_times[:3], *run.y[0]])

    _, slope = sensitivity(run, {"friction": 0.16})
    expected = difference(reference, 0.16, 2e-5)
    assert np.abs(expected[2]) > 1e-3
    found = [*slope.impact_times["friction"], *slope.y["friction"][0]]
    # Steps of 2e-5 in differences of runs of accuracy 1e-12: 1e-7.
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


@pytest.fixture(scope="module")
def amplitudes() -> Any:
    """Ten ramps (rows of motion parameters) of which some overturn the block, and the batch of their runs."""
    array = np.tile(MOTION.parameters, (10, 1))
    array[:, 2] = np.linspace(0.2, 4.0, 10)
    return array, batch(SYSTEM, MOTION, motion_parameters=array, t_end=5.0, keep_impacts=4, rtol=1e-11, atol=1e-14)


@pytest.mark.slow
def test_a_batch_is_its_members(amplitudes: Any) -> None:
    array, many = amplitudes
    assert 0 < many.overturned.sum() < 10
    assert many.impact_times.shape == (10, 4)
    for i, row in enumerate(array):
        one = response(SYSTEM, MOTION, motion_parameters=row, t_end=5.0, keep_impacts=4, rtol=1e-11, atol=1e-14)
        assert (many.status[i], many.impacts[i]) == (one.status, one.impacts)
        for name in ("peak_rotation", "margin", "onset_time", "overturning_time", "t_end"):
            # Vectorised arithmetic rounds otherwise, and a few impacts magnify that.
            np.testing.assert_allclose(getattr(many, name)[i], getattr(one, name), rtol=1e-8, err_msg=name)


def test_a_batch_tells_what_scipy_tells(amplitudes: Any) -> None:
    array, many = amplitudes
    for i in (0, 4, 9):
        motion = replace(MOTION, final_amplitude=float(10.0 * array[i, 2]))
        run = solve(SYSTEM, motion, t_end=5.0, solver="scipy", **SHARP)
        assert many.overturned[i] == run.overturned
        assert many.impacts[i] == len(run.impact_times)
        np.testing.assert_allclose(many.peak_rotation[i], run.peak_rotation, rtol=1e-7)
        np.testing.assert_allclose(many.overturning_time[i], run.overturning_time, rtol=0.0, atol=1e-8)
        np.testing.assert_allclose(many.onset_time[i], run.onset_time, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("system", "changes"),
    [
        (Method1(Block(0.2, 0.8)), {"b": 0.3, "h": 0.7, "g": 9.0}),
        (Method1(Block(0.2, 0.8), form="linear", onset="linear"), {"restitution": 0.8, "rest_speed": 1e-5}),
        (Method2(Block(0.2, 0.8), 0.5), {"friction": 0.6, "normal_restitution": 0.2}),
        (Method2(Block(0.2, 0.8), 0.5, 0.4, impact_law="two_corner", restitution=0.95), {"restitution": 0.97}),
        # b/h above sqrt(2): Housner's 1 - 1.5 sin^2(alpha) would be -0.2, and the block lands on both corners.
        (Method1(Block(2.0, 1.0)), {}),
        (Method1(Block(0.5, 1.0)), {"b": 2.0}),
        (Method2(Block(0.5, 1.0), 0.5), {"b": 2.0}),
    ],
)
def test_traced_parameters_are_those_of_the_system(system: Any, changes: dict[str, float]) -> None:
    sizes = {name: changes[name] for name in ("b", "h") if name in changes}
    others = {name: value for name, value in changes.items() if name not in sizes}
    expected = replace(system, block=replace(system.block, **sizes), **others).parameters
    np.testing.assert_allclose(parameters_for(system, **changes), expected, rtol=1e-14)
    np.testing.assert_allclose(parameters_for(system), system.parameters, rtol=1e-14)


# At pi/2 the block lies on its side: what `solve` refuses is refused here, unless it is traced and has no value yet.
@pytest.mark.slow
def test_a_block_that_has_fallen_is_no_start() -> None:
    fallen, q = np.array([[0.1, 0.0], [2.0, 0.0]]), Discrete(Mode.ROTATION, 1.0, 1.0)
    for run in (response, batch):
        with pytest.raises(ValueError, match=r"theta=2\.0 rad: want between -pi/2 and pi/2"):
            run(SYSTEM, theta=2.0, t_end=1.0)
        with pytest.raises(ValueError, match="omega=nan"):
            run(SYSTEM, omega=math.nan, t_end=1.0)
    with pytest.raises(ValueError, match=r"initial: theta=-2\.0 rad: want between -pi/2 and pi/2"):
        response(SYSTEM, initial=((-2.0, 0.0), q), t_end=1.0)
    with pytest.raises(ValueError, match=r"initial: theta=2\.0 rad"):
        batch(SYSTEM, initial=(fallen, q), t_end=1.0)
    with pytest.raises(ValueError, match="initial: 3 numbers, want theta, omega of method1"):
        response(SYSTEM, initial=((0.1, 0.0, 0.0), q), t_end=1.0)
    _, slope = sensitivity(lambda x: response(SYSTEM, initial=((x, 0.0), q), t_end=0.1).theta_end, 0.1)
    assert np.isfinite(slope)


def test_wrong_arguments_are_answered_in_a_sentence() -> None:
    with pytest.raises(ValueError, match="mass: want one of b, h"):
        parameters_for(SYSTEM, mass=1.0)
    with pytest.raises(ValueError, match="want a Method1 or a Method2"):
        parameters_for("block")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="want one length"):
        batch(SYSTEM, t_end=1.0)
    with pytest.raises(ValueError, match="want a time after"):
        response(SYSTEM, t_end=0.0)
    with pytest.raises(ValueError, match="save_at: want ascending times"):
        response(SYSTEM, t_end=1.0, save_at=[2.0])
    with pytest.raises(ValueError, match="keep_impacts=-1"):
        response(SYSTEM, t_end=1.0, keep_impacts=-1)


def test_a_traced_argument_of_32_bits_is_refused() -> None:
    def third_impact(e: Any) -> Any:
        return response(SYSTEM, parameters=SYSTEM.parameters._replace(e=e), theta=0.1, t_end=2.0).impact_times[2]

    with pytest.raises(ValueError, match="enable_x64"):
        jax.jacfwd(third_impact)(0.9)


@pytest.mark.slow
@pytest.mark.parametrize("module", [diffrax_response, diffrax_parameters])
def test_the_examples_run(module: Any) -> None:
    tried = doctest.testmod(module)
    assert tried.attempted > 0
    assert tried.failed == 0
