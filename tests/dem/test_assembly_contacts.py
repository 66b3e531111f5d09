"""Contacts of assemblies: lever rule, hand-over between aligned blocks, slope, collisions, lists with and without
skin."""

import math

import numpy as np
import pytest

import dem
from dem import assembly_setup, assembly_skin

G = 9.80665
KN = 1.98e7
B, H, D, DENSITY = 0.15, 0.50, 0.25, 597.0
STEADY = dem.Contact(0.7, damping_ratio=0.1)


def still(t):
    return np.zeros_like(t), np.zeros_like(t)


class Pitch:
    """A table that leans by angle(t), given with its second derivative, about a point that stays where it is."""

    def __init__(self, angle, acceleration):
        self.angle, self.acceleration = angle, acceleration

    def __call__(self, t):
        return still(t)

    def pitch(self, t):
        return self.angle(t) + 0.0 * t, self.acceleration(t) + 0.0 * t


# Two contacts of an edge on an edge: moments about each give the share of the other (Fig. 8 of the paper).
@pytest.mark.parametrize("x_l", [0.0, 0.02, -0.05, 0.07])
def test_two_contacts_of_an_edge_share_a_load_by_the_lever_rule(x_l):
    load = dem.block(0.01, 0.3, 1.0, 5000.0, x=x_l, z=H)
    run = dem.simulate_assembly(dem.Assembly((dem.block(B, H, D, DENSITY), load)), t_end=0.05, contact=STEADY)
    weight, extra = dem.Assembly((dem.block(B, H, D, DENSITY),)).mass * G, load.mass * G
    share = 0.5 * weight + extra * np.array([0.5 - x_l / B, 0.5 + x_l / B])
    sunk, turned = 0.5 * H - run.z[-1, 0], run.theta[-1, 0]
    found = KN * np.array([sunk - 0.5 * B * turned, sunk + 0.5 * B * turned])
    # The settled tilt of about 1e-4 rad moves the load, half a metre up, by 5e-5 m, 3e-4 of b.
    assert found == pytest.approx(share, rel=3e-3)


# On its middle the sole is sunk evenly: kn times the depths of its corners is the weight, whichever pair they are of.
@pytest.mark.parametrize("drop", [1e-6, 1e-4, 1e-3])
def test_three_corners_of_a_sole_carry_a_block_between_them(drop):
    kn = 2e4

    def sole(x):
        half = 0.1
        outline = [[x - half, drop], [x, 0.0], [x + half, drop], [x + half, 0.2], [x - half, 0.2]]
        return dem.body(np.array(outline), 0.25, 2000.0)

    scene = dem.Assembly((sole(0.0), sole(0.5), sole(1.0)), standing=False)
    soft = dem.Contact(0.5, damping_ratio=0.5, kn=kn, ks=kn)
    run = dem.simulate_assembly(scene, t_end=3.0, contact=soft)
    for k, body in enumerate(scene.bodies):
        heights = body.vertices[:, 1] - body.z + run.z[-1, k]
        assert np.count_nonzero(heights < 0.0) == 3
        assert kn * np.maximum(-heights, 0.0).sum() == pytest.approx(body.mass * G, rel=1e-9)


def test_a_load_stands_up_to_the_edge_and_falls_beyond_it():
    def falls(x_l):
        upper = dem.block(B, 0.1, D, DENSITY, x=x_l, z=H)
        scene = dem.Assembly((dem.block(B, H, D, 50.0 * DENSITY), upper), standing=False)
        run = dem.simulate_assembly(scene, t_end=2.0, contact=STEADY)
        return [fall.body for fall in run.falls]

    # The load's centroid over the edge of the lower block is x_l = b/2.
    assert falls(0.5 * B - 1e-3) == []
    assert falls(0.5 * B + 1e-3) == [1]


def two_blocks(delta, speed):
    lower = dem.block(B, H, D, 10.0 * DENSITY)
    return dem.Assembly((lower, dem.block(B, H, D, DENSITY, x=delta, z=H).moving(vx=speed)))


