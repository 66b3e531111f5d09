"""Runs of assemblies: what stands, falls, opens, is kept, stops early, and is refused."""

import importlib
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import dem
from dem import arrays as q
from dem.assembly_stability import all_touches

G = 9.80665
B, H, D, DENSITY = 0.15, 0.50, 0.25, 597.0
STEADY = dem.Contact(0.8, damping_ratio=0.1)
simulate_module = importlib.import_module("dem.simulate_assembly")
run_module = importlib.import_module("dem.assembly_run")


def growing(frequency, rate=0.1 * G):
    def motion(t):
        return rate * t * np.sin(2.0 * math.pi * frequency * t), np.zeros_like(t)

    return motion


def column(count=2, **kw):
    return dem.column(count, B, H, D, DENSITY, **kw)


SCENES = {
    "single": dem.single(B, H, D, DENSITY),
    "two": column(2),
    "three": column(3),
    "by a wall": column(2, wall_gap=0.0),
    "shelf": dem.bookshelf(),
    "masonry": dem.running_bond(6, 4),
    "arch": dem.arch(11, 0.15),
    "flat arch": dem.arch(9, 0.2, embrace=2.0),
    "drums": dem.drum_column(5),
    "stones": dem.rubble(5),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_standing_scene_stays_where_it_settled(name):
    run = dem.simulate_assembly(SCENES[name], t_end=1.0, contact=STEADY)
    assert run.ending is dem.Ending.REACHED_END
    # Settled to 1e-8 of gravity; what is left moves bodies by less than the springs give under it, m g/kn of 1e-4 m.
    for quantity in (run.x, run.z):
        assert np.ptp(quantity, axis=0).max() < 1e-11
    assert not run.falls
    assert all(math.isnan(separation.time) for separation in run.separations)


@pytest.mark.parametrize("b", [0.8, 1.3])
def test_the_boards_of_a_shelf_leave_the_clear_breadth_between_them(b):
    left, right, bottom, top = dem.bookshelf(6, b=b, h=0.35, board=0.02).bodies[:4]
    assert [right.x - left.x, top.z - bottom.z] == pytest.approx([b + 0.02, 0.35 + 0.02])
    assert [left.x + right.x, bottom.x, top.x] == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize("joint", [0.0, 0.01])
def test_joints_of_masonry_are_as_wide_as_given_and_half_a_joint_is_left_at_either_end(joint):
    wall = dem.running_bond(2, 3, b=0.2, h=0.1, joint=joint)
    for level, widths in ((0.05, [0.2, 0.2, 0.2]), (0.15, [0.1, 0.2, 0.2, 0.1])):
        course = [body for body in wall.bodies if body.z == pytest.approx(level)]
        corners = np.array([body.x + body.shape.corners[:, 0] for body in course])
        edges = np.concatenate([[0.0], np.cumsum(widths)])
        assert corners.min(axis=1) == pytest.approx(edges[:-1] + 0.5 * joint)
        assert corners.max(axis=1) == pytest.approx(edges[1:] - 0.5 * joint)


def test_a_column_stays_still_for_a_minute_without_creep():
    run = dem.simulate_assembly(column(3), t_end=60.0, contact=STEADY, keep=["upper block"])
    # A million steps; positions of 1 m are known to 1e-16 m.
    for quantity in (run.x, run.z, run.theta):
        assert np.ptp(quantity) < 1e-14


# Milankovitch's least thickness of a semicircular arch: t/R = 0.1075, R of the centre line. Cut into 24 voussoirs,
# whose joints do not lie where the hinges want to be, it may be thinner by about 1 %.
@pytest.mark.parametrize(("thickness", "stands"), [(0.104, False), (0.110, True)])
def test_a_semicircular_arch_stands_from_the_least_thickness_on(thickness, stands):
    rough = dem.Contact(math.inf, damping_ratio=0.5, kn=2e8, ks=2e8)
    run = dem.simulate_assembly(dem.arch(24, thickness), t_end=1.0, contact=rough, settle=False)
    assert (run.ending is dem.Ending.REACHED_END) == stands
    if stands:
        assert np.abs(run.theta).max() < 5e-3  # a mechanism has turned its stones by 0.1 when they come loose


def test_columns_of_two_overturn_as_in_figs_18_and_19():
    def amplitude(frequency, **kw):
        run = dem.simulate_assembly(column(2, **kw), growing(frequency), t_end=40.0, contact=STEADY)
        assert run.ending is dem.Ending.FELL
        return run.overturning_time

    # Winkler, Meguro & Yamazaki (1995): below 2 Hz the free column falls before the one next to a wall, above 2 Hz
    # after.
    assert amplitude(1.0) < amplitude(1.0, wall_gap=0.0)
    assert amplitude(3.0) > amplitude(3.0, wall_gap=0.0)


def test_blocks_part_at_high_frequency_and_hardly_at_low():
    def share(frequency):
        """When they part, as a share of the time until they overturn."""
        run = dem.simulate_assembly(column(2), growing(frequency), t_end=40.0, contact=STEADY)
        (opened,) = (s.time for s in run.separations if (s.first, s.second) == ("lower block", "upper block"))
        return opened / run.overturning_time

    # The same paper: at low frequency the column loses stability as one block; the higher the frequency the longer the
    # two rock as separate blocks before.
    assert math.isnan(share(1.0))
    assert share(4.0) < share(3.0) < 0.8


def test_an_interface_opens_when_its_rotation_passes_the_given_one():
    run = dem.simulate_assembly(
        column(2), growing(3.0), t_end=8.0, contact=STEADY, criteria=dem.Criteria(rotation=0.01, gap=1.0),
        watch_every=1,
        save_every=1,
    )  # fmt: skip
    relative = np.abs(run.theta[:, 1] - run.theta[:, 0])
    (opened,) = (s.time for s in run.separations if s.second == "upper block")
    first = run.time[np.flatnonzero(relative > 0.01)[0]]
    assert opened == pytest.approx(first, abs=1.5 * run.settings["dt"])


@pytest.mark.parametrize(("dt", "steps"), [(2.5e-5, 40), (5e-5, 20)])
def test_interfaces_are_watched_every_thousandth_of_a_second_unless_something_is_said(dt, steps):
    run = dem.simulate_assembly(column(2), t_end=2e-3, contact=STEADY, dt=dt, settle=0.0)
    assert run.settings["watch_every"] == steps


def test_overturning_is_the_last_outward_passage_of_the_balance():
    run = dem.simulate_assembly(dem.single(B, H, D, DENSITY), growing(1.0), t_end=10.0, contact=STEADY, save_every=1)
    tilt = math.atan(B / H)
    last = np.flatnonzero(np.abs(run.theta[:, 0]) < tilt)[-1]
    share = np.interp(tilt, np.abs(run.theta[last : last + 2, 0]), run.time[last : last + 2])
    assert run.overturned == "block"
    assert run.overturning_time == pytest.approx(share, abs=1e-9)


def test_a_block_that_is_pushed_off_falls_without_overturning():
    slippery = dem.Contact(0.01, damping_ratio=0.3)
    scene = dem.Assembly((dem.block(0.3, 0.2, 0.2, 6000.0), dem.block(0.3, 0.1, 0.2, 600.0, z=0.2).moving(vx=1.0)))
    contacts = {("block", "block"): slippery, ("block", "table"): STEADY}
    run = dem.simulate_assembly(scene, t_end=3.0, contact=contacts, criteria=dem.Criteria(stop="never"))
    assert [fall.body for fall in run.falls] == [1]
    assert run.ending is dem.Ending.REACHED_END


def test_a_run_that_waits_for_all_to_fall_names_each():
    run = dem.simulate_assembly(
        column(2), growing(3.0), t_end=40.0, contact=STEADY, criteria=dem.Criteria(stop="all", margin=100.0)
    )
    assert run.ending is dem.Ending.FELL
    assert {fall.body for fall in run.falls} == {0, 1}
    times = [fall.overturning_time for fall in run.falls]
    assert times == sorted(times) and all(fall.overturning_time <= fall.time for fall in run.falls)


def test_what_a_body_does_after_its_fall_does_not_move_its_overturning():
    """Pushed over, past its fall, and back to within its balance."""

    def motion(t):
        return np.where(t < 0.35, -4.5, np.where(t < 1.2, 9.0, 0.0)), np.zeros_like(t)

    stopped, gone_on = (
        dem.simulate_assembly(
            dem.single(B, H, D, DENSITY), motion, t_end=1.0, contact=STEADY,
            criteria=dem.Criteria(stop=stop, tilt=0.32),
        )
        for stop in ("fall", "never")
    )  # fmt: skip
    later = gone_on.time > gone_on.falls[0].time
    assert np.abs(gone_on.theta[later, 0]).min() < math.atan(B / H)  # it did come back
    assert gone_on.falls == stopped.falls
    assert gone_on.overturning_time < gone_on.falls[0].time


@pytest.mark.parametrize(
    "scene", [column(3), column(2, wall_gap=0.0), dem.running_bond(3, 2), dem.arch(7, 0.2), dem.drum_column(3)]
)
def test_interfaces_are_those_that_touch_as_laid_whether_or_not_bodies_settle(scene):
    settled, laid = (
        {(s.first, s.second) for s in dem.simulate_assembly(
            scene, t_end=1e-3, contact=STEADY, settle=settle
        ).separations}
        for settle in (True, False)
    )  # fmt: skip
    # Settling may open a joint, and presses no two bodies together that did not touch before.
    assert settled <= laid
    assert len(laid) >= len(scene.bodies)


@pytest.mark.parametrize("off", [0.05, -0.05])
def test_what_bodies_turn_by_while_they_settle_opens_no_interface(off):
    """A block that stands off the middle of the one below leans on its springs, and the lower one under it.

    Springs of kn at the ends of a breadth w turn by 2 M/(kn w^2): M is W off on the whole base of the lower block, and
    W off/2 on the breadth B - |off| on which the upper one stands, whose middle is at off/2.
    """
    soft = dem.Contact(0.8, damping_ratio=0.1, kn=1e6, ks=1e6)
    lower, upper = dem.block(B, H, D, DENSITY), dem.block(B, H, D, DENSITY, x=off, z=H)
    moment, width, turns = lower.mass * G * off, B - abs(off), 1e-4
    run = dem.simulate_assembly(
        dem.Assembly((lower, upper)), t_end=0.02, contact=soft, criteria=dem.Criteria(rotation=turns)
    )
    leans = np.array([2.0 * moment / (1e6 * B**2), moment / (1e6 * width**2)])
    # The settled tilt, up to 1e-3 rad, moves the weights by some 5e-4 m, a hundredth of `off`.
    assert run.theta[0] == pytest.approx(np.cumsum(leans), rel=0.02)
    assert np.abs(leans).min() > 4.0 * turns
    assert len(run.separations) == 2 and all(math.isnan(separation.time) for separation in run.separations)


def test_an_interface_of_bodies_that_were_not_settled_opens_when_one_flies_off():
    lower, upper = column(2).bodies
    thrown = dem.Assembly((lower, upper.moving(vz=0.5)))
    run = dem.simulate_assembly(thrown, t_end=0.05, contact=STEADY, settle=False, watch_every=1)
    times = {(s.first, s.second): s.time for s in run.separations}
    assert math.isnan(times["lower block", "floor"])
    # The gap of 1 mm at 0.5 m/s; gravity takes 2 % of it.
    assert times["lower block", "upper block"] == pytest.approx(2e-3, rel=0.05)


PEBBLE = dem.block(0.02, 0.02, 0.1, 1000.0)


@pytest.mark.parametrize(
    ("body", "walls", "ending"),
    [
        (PEBBLE, (dem.wall([[-1.0, -31.0], [1.0, -31.0], [1.0, -30.5], [-1.0, -30.5]]),), dem.Ending.REACHED_END),
        (PEBBLE, (), dem.Ending.LEFT),
        (dem.block(0.02, 0.02, 0.1, 1000.0, z=-5.0), (), dem.Ending.LEFT),
    ],
)
def test_a_long_fall_is_no_blow_up(body, walls, ending):
    scene = dem.Assembly((body,), walls, floor=False, standing=False)
    run = dem.simulate_assembly(
        scene, t_end=2.6, dt=1e-5, contact=dem.Contact(0.7, damping_ratio=0.2), criteria=dem.Criteria(stop="never")
    )
    assert run.ending is ending
    falling = run.time < 1.4
    assert run.z[falling, 0] == pytest.approx(body.z - 0.5 * G * run.time[falling] ** 2, abs=1e-6)
    if walls:
        assert run.z[-1, 0] > -30.5


def test_an_edge_is_felt_from_its_reach_on():
    scene = dem.Assembly((dem.block(B, H, D, DENSITY, z=2e-3),), standing=False)
    near, far = (
        dem.simulate_assembly(scene, t_end=1.0, contact=STEADY, judgement=dem.ContactJudgement(reach=reach))
        for reach in (0.0, 1e-3)
    )
    assert far.z[-1, 0] - near.z[-1, 0] == pytest.approx(1e-3, abs=1e-9)


def test_pairs_of_the_grid_are_those_of_comparing_all():
    phase = importlib.import_module("dem.broad_phase")
    random = np.random.default_rng(3)
    low = random.uniform(-2.0, 2.0, (120, 2))
    size = random.uniform(0.01, 0.3, (120, 2)) * np.where(np.arange(120) < 110, 1.0, 8.0)[:, None]  # some large walls
    box = np.concatenate([low, low + size], axis=1)
    heads, entries = np.zeros(257, np.int64), np.zeros((20_000, 3), np.int64)
    found = np.zeros((20_000, 2), np.int64)
    count = phase.near_pairs(box, 120, 110, 0.2, heads, entries, found)
    all_pairs = {
        (a, b)
        for a in range(110)
        for b in range(a + 1, 120)
        if np.all(box[a, :2] <= box[b, 2:]) and np.all(box[b, :2] <= box[a, 2:])
    }
    assert len(all_pairs) > 50
    assert count == len(all_pairs)  # each once
    assert {tuple(pair) for pair in found[:count].tolist()} == all_pairs
    assert phase.near_pairs(box, 120, 110, 0.2, heads, entries, found[:10]) == -1


def test_friction_is_that_of_the_pair_of_materials():
    scene = dem.Assembly(
        (
            dem.block(0.3, 0.1, 0.2, 600.0, material="wood").moving(vx=1.0),
            dem.block(0.3, 0.1, 0.2, 600.0, x=2.0, material="ice").moving(vx=1.0),
        )
    )
    contacts = {
        ("wood", "table"): dem.Contact(0.5, damping_ratio=0.3),
        ("table", "ice"): dem.Contact(0.25, damping_ratio=0.3),
        ("ice", "wood"): STEADY,
    }
    run = dem.simulate_assembly(scene, t_end=1.0, contact=contacts)
    # v^2/(2 mu g); the stop within the shear springs, about mu m g/ks = 1e-6 m.
    assert run.x[-1] - run.x[0] == pytest.approx([1.0 / (2 * 0.5 * G), 1.0 / (2 * 0.25 * G)], rel=2e-3)


def test_chosen_bodies_and_samples_are_kept_and_labelled():
    arguments = {"t_end": 1.0, "contact": STEADY, "save_every": 100}
    run = dem.simulate_assembly(column(3), growing(3.0), keep=[2, "lower block"], **arguments)
    assert run.names == ("upper block", "lower block")
    ds = run.to_xarray()
    assert set(ds.dims) == {"time", "body", "interface", "corner"}
    assert list(ds.body.values) == ["upper block", "lower block"]
    assert ds.theta.dims == ("time", "body") and ds.theta.units == "rad" and ds.energy_base_work.units == "J"
    assert all("long_name" in ds[name].attrs and "units" in ds[name].attrs for name in ds.data_vars)
    assert ds.attrs["ending"] == "REACHED_END"
    everything = dem.simulate_assembly(column(3), growing(3.0), **arguments)
    assert np.array_equal(everything.theta[:, [2, 0]], run.theta)


def test_chunks_and_room_for_lists_leave_no_trace(monkeypatch):
    scene = dem.running_bond(4, 3)
    arguments = {"t_end": 0.5, "contact": STEADY, "criteria": dem.Criteria(stop="never")}
    whole = dem.simulate_assembly(scene, growing(3.0, 3.0), **arguments)
    monkeypatch.setattr(run_module.Run, "_chunk", lambda self: 97)
    setup = importlib.import_module("dem.assembly_setup")
    monkeypatch.setattr(setup, "room_for", lambda assembly: setup.Room(4, 4, 4))
    pieces = dem.simulate_assembly(scene, growing(3.0, 3.0), **arguments)
    # Settling is looked at between chunks, so it ends a little earlier or later.
    assert pieces.theta == pytest.approx(whole.theta, abs=1e-9)


@pytest.mark.parametrize(("blocks", "contacts"), [(1, 2), (2, 4), (3, 6)])
def test_a_column_that_stands_touches_at_two_corners_of_each_joint(blocks, contacts):
    run = dem.simulate_assembly(column(blocks), t_end=0.01, contact=STEADY)
    # Each block has four corners, of which the floor or the block below may meet two and the one above two.
    assert run.settings["contacts"] == contacts <= run.settings["places"]


def test_an_interrupt_keeps_what_was_computed():
    def motion(t):
        if t[0] > 0.5:
            raise KeyboardInterrupt
        return np.zeros_like(t), np.zeros_like(t)

    run = dem.simulate_assembly(column(2), motion, t_end=20.0, contact=STEADY, save_every=10)
    assert run.ending is dem.Ending.INTERRUPTED
    assert 0.0 < run.end_time < 20.0 and run.time.size > 100
    assert np.all(np.diff(run.time) > 0.0)


def test_progress_is_told_and_shown(capsys):
    heard = []
    dem.simulate_assembly(column(2), t_end=4.0, contact=STEADY, progress=heard.append)
    assert heard[-1] == pytest.approx(4.0, abs=1e-3) and len(heard) > 1
    dem.simulate_assembly(column(2), t_end=0.1, contact=STEADY, progress=True)
    assert "0.10 s" in capsys.readouterr().err


def test_a_run_that_blows_up_names_the_body_and_the_speed(monkeypatch):
    monkeypatch.setattr(simulate_module, "assembly_critical_step", lambda *_: math.inf)
    run = dem.simulate_assembly(
        column(2), growing(2.0), t_end=5.0, dt=1.5e-3, contact=dem.Contact(0.8, damping_ratio=1.0), settle=False
    )  # fmt: skip
    assert run.ending is dem.Ending.UNSTABLE
    assert "block (number" in run.reason and "speed =" in run.reason and f"t = {run.end_time:.6g} s" in run.reason
    assert run.time.size > 1


# Each way of moving counts, whichever way it goes: |vx| + |vz| + radius |omega|.
@pytest.mark.parametrize("way", [(9.0, 0.0, 0.0), (0.0, -9.0, 0.0), (-3.0, 4.0, 0.0), (3.0, -3.0, -20.0)])
def test_the_body_that_is_too_fast_is_named_with_its_speed(way):
    run = run_module.Run.__new__(run_module.Run)
    run.bodies = np.zeros((100, 3))
    run.bodies[q.RADIUS] = 0.5
    for row, value in zip((q.VX, q.VZ, q.OMEGA), way, strict=True):
        run.bodies[row, 1] = value
    run.movable, run.limits = 3, SimpleNamespace(speed=5.0)
    speed = abs(way[0]) + abs(way[1]) + 0.5 * abs(way[2])
    wanted = f"speed = {speed:.6g} m/s where at most 5 m/s is possible"
    assert run._culprit(dem.Ending.UNSTABLE) == (1, wanted)


def test_a_body_that_leaves_the_scene_is_named():
    run = dem.simulate_assembly(
        dem.Assembly((dem.block(B, H, D, DENSITY).moving(vx=3.0),)), t_end=5.0, contact=dem.Contact(0.0,
        damping_ratio=0.1), criteria=dem.Criteria(margin=1.0),
    )  # fmt: skip
    assert run.ending is dem.Ending.LEFT
    assert "body 0 (number 0), x = 1.0" in run.reason
    # The centroid is then 1 m beyond where the block's side was.
    assert run.end_time == pytest.approx((1.0 + 0.5 * B) / 3.0, abs=1e-3)


# Largest eigenvalue, kn = ks = 1.98e7 N/m: Block 3 alone 5.4e-4 s, in columns of two and three 3.7e-4 and 3.4e-4 s.
@pytest.mark.parametrize(("count", "expected"), [(1, 5.4e-4), (2, 3.7e-4), (3, 3.4e-4)])
def test_critical_step_of_a_column(count, expected):
    assert dem.assembly_critical_step(column(count), dem.Contact(1.0, damping=0.0)) == pytest.approx(
        expected, abs=0.05e-4
    )


# Stable steps go with 1 / sqrt(kn): those of 1e5 N/m are sqrt(198) times those of 1.98e7 N/m.
@pytest.mark.parametrize("materials", [("block",), ("block", "block"), ("wood", "stone")])
def test_critical_step_of_soft_contacts_is_as_much_longer(materials):
    """Two that cannot meet, as a block and itself, have no say; the default stiffness stood there."""
    bodies = [dem.block(B, H, D, DENSITY, x=3.0 * B * k, material=material) for k, material in enumerate(materials)]
    steps = []
    for stiffness in (1e5, 1.98e7):
        soft = dem.Contact(1.0, damping_ratio=0.1, kn=stiffness, ks=stiffness)
        table = {(material, "table"): soft for material in materials}
        pairs = {("block", "block"): soft} if materials.count("block") > 1 else {("wood", "stone"): soft}
        steps.append(dem.assembly_critical_step(dem.Assembly(tuple(bodies)), table | pairs))
    assert steps[0] == pytest.approx(math.sqrt(198.0) * steps[1], rel=1e-9)


def test_a_body_may_meet_what_damps_it_most_in_the_scene():
    """Two blocks apart from each other: their step is that of a scene in which all contacts are damped as theirs."""
    pair = dem.Assembly((dem.block(B, H, D, DENSITY), dem.block(B, H, D, DENSITY, x=3.0 * B)))
    weak, strong = dem.Contact(1.0, damping=10.0), dem.Contact(1.0, damping=3e4)
    contacts = {("block", "block"): strong, ("block", "table"): weak}
    as_damped = dem.assembly_critical_step(pair, strong)
    assert dem.assembly_critical_step(pair, contacts) == pytest.approx(as_damped, rel=1e-12)
    assert as_damped < 0.5 * dem.assembly_critical_step(pair, weak)


def test_a_block_that_is_thrown_up_flies_and_is_not_taken_for_one_that_blew_up():
    flying = dem.Assembly((dem.block(0.1, 0.1, D, DENSITY).moving(vz=5.0),))
    run = dem.simulate_assembly(flying, t_end=0.4, contact=STEADY, settle=False)
    assert run.ending is dem.Ending.REACHED_END
    assert run.z[-1, 0] - run.z[0, 0] == pytest.approx(5.0 * run.time[-1] - 0.5 * 9.80665 * run.time[-1] ** 2, rel=1e-3)


def test_each_contact_feels_how_the_points_that_touch_move_apart():
    """Along its normal and across it, by rotation matrices of the bodies that carry it; joints of an arch slant."""
    stability, scene = importlib.import_module("dem.assembly_stability"), SCENES["arch"]
    touch = all_touches(scene)
    scaled, movable = stability._rows(scene, touch)
    root = np.sqrt([[body.mass, body.mass, body.inertia] for body in scene.bodies])
    moved = np.random.default_rng(3).standard_normal((movable, 3))
    small = 1e-6

    def displaced(body, point):
        """How far a point of a body goes; what is not movable stays."""
        if body >= movable:
            return np.zeros(2)
        dx, dz, turn = small * moved[body]
        turned = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])  # clockwise
        lever = point - (scene.bodies[body].x, scene.bodies[body].z)
        return np.array([dx, dz]) + turned @ lever - lever

    slants = 0
    for k, (normal, point) in enumerate(zip(touch.normal, touch.point, strict=True)):
        apart = (displaced(touch.first[k], point) - displaced(touch.second[k], point)) / small
        felt = (scaled @ (root * moved).ravel())[2 * k : 2 * k + 2]
        assert felt == pytest.approx([apart @ normal, apart @ (normal[1], -normal[0])], abs=1e-5)
        slants += abs(normal[0] * normal[1]) > 0.1
    assert slants > 4


