"""How a run ends, when the balance was passed, time in modes, and the labelled dataset."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import dem
from dem import Mode, Outcome

G = 9.80665


def pushed(t):
    """Half a sine that throws Block 3 over to -x."""
    return np.where(t < 0.25, 8.0 * np.sin(math.pi * t / 0.25), 0.0), np.zeros_like(t)


def topple(block, **kw):
    return dem.simulate(block(3), pushed, **{"t_end": 3.0, "dt": 1e-5, "mu": 1.0, "damping_ratio": 0.3, **kw})


def test_positive_base_acceleration_throws_the_block_to_minus_x(block):
    history = topple(block)
    assert (history.outcome, history.side) == (Outcome.OVERTURNED, -1)
    assert history.theta[-1] <= -math.pi / 2.0 < history.theta[-2]
    assert history.time[-1] == history.end_time


def test_overturning_time_is_the_last_outward_passage_of_the_balance(block):
    history = topple(block, save_every=1)
    theta_c = history.scene.shape.theta_c[1]
    last_inside = np.flatnonzero(-history.theta < theta_c)[-1]
    pair = slice(last_inside, last_inside + 2)
    passage = np.interp(theta_c, -history.theta[pair], history.time[pair])
    assert history.overturning_time == pytest.approx(passage, abs=1e-12)  # rounding of t = step x dt


def test_earlier_passages_that_come_back_are_forgotten(block):
    # Just over the balance and held back by a base that then pulls the other way.
    def motion(t):
        return np.where((t > 0.02) & (t < 0.5), -6.0, np.where(t > 1.0, 8.0, 0.0)), np.zeros_like(t)

    history = dem.simulate(block(3), motion, t_end=4.0, dt=1e-5, mu=1.5, damping_ratio=0.3, theta0=-0.285, omega0=-1.0)
    passed = np.flatnonzero((np.abs(history.theta[1:]) >= 0.2914568) & (np.abs(history.theta[:-1]) < 0.2914568))
    assert len(passed) > 1
    assert history.outcome is Outcome.OVERTURNED
    assert history.time[passed[-1]] <= history.overturning_time <= history.time[passed[-1] + 1]


def test_times_in_modes_add_up_to_the_end_and_to_the_overturning(block):
    history = topple(block)
    # Sums of 1e5 steps.
    assert history.mode_seconds.sum() == pytest.approx(history.end_time, rel=1e-10)
    assert history.mode_seconds_to_overturning.sum() == pytest.approx(history.overturning_time, rel=1e-10)
    assert np.all(history.mode_seconds_to_overturning <= history.mode_seconds)


def test_a_block_let_go_beyond_its_balance_overturns_at_once(block):
    history = dem.simulate(block(3), t_end=3.0, dt=1e-5, mu=1.0, damping_ratio=0.3, theta0=0.35)
    assert (history.outcome, history.side, history.overturning_time) == (Outcome.OVERTURNED, 1, 0.0)
    assert np.array_equal(history.mode_seconds_to_overturning, np.zeros(6))


def test_a_body_that_comes_to_lie_on_a_leaning_side_has_overturned():
    # Wider above: the right side leans out by atan(1/3) and lies flat at pi/2 - atan(1/3) < pi/2.
    scene = dem.single_polygon([[-0.1, 0.0], [0.1, 0.0], [0.2, 0.3], [-0.2, 0.3]], 0.2, 600.0)
    history = dem.simulate(scene, t_end=3.0, dt=1e-5, mu=1.0, damping_ratio=0.5, theta0=0.7, save_every=100)
    assert history.theta[-1] == pytest.approx(math.pi / 2.0 - math.atan(1.0 / 3.0), abs=1e-4)  # m g/kn in the springs
    assert (history.outcome, history.side) == (Outcome.OVERTURNED, 1)


@pytest.mark.parametrize(
    ("mode", "seconds", "arguments"),
    [
        (Mode.REST, 0.2, {}),
        (Mode.SLIDE, 0.2, {"vx0": 1.0, "mu": 0.2}),
        (Mode.ROTATION, 0.2, {"theta0": 0.2, "mu": 1.0}),
        (Mode.SLIDE_ROTATION, 0.2, {"theta0": 0.25, "mu": 0.02}),
        (Mode.TRANSLATION_JUMP, math.sqrt(2.0 * 0.1 / G), {"gap0": 0.1, "t_end": 0.144}),
        (Mode.ROTATION_JUMP, 0.2, {"gap0": 0.5, "omega0": 0.5}),
    ],
)
def test_each_mode_is_recognised(block, mode, seconds, arguments):
    history = dem.simulate(block(3), dt=1e-5, **{"t_end": 0.2, "mu": 0.5, "damping_ratio": 0.3, **arguments})
    # A corner set down or a slide set off by hand may take up to 2 ms to settle into its mode.
    assert history.mode_seconds[mode] == pytest.approx(seconds, abs=2e-3)


@pytest.mark.parametrize(
    ("arguments", "outcome"),
    [({}, Outcome.AT_REST), ({"theta0": 0.2}, Outcome.MOVING), ({"gap0": 0.5}, Outcome.MOVING)],
)
def test_a_block_that_stands_tells_whether_it_moves(block, arguments, outcome):
    history = dem.simulate(block(3), t_end=0.1, dt=1e-5, mu=0.5, damping_ratio=0.1, **arguments)
    assert (history.outcome, history.side) == (outcome, 0)
    assert math.isnan(history.overturning_time)
    assert np.isnan(history.mode_seconds_to_overturning).all()


def test_samples_do_not_depend_on_how_often_they_are_kept_and_end_with_the_last_state(block):
    every, seldom = (topple(block, save_every=n, t_end=0.5) for n in (1, 70))
    assert np.array_equal(seldom.theta[:-1], every.theta[::70][: len(seldom.theta) - 1])
    assert (seldom.theta[-1], seldom.time[-1]) == (every.theta[-1], every.time[-1])


def test_progress_hears_of_each_chunk_and_an_interrupt_goes_through(block):
    heard = []
    dem.simulate(block(3), t_end=1.2, dt=1e-5, mu=1.0, damping_ratio=0.3, progress=heard.append)
    assert heard == pytest.approx([0.5, 1.0, 1.2], abs=1e-9)  # 50,000 steps each

    def stop(t):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        topple(block, progress=stop)


def test_chunks_leave_no_trace(block, monkeypatch):
    import sys

    whole = topple(block)
    monkeypatch.setattr(sys.modules["dem.simulate"], "CHUNK", 997)
    assert np.array_equal(topple(block).theta, whole.theta)


def test_runs_side_by_side_in_threads_give_the_same_bits(block):
    alone = topple(block)
    with ThreadPoolExecutor(2) as pool:
        together = [future.result() for future in [pool.submit(topple, block) for _ in range(4)]]
    assert all(np.array_equal(other.theta, alone.theta) for other in together)


def test_dataset_has_units_and_says_how_it_ended(block):
    history = topple(block)
    ds = history.to_xarray()
    assert set(ds.dims) == {"time", "mode", "corner"}
    assert ds.theta.units == "rad" and ds.energy_kinetic.units == "J" and ds.mode_seconds.units == "s"
    assert all("long_name" in ds[name].attrs for name in ds.variables)
    assert ds.attrs["outcome"] == "OVERTURNED" and ds.attrs["side"] == -1 and ds.attrs["kn"] == 1.98e7
    assert np.array_equal(ds.theta, history.theta)
    assert float(ds.mode_seconds.sel(mode="REST")) == history.mode_seconds[Mode.REST]


def test_repr_is_a_sentence(block):
    assert "fell on its side" in repr(topple(block)) and "side -1" in repr(topple(block))