def test_a_block_that_slides_through_alignment_feels_no_jump():
    mu = 0.3
    delta, speed = -4e-4, 0.1
    run = dem.simulate_assembly(
        two_blocks(delta, speed), t_end=0.02, dt=2e-6, contact=dem.Contact(mu, damping_ratio=0.3), save_every=1
    )
    offset = run.x[:, 1] - run.x[:, 0]
    crossing = int(np.flatnonzero((offset[1:] > 0.0) & (offset[:-1] <= 0.0))[0])
    around = slice(crossing - 400, crossing + 400)
    speed_x, speed_z = run.vx[around, 1], run.vz[around, 1]
    a_x, a_z = np.diff(speed_x) / 2e-6, np.diff(speed_z) / 2e-6
    # Friction is mu N before, at and after alignment, and N goes on as it was: the largest step between neighbouring
    # accelerations at the alignment is no larger than elsewhere. A lost or doubled contact would change N by half.
    assert a_x == pytest.approx(-mu * (a_z + G), rel=1e-3)
    for a in (a_x, a_z):
        steps = np.abs(np.diff(a))
        assert steps[395:405].max() <= 2.0 * np.median(steps) + 1e-3 * G
    balance = run.energies.balance
    # A contact lost or doubled would show half of what the springs hold; the turn of levers within a step shows 1e-6.
    assert np.ptp(balance[around]) < 1e-5 * run.energies.elastic.max()


def test_a_sticking_block_that_sways_through_alignment_moves_as_if_it_were_not_aligned():
    def sway(delta):
        def motion(t):
            return 1.0 * np.sin(2.0 * math.pi * 40.0 * t), np.zeros_like(t)

        return dem.simulate_assembly(
            two_blocks(delta, 0.0),
            motion,
            t_end=0.3,
            dt=1e-5,
            contact=dem.Contact(0.9, damping_ratio=0.02),
            save_every=1,
        )

    aligned, offset = sway(0.0), sway(-1e-4)
    crossings = np.count_nonzero(np.diff(np.sign(aligned.x[:, 1] - aligned.x[:, 0])))
    assert crossings > 5
    motion = offset.x[:, 1] - offset.x[0, 1]
    # The offset of 1e-4 m shortens the stretch that carries by 7e-4 of b.
    assert aligned.x[:, 1] - aligned.x[0, 1] == pytest.approx(motion, abs=4e-3 * np.abs(motion).max())
    assert np.ptp(aligned.energies.balance) < 1e-9


@pytest.mark.parametrize(("mu", "slides"), [(0.36, True), (0.37, False)])
def test_a_block_on_a_slope_slides_where_the_slope_is_steeper_than_the_friction(mu, slides):
    slope = math.atan(0.365)
    flat = dem.Assembly((dem.block(0.5, 0.1, 0.1, DENSITY),))
    # The slope comes on smoothly, with an acceleration of less than 0.003 g at the block.
    rise = 2.0

    def angle(t):
        s = np.minimum(t / rise, 1.0)
        return slope * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)

    def acceleration(t):
        s = np.minimum(t / rise, 1.0)
        return slope / rise**2 * (60.0 * s - 180.0 * s**2 + 120.0 * s**3)

    run = dem.simulate_assembly(
        flat, Pitch(angle, acceleration), t_end=3.0, contact=dem.Contact(mu, damping_ratio=0.3),
        criteria=dem.Criteria(stop="never"),
    )  # fmt: skip
    late = run.time > 2.2
    pull = 2.0 * np.polyfit(run.time[late], run.x[late, 0], 2)[0]
    expected = G * (math.sin(slope) - mu * math.cos(slope)) if slides else 0.0
    assert pull == pytest.approx(expected, rel=1e-3, abs=1e-4)


