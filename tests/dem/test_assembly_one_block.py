"""The engine for assemblies on one block: against the engine for one body, exact bounces, and rigid rocking."""

import math

import numpy as np
import pytest

import dem
from rocking import Block, Method1, solve

G = 9.80665
KN = 1.98e7
B, H, D, DENSITY = 0.15, 0.50, 0.25, 597.0


def shaken(amplitude, frequency, vertical=0.0):
    def motion(t):
        wave = np.sin(2.0 * math.pi * frequency * t)
        return amplitude * wave, vertical * wave

    return motion


def pressed_in(corners=2):
    """Block 3 as the engine for one body sets it down: pressed in by its weight."""
    shape = dem.rectangle(B, H)
    mass = DENSITY * D * shape.area
    return dem.Body(shape, 0.0, H / 2.0 - mass * G / (corners * KN), D, DENSITY)


class Scene(dem.Assembly):
    """An assembly whose bodies may start inside the floor, as those of the engine for one body do."""

    def __post_init__(self):
        pass


@pytest.mark.parametrize("coulomb", ["total", "spring"])
@pytest.mark.parametrize("onset", ["overlap", "incremental"])
@pytest.mark.parametrize(
    ("motion", "mu", "xi"),
    [(shaken(4.0, 2.0, 3.0), 1.0, 0.05), (shaken(5.0, 3.0), 0.2, 0.3), (shaken(9.0, 4.0), 0.5, 0.1)],
)
def test_one_block_moves_as_in_the_engine_for_one_body(onset, coulomb, motion, mu, xi):
    one = dem.simulate(
        dem.single_block(B, H, D, DENSITY), motion, t_end=0.6, dt=1e-5, mu=mu, damping_ratio=xi, onset=onset,
        coulomb=coulomb, save_every=100,
    )  # fmt: skip
    many = dem.simulate_assembly(
        Scene((pressed_in(),), standing=False), motion, t_end=0.6, dt=1e-5, contact=dem.Contact(mu, damping_ratio=xi),
        onset=onset, coulomb=coulomb, save_every=100, criteria=dem.Criteria(stop="never"),
    )  # fmt: skip
    count = min(one.time.size, many.time.size)
    # The two add up the same terms in another order: 1e-16 a step of kn times the position, grown by the impacts.
    assert many.theta[:count, 0] == pytest.approx(one.theta[:count], abs=1e-7)
    assert many.x[:count, 0] == pytest.approx(one.x[:count], abs=1e-7)
    for name in ("dashpot", "friction", "onset", "base_work", "elastic"):
        ours, theirs = getattr(many.energies, name)[:count], getattr(one.energies, name)[:count]
        assert ours == pytest.approx(theirs, abs=1e-6 * (1.0 + np.abs(theirs).max())), name


def exact_height(t, om, height):
    """Height of the corners of a block dropped on springs without loss: parabola and spring in turn."""
    v = math.sqrt(2.0 * G * height)
    fall, touch = v / G, (2.0 / om) * (math.pi - math.atan(om * v / G))
    t = np.mod(t + fall, 2.0 * fall + touch)
    s = t - 2.0 * fall
    floor = -(v / om) * np.sin(om * s) - (G / om**2) * (1.0 - np.cos(om * s))
    return np.where(s < 0.0, v * t - 0.5 * G * t**2, floor)


def eq_8(dt, onset, height):
    """Eq. (8) of Winkler, Meguro & Yamazaki (1995): Block 4 dropped on springs whose sum is kn, 2,000 samples over 2
    s."""
    scene = dem.Assembly((dem.block(0.075, 0.25, 0.125, DENSITY, z=height),), standing=False)
    run = dem.simulate_assembly(
        scene, t_end=2.0, dt=dt, contact=dem.Contact(0.5, damping=0.0, kn=KN / 2, ks=KN / 2), onset=onset,
        save_every=round(1e-3 / dt),
    )  # fmt: skip
    exact = exact_height(run.time[:2001], math.sqrt(KN / scene.mass), height)
    return float(((run.z[:2001, 0] - 0.125 - exact) ** 2).sum())


def test_located_onset_is_as_accurate_at_twenty_times_the_papers_step():
    # The paper's step is 2e-6 s, with forces that grow from the step that finds the contact. Eq. (8) hangs on where in
    # a step the 21 landings fall, so heights within 1 cm +- 5 % are compared, by median and by the worst.
    heights = np.linspace(0.0095, 0.0105, 7)
    papers = [eq_8(2e-6, "incremental", height) for height in heights]
    ours = [eq_8(4e-5, "located", height) for height in heights]
    print(f"2e-6 s incremental: median {np.median(papers):.2g}, worst {max(papers):.2g}")
    print(f"4e-5 s located: median {np.median(ours):.2g}, worst {max(ours):.2g}")
    assert np.median(ours) < np.median(papers)
    assert max(ours) < 1.5 * max(papers)


def test_located_onset_conserves_energy_to_a_higher_order():
    def shift(dt, onset):
        heights = np.linspace(0.0095, 0.0105, 7)
        contact = dem.Contact(0.5, damping=0.0)
        runs = [
            dem.simulate_assembly(
                dem.Assembly((dem.block(0.075, 0.25, 0.125, DENSITY, z=height),), standing=False),
                t_end=0.2, dt=dt, contact=contact, onset=onset,
            )
            for height in heights
        ]  # fmt: skip
        return math.sqrt(np.mean([run.energies.onset[-1] ** 2 for run in runs]))

    orders = {
        onset: math.log(shift(4e-5, onset) / shift(5e-6, onset)) / math.log(8.0) for onset in ("overlap", "located")
    }
    print(orders)
    # A force of kn v dt misplaced by v dt is of second order; with its work right, what is left is of fourth.
    assert 1.5 < orders["overlap"] < 2.5
    assert orders["located"] > 3.3


def test_free_rocking_tends_to_nonlinear_method_1_as_stiffness_grows():
    # Impact times of the rigid block with Housner's ratio, from another package with located events.
    theta0, e = 0.12, 1.0 - 1.5 * math.sin(math.atan(B / H)) ** 2
    rigid = solve(Method1(Block(b=B, h=H), restitution=e, g=G), t_end=1.4, theta=theta0)
    errors = []
    for stiffer in (0.1, 1.0, 10.0, 100.0):
        block = dem.block(B, H, D, DENSITY, tilt=theta0)
        contact = dem.Contact(math.inf, damping_ratio=3.0, kn=stiffer * KN, ks=stiffer * KN)
        run = dem.simulate_assembly(
            dem.Assembly((block,), standing=False), t_end=1.4, contact=contact, dt=1e-5 / math.sqrt(10.0 * stiffer),
            save_every=20,
        )  # fmt: skip
        theta, time = run.theta[:, 0] + theta0, run.time
        at = np.flatnonzero(theta[1:] * theta[:-1] < 0.0)
        times = time[at] + theta[at] / (theta[at] - theta[at + 1]) * (time[at + 1] - time[at])
        errors.append(np.abs(times[:4] - rigid.impact_times[:4]).max())
    print("errors of the first four impact times [s]:", *(f"{error:.1e}" for error in errors))
    # The overlap under the weight is a tilt of m g/(kn b): the error goes with 1/kn.
    assert np.all(np.diff(errors) < 0.0)
    assert errors[-1] < 1e-4
