"""The block on a floor that gives downward alone: Lagrange's equations, energy, stiff springs along it, solvers."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from excitation import OneSinePulse
from rocking import Block, Method1, scalars, solve
from rocking.downward_floor import BlockOnDownwardFloor
from rocking.effects import compose, parse
from rocking.hybrid import Base, Discrete, Mode

G = 9.80665
SMALL = Block(b=0.15, h=0.50, d=0.25)  # Block 3 of Winkler, Meguro & Yamazaki (1995), Table 1
SHAKEN = OneSinePulse(4.0, 4.0)
STILL = Base(0.0, 0.0)


def texts(k: float, xi: float, *more: str) -> list[str]:
    return [
        f"compliant_base.corner_stiffness={k!r}", f"compliant_base.damping_ratio={xi!r}",
        "compliant_base.tangential_ratio=inf", *more,
    ]  # fmt: skip


def run(k: float, xi: float, *more: str, **options: Any) -> Any:
    return solve(Method1(SMALL), options.pop("motion", None), effects=parse(texts(k, xi, *more)), **options)


def lagrange(k: float, xi: float, offset: float, start: tuple[float, ...], shaken: bool, t: np.ndarray) -> np.ndarray:
    """Rotation: height and rotation as coordinates, corner forces by the work that they do, one corner held in x."""
    m, a, H = SMALL.mass, 0.5 * SMALL.b, 0.5 * SMALL.h
    c = 2.0 * xi * math.sqrt(k * m)

    def rate(time: float, y: np.ndarray) -> list[float]:
        z, theta, v, omega = y
        sin, cos = math.sin(theta), math.cos(theta)
        a_x = float(SHAKEN(time)[0]) if shaken else 0.0
        work, lift = 0.0, 0.0
        for side in (1.0, -1.0):
            arm = side * a - offset  # of the corner, from the centre of mass along the base
            height, by_theta = z - arm * sin - H * cos, -arm * cos + H * sin
            N = max(-k * height - c * (v + by_theta * omega), 0.0) if height < 0.0 else 0.0
            lift, work = lift + N, work + N * by_theta
        lower = (a if theta >= 0.0 else -a) - offset
        first, second = H * cos + lower * sin, lower * cos - H * sin  # of x by theta
        inertia = SMALL.I_c + m * first**2
        return [v, omega, lift / m - G, (work - m * first * (second * omega**2 + a_x)) / inertia]

    found = solve_ivp(rate, (0.0, t[-1]), start, "DOP853", t, rtol=1e-10, atol=1e-13, max_step=5e-4)
    return np.asarray(found.y[1])


# Steps of 0.5 ms at the most over kinks that SciPy does not locate; impacts make more of it.
@pytest.mark.parametrize(
    ("k", "xi", "offset", "theta", "shaken"),
    [(1e6, 0.12, 0.0, 0.12, False), (2e7, 0.3, 0.01, -0.1, False), (1e6, 0.12, 0.0, 0.0, True)],
)
def test_the_rotation_is_that_of_lagranges_equations(
    k: float, xi: float, offset: float, theta: float, shaken: bool
) -> None:
    t = np.linspace(0.0, 1.0, 201)
    more = [f"eccentric_mass.offset={offset!r}"] if offset else []
    motion = SHAKEN if shaken else None
    ours = run(k, xi, *more, motion=motion, theta=theta, t_end=1.0, save_at=t, rtol=1e-11, atol=1e-14)
    y = ours.y[0]
    theirs = lagrange(k, xi, offset, (y[1], y[2], y[4], y[5]), shaken, t)
    assert np.max(np.abs(theirs)) > 0.05
    np.testing.assert_allclose(ours.theta, theirs, rtol=0.0, atol=1e-6)


# It is located where the block turns; how fast it sinks is no matter.
@pytest.mark.parametrize(("v", "omega", "located"), [(0.0, 0.5, True), (0.0, -0.5, True), (0.3, 0.0, False)])
def test_a_block_that_turns_through_upright_is_seen_to(v: float, omega: float, located: bool) -> None:
    system = compose(Method1(SMALL), parse(texts(1e6, 0.1)))
    y, q = system.initial_state()
    theta = -math.copysign(1e-5, omega)
    state = (y[0], y[1], theta, 0.0, v, omega, *y[6:])
    *_, upright = system.guards(
        scalars, state, Discrete(q.mode, q.s, math.copysign(1.0, theta)), STILL, system.parameters
    )
    assert upright == (pytest.approx(1e-5) if located else 1.0)


@pytest.mark.parametrize("bed", ["compliant_base.spread=0.0", "compliant_base.spread=1.0"])
def test_without_dashpots_energy_stays(bed: str) -> None:
    k, t = 1e6, np.linspace(0.0, 3.0, 3001)
    free = run(k, 0.0, bed, theta=0.1, t_end=3.0, save_at=t, rtol=1e-11, atol=1e-14)
    _, z, theta, u, v, omega = free.y.T[:6]
    moving = 0.5 * SMALL.mass * (u**2 + v**2) + 0.5 * SMALL.I_c * omega**2 + SMALL.mass * G * z
    a, H = 0.5 * SMALL.b, 0.5 * SMALL.h
    # Springs by the depth of what is below the floor: two corners, or 2,001 strips of the base as stiff in all.
    xi, share = (np.array([-a, a]), np.ones(2)) if bed.endswith("0.0") else _strips(a)
    depth = np.maximum(0.0, H * np.cos(theta)[:, None] + np.sin(theta)[:, None] * xi - z[:, None])
    total = moving + 0.5 * k * (depth**2 * share).sum(axis=1)
    # A bed of strips is told to the square of their width.
    assert np.ptp(total) < (1e-8 if bed.endswith("0.0") else 1e-5) * SMALL.mass * G * SMALL.h


def _strips(a: float) -> tuple[np.ndarray, np.ndarray]:
    edges = np.linspace(-a, a, 2002)
    return 0.5 * (edges[1:] + edges[:-1]), np.full(2001, 2.0 / 2001)


# With strong dashpots no corner leaves the floor beside the other: stiff springs along it all but hold it then, and
# give by the force over their stiffness.  At 1e4 and 1e5 times k they lead away again (0.07 and 0.5 mrad over two
# seconds, at any tolerance): both feet are held, whose distance along the floor is 2 a cos(theta).  On a bed, where
# both are under the floor up to larger tilts, they do so from 1e3 times k on.
@pytest.mark.parametrize(
    "more",
    [
        pytest.param((), id="free"),
        pytest.param(("vertical_motion.ratio=0.4",), id="moved up and down"),
        pytest.param(("table_pitch.per_acceleration=0.003",), id="on a table that pitches"),
        pytest.param(("viscous_damping.coefficient=1.5",), id="a torque"),
        pytest.param(("eccentric_mass.offset=0.008",), id="a mass off the middle"),
        pytest.param(("compliant_base.spread=1.0",), id="a bed"),
    ],
)
def test_stiff_springs_along_the_floor_lead_to_it(more: tuple[str, ...]) -> None:
    k, t = 1e6, np.linspace(0.0, 1.0, 201)
    options: dict[str, Any] = {"theta": 0.06, "t_end": 1.0, "save_at": t, "rtol": 1e-10, "atol": 1e-13}
    if more and not more[0].startswith(("viscous", "eccentric", "compliant")):
        options["motion"] = OneSinePulse(1.5, 2.0)
    held, off = run(k, 0.6, *more, **options).theta, []
    for ratio in (1e1, 1e2) if "spread" in "".join(more) else (1e2, 1e3):
        stiff = [*texts(k, 0.6, *more)[:2], f"compliant_base.tangential_ratio={ratio!r}", *more]
        other = solve(Method1(SMALL), options.get("motion"), effects=parse(stiff), **{
            name: value for name, value in options.items() if name != "motion"
        })  # fmt: skip
        off.append(float(np.max(np.abs(other.theta - held))))
    assert off[1] < 0.2 * off[0] and off[0] < 0.01 * 0.06
    # What is asked for moves the block by far more than that.
    if more:
        without = run(k, 0.6, **options).theta
        assert np.max(np.abs(without - held)) > 20.0 * off[1]


@pytest.mark.parametrize("solver", ["scipy", "diffrax"])
def test_solvers_agree(solver: str) -> None:
    options: dict[str, Any] = {"motion": SHAKEN, "t_end": 1.0, "save_at": np.linspace(0.0, 1.0, 101)}
    ours, theirs = (run(1e6, 0.2, solver=name, rtol=1e-10, atol=1e-13, **options).theta for name in ("numba", solver))
    assert np.max(np.abs(ours)) > 0.03
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-7)


def test_it_mirrors_and_a_standing_block_stands() -> None:
    pair = [run(1e6, 0.2, theta=side * 0.1, t_end=2.0).theta for side in (1.0, -1.0)]
    np.testing.assert_allclose(pair[0], -pair[1], rtol=0.0, atol=1e-12)
    still = run(1e6, 0.2, "eccentric_mass.offset=0.01", t_end=1.0, rtol=1e-11, atol=1e-16)
    assert np.all(still.mode == Mode.REST) and np.ptp(still.theta) < 1e-11


def test_friction_has_no_say_and_is_refused() -> None:
    with pytest.raises(ValueError, match=r"friction=0\.7: want inf where tangential_ratio=inf"):
        compose(Method1(SMALL), parse(texts(1e6, 0.2, "compliant_base.friction=0.7")))
    rigid = compose(Method1(SMALL), parse(texts(1e6, 0.2))).rigid
    with pytest.raises(ValueError, match=r"tangential_ratio=1\.0: want inf"):
        BlockOnDownwardFloor(rigid, 1e6, 0.2)