def test_a_body_in_free_flight_above_a_pitching_table_obeys_newton_in_the_inertial_frame():
    about, amplitude, rate = (0.3, -0.2), 0.4, 3.0

    def angle(t):
        return amplitude * np.sin(rate * t)

    def acceleration(t):
        return -(rate**2) * amplitude * np.sin(rate * t)

    thrown = dem.block(0.2, 0.1, 0.1, DENSITY, x=0.5, z=1.0).moving(vx=0.4, vz=2.0, omega=1.5)
    scene = dem.Assembly((thrown,), floor=False, standing=False)
    run = dem.simulate_assembly(
        scene, Pitch(angle, acceleration), t_end=0.6, dt=1e-5, contact=STEADY, pitch_about=about, save_every=100,
        criteria=dem.Criteria(stop="never"),
    )  # fmt: skip
    # At t = 0 the table is level and turns at `rate * amplitude`: add its speed there to get the inertial one.
    spin = rate * amplitude
    q = np.array([0.5 - about[0], 1.05 - about[1]])
    v = np.array([0.4 + spin * q[1], 2.0 - spin * q[0]])
    t = run.time
    x, z = q[0] + v[0] * t, q[1] + v[1] * t - 0.5 * G * t**2
    cos, sin = np.cos(angle(t)), np.sin(angle(t))
    # 6e4 steps of 1e-5 s; the frame's terms are taken at the pose, an error of second order.
    assert run.x[:, 0] - about[0] == pytest.approx(cos * x - sin * z, abs=1e-8)
    assert run.z[:, 0] - about[1] == pytest.approx(sin * x + cos * z, abs=1e-8)
    assert run.theta[:, 0] == pytest.approx((1.5 + spin) * t - angle(t), abs=1e-8)
    assert np.ptp(run.energies.balance) < 1e-6 * run.energies.kinetic.max()


def collision(contact, dt=2e-6):
    first = dem.block(0.2, 0.1, 0.1, 600.0, x=-0.2, z=1.0, tilt=0.3).moving(vx=1.0, vz=0.1, omega=2.0)
    corners = [[0.05, 0.95], [0.25, 0.9], [0.3, 1.05], [0.15, 1.2], [0.02, 1.1]]
    second = dem.body(corners, 0.1, 900.0).moving(vx=-0.5, omega=-1.0)
    scene = dem.Assembly((first, second), floor=False, standing=False)
    run = dem.simulate_assembly(
        scene, t_end=0.25, dt=dt, contact=contact, g=0.0, save_every=500, criteria=dem.Criteria(stop="never")
    )
    mass = np.array([thing.mass for thing in scene.bodies])
    inertia = np.array([thing.inertia for thing in scene.bodies])
    px, pz = run.vx @ mass, run.vz @ mass
    # Clockwise: r_z p_x - r_x p_z.
    spin = (run.z * run.vx - run.x * run.vz) @ mass + run.omega @ inertia
    return run, px, pz, spin


@pytest.mark.parametrize(
    "contact", [dem.Contact(0.4, damping_ratio=0.2), dem.Contact(0.0, damping=0.0), dem.Contact(math.inf, damping=0.0)]
)
def test_a_collision_keeps_momentum_and_angular_momentum(contact):
    run, px, pz, spin = collision(contact)
    assert np.abs(np.diff(run.omega[:, 0])).max() > 0.1  # they did collide
    # Rounding; the two forces of a contact are one number, and both act at the corner.
    assert px == pytest.approx(px[0], abs=1e-11)
    assert pz == pytest.approx(pz[0], abs=1e-11)
    # The samples' velocity is the mean of two half steps, the place that between them: second order in dt.
    assert spin == pytest.approx(spin[0], abs=1e-8)
    assert np.ptp(run.energies.balance) < 1e-6 * run.energies.kinetic[0]


def test_a_smooth_elastic_collision_keeps_the_kinetic_energy():
    run, *_ = collision(dem.Contact(0.0, damping=0.0))
    kinetic = run.energies.kinetic
    assert run.energies.elastic[-1] == 0.0
    # (om dt)^4 of the energy at landing and leaving.
    assert kinetic[-1] == pytest.approx(kinetic[0], rel=1e-6)


SCENES = {
    "single": (dem.single(B, H, D, DENSITY), 6.0),
    "column": (dem.column(3, B, H, D, DENSITY), 6.0),
    "next to a wall": (dem.column(2, B, H, D, DENSITY, wall_gap=0.0), 6.0),
    "masonry": (dem.running_bond(5, 3), 9.0),
    "stones": (dem.rubble(4), 5.0),
    "arch": (dem.arch(9, 0.2), 6.0),
    "flat arch": (dem.arch(9, 0.2, embrace=2.0), 20.0),
    "shelf": (dem.bookshelf(), 6.0),
}