@pytest.mark.parametrize("name", ["three", "masonry", "arch", "stones"])
@pytest.mark.parametrize("xi", [0.0, 0.3])
def test_runs_just_below_the_critical_step_stay_bounded_and_just_above_grow(monkeypatch, name, xi):
    scene, contact = SCENES[name], dem.Contact(math.inf, damping_ratio=xi)
    stability = importlib.import_module("dem.assembly_stability")
    table = scene.contact_table(contact)
    numbers = np.array([table.names.index(material) for material in scene.materials])
    together = stability._together(scene, table, numbers)
    assert dem.assembly_critical_step(scene, contact) <= together
    monkeypatch.setattr(simulate_module, "assembly_critical_step", lambda *_: math.inf)

    def tremor(share):
        """Growth of a tremor of 1e-9 m/s about the settled state."""
        dt = share * together
        settings = {"dt": dt, "settle": 1.0, "save_every": 1, "watch_every": 10**6, "workers": 1, "onset": "located",
                    "coulomb": "total", "g": G, "pitch_about_x": 0.0, "pitch_about_z": 0.0}  # fmt: skip
        kept = tuple(range(len(scene.bodies)))
        run = run_module.Run(scene, table, dem.ContactJudgement(), dem.Criteria(), settings, 3000, kept)
        run.dt = 0.2 * together
        run.settle()
        run.dt = dt
        run.bodies[run_module.SPEEDS, : len(kept)] += 1e-9 * np.random.default_rng(1).standard_normal((3, len(kept)))
        history = run.through(None, False)
        return np.abs(history.vx[-100:]).max() / 1e-9

    assert tremor(0.99) < 100.0
    if name != "arch":  # some of its joints are open at one end, so that it stands a larger step
        assert tremor(1.01) > 1e3