def test_cells_of_the_search_are_as_wide_as_a_typical_body():
    """Larger ones would cost time alone: in one that holds all bodies each is compared with each."""
    scene, diagonal = dem.column(3, B, H, D, DENSITY), math.hypot(B, H)
    assert assembly_setup.cell_size(scene, 0.004) == pytest.approx(diagonal + 0.008)


@pytest.mark.parametrize(("floor", "lowest"), [(True, 0.0), (False, 0.4)])
def test_a_body_in_the_air_may_fall_as_low_as_the_floor_or_what_there_is(floor, lowest):
    """A wall from 0.4 m up under a block that hangs over it: by how much that falls bounds its speed."""
    ledge = dem.wall([(-0.5, 0.4), (0.5, 0.4), (0.5, 0.5), (-0.5, 0.5)])
    scene = dem.Assembly((dem.block(B, H, D, DENSITY, z=1.0),), (ledge,), floor=floor, standing=False)
    assert assembly_skin.lowest_to_meet(scene) == pytest.approx(lowest, abs=1e-12)


def test_a_body_may_fall_into_a_pit_below_the_floor():
    ledge = dem.wall([(0.5, -0.4), (1.5, -0.4), (1.5, -0.3), (0.5, -0.3)])
    scene = dem.Assembly((dem.block(B, H, D, DENSITY, z=1.0),), (ledge,), standing=False)
    assert assembly_skin.lowest_to_meet(scene) == pytest.approx(-0.4, abs=1e-12)


@pytest.mark.parametrize(("density", "shorter"), [(DENSITY, False), (1e4 * DENSITY, True)])
def test_the_step_is_short_enough_for_what_the_heaviest_body_may_throw(density, shorter):
    """Of masses 1 to 1e6, the light one might leave an impact at a thousand times the speed of a fall (by energy). It
    goes no farther in a step than half of the skin."""
    pebble = dem.block(0.1 * B, 0.1 * H, D, DENSITY, x=0.5, name="pebble")
    scene = dem.Assembly((dem.block(B, H, D, density), pebble))
    quarter = 0.25 * dem.assembly_critical_step(scene, STEADY)
    run = dem.simulate_assembly(scene, t_end=0.002, contact=STEADY, settle=False)
    dt, fall = run.settings["dt"], math.sqrt(2.0 * G * (0.5 * H + math.hypot(B, H)))
    assert dt <= quarter and (dt < quarter) == shorter
    if shorter:
        fastest = fall * math.sqrt(scene.bodies[0].mass / scene.bodies[1].mass)
        assert dt == pytest.approx(0.5 * run.settings["judgement_skin"] / fastest, rel=1e-9)
        with pytest.raises(ValueError, match=r"^skin=0\.001\d* m: want at least .* or a smaller step: bodies"):
            dem.simulate_assembly(scene, t_end=0.002, contact=STEADY, dt=quarter, settle=False)


def test_blocks_of_a_column_are_named_from_below():
    names = {count: dem.column(count, B, H, D, DENSITY).names for count in (1, 2, 3, 4)}
    assert names[1] == ("block",) and names[2] == ("lower block", "upper block")
    assert names[3] == ("lower block", "middle block", "upper block")
    assert names[4] == ("lower block", "middle 1 block", "middle 2 block", "upper block")


def test_a_corner_above_the_end_of_an_edge_that_does_not_face_it_falls_freely_until_it_lands():
    """The edge of the diamond over the blunt end of the top (160 degrees) is turned 25 degrees too far to meet it: the
    contact has one corner, not two. Fall of gap 2 mm, less than the skin, so that it is listed from the start."""
    gap, r, drop = 0.002, 0.07, 0.1 * math.tan(math.radians(20.0))
    blunt = dem.body([(-0.3, 0), (0.3, 0), (0.3, 0.2 - drop), (0.2, 0.2), (-0.2, 0.2), (-0.3, 0.2 - drop)], D, DENSITY)
    lowest = np.array([0.199, 0.2 + gap])
    diamond = dem.body(lowest + r * np.array([(0, 0), (1, 1), (0, 2), (-1, 1)]), D, DENSITY)
    fall = math.sqrt(2.0 * gap / G)
    run = dem.simulate_assembly(
        dem.Assembly((blunt, diamond), standing=False), t_end=1.5 * fall, dt=1e-5, save_every=10, settle=False,
        contact=dem.Contact(1.0, damping_ratio=0.05), criteria=dem.Criteria(stop="never"),
    )  # fmt: skip
    assert run.settings["judgement_skin"] > 2.0 * gap
    free = run.time < 0.99 * fall
    assert run.z[free, 1] - run.z[0, 1] == pytest.approx(-0.5 * G * run.time[free] ** 2, abs=1e-12)
    assert not run.theta[free].any() and not (run.x[free] - run.x[0]).any()
    landed = run.time > 1.05 * fall
    assert (run.z[landed, 1] - run.z[0, 1] > -0.5 * G * run.time[landed] ** 2 + 1e-6).all()


@pytest.mark.parametrize("name", SCENES)
def test_a_contact_is_never_missed_lists_with_a_skin_give_the_bits_of_lists_made_at_every_step(name):
    scene, amplitude = SCENES[name]

    def motion(t):
        return amplitude * np.sin(2.0 * math.pi * 2.5 * t), 2.0 * np.sin(17.0 * t)

    def run(update_after):
        return dem.simulate_assembly(
            scene, motion, t_end=0.6, contact=STEADY, judgement=dem.ContactJudgement(update_after=update_after),
            criteria=dem.Criteria(stop="never"),
        )  # fmt: skip

    lasting, fresh = run(None), run(0.0)
    assert fresh.settings["lists_made"] > 50 * lasting.settings["lists_made"]
    assert np.abs(lasting.theta).max() > 1e-3
    for quantity in ("x", "z", "theta", "vx", "vz", "omega"):
        assert np.array_equal(getattr(lasting, quantity), getattr(fresh, quantity)), quantity


@pytest.mark.parametrize(
    ("scene", "skin"),
    [
        # A corner rests within 2 mm of an end of an edge at 0.97 s; the default skin is 2.5 mm.
        (dem.bookshelf(), 0.0015),
        # Half of the shortest edge, the most that is taken, where bodies turn fast or tumble over each other.
        (
            dem.Assembly((dem.block(B, H, D, DENSITY, z=0.3, tilt=0.5).moving(vx=0.5, omega=8.0),), standing=False),
            0.075,
        ),
        (dem.column(2, B, 0.2, D, DENSITY), 0.075),
        (dem.running_bond(2, 2), 0.049),
    ],
)
def test_the_skin_changes_no_bit(scene, skin):
    def motion(t):
        return 9.0 * np.sin(2.0 * math.pi * 2.5 * t), 2.0 * np.sin(17.0 * t)

    default, other = (
        dem.simulate_assembly(
            scene, motion, t_end=1.0, contact=STEADY, judgement=judgement, criteria=dem.Criteria(stop="never")
        )
        for judgement in (None, dem.ContactJudgement(skin=skin))
    )
    assert default.settings["lists_made"] != other.settings["lists_made"]
    for quantity in ("x", "z", "theta"):
        assert np.array_equal(getattr(default, quantity), getattr(other, quantity)), quantity


@pytest.mark.parametrize("name", SCENES)
def test_two_workers_give_the_same_bits_as_one(name):
    scene, amplitude = SCENES[name]

    def motion(t):
        return amplitude * np.sin(2.0 * math.pi * 2.5 * t), 2.0 * np.sin(17.0 * t)

    one, two = (
        dem.simulate_assembly(
            scene, motion, t_end=0.03, contact=STEADY, workers=n, settle=False, criteria=dem.Criteria(stop="never")
        )
        for n in (1, 2)
    )
    for quantity in ("x", "z", "theta", "omega"):
        assert np.array_equal(getattr(one, quantity), getattr(two, quantity)), quantity
    assert np.array_equal(one.energies.balance, two.energies.balance)