def test_a_step_above_the_critical_one_is_refused_with_the_limit():
    limit = dem.assembly_critical_step(column(2), STEADY)
    with pytest.raises(ValueError, match=rf"dt=0\.001 s: want a step below {limit:.6g} s"):
        dem.simulate_assembly(column(2), t_end=1.0, contact=STEADY, dt=1e-3)


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
OFFSET = np.array(SQUARE) + np.array([0.5, 0.2])
LOW = np.array(SQUARE) - np.array([0.0, 0.1])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: dem.bodies_of([SQUARE, [[0, 0], [1, 0], [0.2, 0.2], [0, 1]]], 1.0, 1.0), "^body 1: .*convex"),
        (lambda: dem.bodies_of([SQUARE, [[2, 0], [3, 0], [4, 0]]], 1.0, 1.0), "^body 1: .*convex"),
        (lambda: dem.bodies_of([[[0, 0], [1, 0], [math.nan, 1]]], 1.0, 1.0), "^body 0: .*finite"),
        (lambda: dem.bodies_of([SQUARE], 0.0, 1.0), "^body 0: depth=0.0"),
        (lambda: dem.Assembly(()), "^bodies=.*at least one"),
        (lambda: dem.Assembly(dem.bodies_of([SQUARE, OFFSET], 1, 1)), "^body 0 and body 1 overlap by 0.5"),
        (lambda: dem.Assembly(dem.bodies_of([SQUARE], 1, 1), (dem.wall(OFFSET),)), "^body 0 and wall 0 overlap"),
        (lambda: dem.Assembly(dem.bodies_of([LOW], 1, 1)), "^body 0 is 0.1 m in the floor"),
        (lambda: dem.Assembly((dem.block(1, 1, 1, 1).moving(vx=math.nan),)), "^body 0: vx=nan"),
        (lambda: dem.Assembly((dem.block(1, 1, 1, 1).moving(vx="a"),)), "^body 0: vx=a: want a finite number"),
        (lambda: dem.Assembly(dem.block(1, 1, 1, 1)), r"^bodies=<Body.*>: want a tuple of bodies"),
        (lambda: dem.Assembly((dem.block(1, 1, 1, 1), "x")), r"^bodies\[1\]='x': want a Body, as dem.body makes it"),
        (lambda: dem.Assembly((dem.block(1, 1, 1, 1),), ("x",)), r"^walls\[0\]='x': want a Wall, as dem.wall makes it"),
        (lambda: dem.bodies_of([SQUARE, OFFSET], 1, 1, names=["a"]), r"^names=\['a'\]: want a list of 2 names"),
        (lambda: dem.bodies_of([SQUARE], 1, 1, names=["a", "b"]), r"^names=\['a', 'b'\]: want a list of 1 names"),
        (lambda: dem.bodies_of([SQUARE], 1, 1, names="a"), "^names='a': want a list"),
        (lambda: dem.assembly_critical_step(dem.single_block(1, 1, 1, 1), STEADY), "^assembly=.*: want an Assembly"),
        (lambda: dem.Contact(-0.1, damping=0.0), "^mu=-0.1"),
        (lambda: dem.Contact(0.5), "want exactly one"),
        (lambda: dem.Contact(0.5, damping=-1.0), "^damping=-1.0"),
        (lambda: dem.Criteria(stop="soon"), "^stop='soon'"),
        (lambda: dem.Criteria(gap=0.0), "^gap=0.0 m"),
        (lambda: dem.ContactJudgement(facing=1.0), "^facing=1.0 rad"),
        (lambda: dem.ContactJudgement(reach=-1.0), "^reach=-1.0 m"),
        (lambda: dem.column(0, B, H, D, DENSITY), "^count=0"),
        (lambda: dem.column(2, B, H, D, DENSITY, wall_gap=-0.1), "^wall_gap=-0.1 m"),
        (lambda: dem.arch(10, 3.0), "^thickness=3.0 m"),
        (lambda: dem.bookshelf(100), "^books=100"),
    ],
)  # fmt: skip
def test_bad_scenes_are_refused_with_the_number_of_the_body(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def spoilt(t):
    values = np.zeros_like(t)
    values[3:] = math.nan
    return values, np.zeros_like(t)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"t_end": 0.0}, "^t_end=0.0 s"),
        ({"dt": -1.0}, "^dt=-1.0 s"),
        ({"g": -1.0}, "^g=-1.0"),
        ({"onset": "late"}, "^onset='late': want 'located', 'overlap' or 'incremental'"),
        ({"coulomb": "sum"}, "^coulomb='sum': want 'total' or 'spring'"),
        ({"save_every": 0}, "^save_every=0"),
        ({"workers": 0}, "^workers=0"),
        ({"keep": ["roof"]}, "^keep='roof'"),
        ({"keep": [2]}, "^keep=2: want the number or name of one of the 2 bodies"),
        ({"contact": {("block", "block"): STEADY}}, "say nothing of 'block' on 'table'"),
        ({"pitch_about": (math.nan, 0.0)}, "^pitch_about x=nan"),
        ({"motion": spoilt}, r"a_x=nan m/s\^2 at t="),
        (
            {"contact": {("block", "block"): STEADY, ("block", "table"): 5}},
            r"^contact of \('block', 'table'\)=5: want a C",
        ),
        ({"contact": {"block": STEADY}}, "^contact of 'block': want the names of two materials"),
        ({"contact": 5}, "^contact=5: want a Contact, or a mapping"),
        ({"motion": 5}, "^motion=5: want a function of the times"),
        ({"criteria": "fall"}, "^criteria='fall': want a Criteria, or None"),
        ({"judgement": 5}, "^judgement=5: want a ContactJudgement, or None"),
        ({"settle": "no"}, "^settle='no': want True, False or None"),
        (
            {"judgement": dem.ContactJudgement(skin=0.0751)},
            r"^skin=0\.0751 m: want at most 0\.075 m, half of the shortest",
        ),
        (
            {"judgement": dem.ContactJudgement(skin=0.075, update_after=0.03)},
            r"^update_after=0\.03 m: want at most 0\.0247",
        ),
        ({"judgement": dem.ContactJudgement(skin=1e-5)}, "^skin=1e-05 m: want at least"),
        ({"judgement": dem.ContactJudgement(update_after=0.1)}, "^update_after=0.1 m: want at most"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments, message):
    with pytest.raises(ValueError, match=message):
        dem.simulate_assembly(column(2), **{"t_end": 0.1, "contact": STEADY, **arguments})


def test_an_assembly_that_does_not_stand_is_refused_by_name():
    tall = dem.Assembly((dem.block(0.1, 0.5, 0.2, DENSITY, tilt=0.4, name="leaning"),))
    with pytest.raises(ValueError, match=r"^leaning \(number 0\) does not come to rest"):
        dem.simulate_assembly(tall, t_end=0.1, contact=STEADY)


@pytest.mark.parametrize(("share", "corners"), [(0.5, 2), (2.0, 0)])
def test_corners_touch_the_floor_within_a_millionth_of_the_largest_body(share, corners):
    """Of a small block, whose own size counts and not that of a metre."""
    low = dem.single(0.04, 0.06, 0.02, DENSITY)
    gap = share * 1e-6 * 0.5 * math.hypot(0.04, 0.06)
    raised = replace(low, bodies=tuple(replace(body, z=body.z + gap) for body in low.bodies))
    assert len(all_touches(raised).first) == corners