@pytest.mark.parametrize("name", SCENES)
def test_energy_closes_in_every_scene(name):
    scene, amplitude = SCENES[name]

    def motion(t):
        return amplitude * np.sin(2.0 * math.pi * 2.5 * t), 2.0 * np.sin(17.0 * t)

    run = dem.simulate_assembly(scene, motion, t_end=0.6, contact=STEADY, criteria=dem.Criteria(stop="never"))
    energies = run.energies
    handled = energies.kinetic.max() + energies.dashpot[-1] + energies.friction[-1]
    print(f"{name}: {np.ptp(energies.balance) / handled:.1e} of {handled:.3g} J, onset {energies.onset[-1]:.1e} J")
    # The turn of a corner's lever within a step, of second order in a step of a quarter of the critical one.
    assert np.ptp(energies.balance) < 2e-5 * handled
    for lost in (energies.dashpot, energies.friction):
        assert np.diff(lost).min() > -1e-4 * handled


class Shaking(Pitch):
    """Horizontal and vertical shaking that comes on in a second, and pitch."""

    def __init__(self, amplitude):
        super().__init__(
            lambda t: 0.02 * np.sin(6.0 * t) ** 3,
            lambda t: 0.72 * (6.0 * np.sin(6.0 * t) * np.cos(6.0 * t) ** 2 - 3.0 * np.sin(6.0 * t) ** 3),
        )
        self.amplitude = amplitude

    def __call__(self, t):
        growing = self.amplitude * np.minimum(t, 1.0)
        return growing * np.sin(4.0 * math.pi * t), 0.5 * growing * np.sin(10.0 * math.pi * t)


COLLAPSING = {
    "shelf": dem.bookshelf(),
    "arch": dem.arch(11, 0.15),
    "drums": dem.drum_column(5),
    "stones": dem.rubble(5),
    "column and wall": dem.column(3, B, H, D, DENSITY, wall_gap=0.02),
}


@pytest.mark.parametrize("name", COLLAPSING)
def test_energy_closes_while_a_scene_collapses_on_a_pitching_table(name):
    scene = COLLAPSING[name]
    run = dem.simulate_assembly(
        scene, Shaking(15.0), t_end=2.5, contact=dem.Contact(0.6, damping_ratio=0.1), pitch_about=(0.0, -0.5),
        criteria=dem.Criteria(stop="never", margin=50.0),
    )  # fmt: skip
    assert run.falls
    energies = run.energies
    handled = energies.kinetic.max() + energies.dashpot[-1] + energies.friction[-1]
    # The turn of a corner's lever within a step: largest for the drums, whose step is 4e-4 s.
    assert np.ptp(energies.balance) < 2e-4 * handled
    if scene.floor:  # nothing has sunk through
        assert run.z.min() > 0.0


def test_contacts_are_asked_of_the_pairs_of_materials_that_can_meet_and_of_no_others():
    """A stone alone meets floor and wall, which never meet each other; a second stone it meets too."""
    side = dem.wall([(0.4, 0.0), (0.5, 0.0), (0.5, 0.6), (0.4, 0.6)], material="wall")
    one = dem.block(B, H, D, DENSITY, material="stone")
    on_floor, on_wall, on_stone = (
        dem.Contact(mu, damping_ratio=0.1, kn=kn) for mu, kn in ((0.7, 1e7), (0.5, 2e7), (0.3, 3e7))
    )
    contacts = {("stone", "floor"): on_floor, ("wall", "stone"): on_wall}

    def table(*bodies):
        return dem.Assembly(bodies, walls=(side,), floor_material="floor").contact_table(contacts)

    alone = table(one)
    assert alone.names == ("stone", "wall", "floor")
    assert alone.kn[0].tolist() == alone.kn[:, 0].tolist() == [alone.kn[0, 0], 2e7, 1e7]
    assert alone.mu[0, 1:].tolist() == [0.5, 0.7]
    second = dem.block(B, H, D, DENSITY, material="stone", x=-0.3)
    with pytest.raises(ValueError, match="contacts say nothing of 'stone' on 'stone': want one Contact"):
        table(one, second)
    contacts["stone", "stone"] = on_stone
    assert table(one, second).kn[0].tolist() == [3e7, 2e7, 1e7]
