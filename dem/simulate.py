"""The public verb: one body on a moving base, carried through time in chunks of compiled steps.

Source  Winkler, Meguro & Yamazaki (1995); default kn = ks and dt are theirs
Status  see the package head
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from dem import checks
from dem.history import OMEGA_STILL, SPEED_AT_REST, Energies, History, Mode, Outcome
from dem.interrupts import uninterrupted
from dem.scenes import Scene
from dem.shapes import FloatArray
from dem.stability import critical_step
from dem.table_motion import Motion, accelerations, check_motion, pitches, refuse_pitch

CHUNK = 50_000  # steps between looks at the base motion and calls of `progress`
MOST_STEPS = 1e12  # months of computing
SAMPLES = 2000  # about as many are kept unless the caller says otherwise
HEADROOM = 10.0  # a run this many times faster than its forces can make it has blown up


@dataclass(frozen=True)
class _Start:
    """Initial state, as the arguments of `simulate`."""

    x: float
    z: float
    theta: float
    vx: float
    vz: float
    omega: float


def simulate(
    scene: Scene,
    motion: Motion | None = None,
    *,
    t_end: float,
    mu: float,
    damping: float | None = None,
    damping_ratio: float | None = None,
    dt: float = 2.0e-6,
    kn: float = 1.98e7,
    ks: float = 1.98e7,
    onset: str = "overlap",
    coulomb: str = "total",
    x0: float = 0.0,
    gap0: float | None = None,
    theta0: float = 0.0,
    vx0: float = 0.0,
    vz0: float = 0.0,
    omega0: float = 0.0,
    g: float = 9.80665,
    save_every: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> History:
    """Simulate `scene` on a base that moves with `motion`, until it falls (|theta| reaches pi/2) or t_end.

    motion: called with times [s], float64, shape (step,); returns (a_x, a_z) of the base [m/s^2], each of that
        shape; None is a base at rest. It must not pitch: `dem.simulate_assembly` carries a base that does
    t_end, dt: duration and step [s]; the run ends with the first step at or after t_end
    mu: friction coefficient, 0 to math.inf
    damping: dashpot of a corner c, normal and shear [N s/m]; or instead damping_ratio = c/(2 sqrt(kn m))
    kn, ks: stiffness of a corner, normal and shear [N/m]
    onset: 'overlap': F_n of a new contact is kn times the overlap, and slip and dashpots count from the touching;
        'incremental': forces grow by the whole step that finds the contact, as in the paper
    coulomb: 'total': friction reaches mu times spring and dashpot together; 'spring': mu times the spring's force
    x0, theta0, vx0, vz0, omega0: centroid to the right of the base's middle [m], tilt [rad] and velocities relative
        to the base [m/s, rad/s] at t = 0
    gap0: lowest corner above the floor [m], negative pressed in; None presses the lowest corners in by the weight
        divided by their number. Corners below the floor at the start carry kn times their overlap and no shear
    g: gravity [m/s^2]; save_every: steps between samples (default: about 2,000 samples in all)
    progress: called with the time reached [s] after each chunk of 50,000 steps

    Raises ValueError for a bad argument, for a motion that has the wrong shape, is not finite or pitches, and for dt
    at or above the body's critical step (`dem.critical_step`).
    """
    checks.kind("scene", scene, Scene, "a Scene, as single_block(b, h, d, density) makes it")
    check_motion(motion)
    mass = scene.mass
    for name, value, unit in (("t_end", t_end, "s"), ("dt", dt, "s"), ("kn", kn, "N/m"), ("ks", ks, "N/m")):
        checks.positive(name, value, unit)
    checks.positive("g", g, "m/s^2")
    c = _dashpot(damping, damping_ratio, 2.0 * math.sqrt(kn * mass))
    checks.friction("mu", mu)
    if onset not in ("overlap", "incremental"):
        raise ValueError(f"onset={onset!r}: want 'overlap' or 'incremental'")
    if coulomb not in ("total", "spring"):
        raise ValueError(f"coulomb={coulomb!r}: want 'total' or 'spring'")
    _check_start(x0, theta0, vx0, vz0, omega0)
    limit = critical_step(scene, kn, ks, c)
    if dt >= limit:
        raise ValueError(f"dt={dt} s: want a step below {limit:.6g} s, where this body becomes unstable")
    if t_end / dt > MOST_STEPS:
        raise ValueError(f"t_end={t_end} s, dt={dt} s: want at most {MOST_STEPS:g} steps")
    last_step = max(1, math.ceil(t_end / dt * (1.0 - 1e-12)))
    if save_every is None:
        save_every = max(1, last_step // SAMPLES)
    save_every = checks.whole("save_every", save_every, 1)
    # One that says of itself that it has no pitch, as those of `excitation` do, need not be asked at every step.
    if pitches(motion) and getattr(motion, "has_pitch", True):
        for first in range(0, last_step + 1, CHUNK):
            refuse_pitch(motion, _times(first, last_step, dt))
    start = _Start(x0, _initial_height(scene, theta0, gap0, kn, g), theta0, vx0, vz0, omega0)
    settings: dict[str, float | str] = {
        "dt": dt, "t_end": t_end, "kn": kn, "ks": ks, "damping": c, "damping_ratio": c / (2.0 * math.sqrt(kn * mass)),
        "mu": mu, "g": g, "onset": onset, "coulomb": coulomb, "x0": x0, "z0": start.z, "theta0": theta0, "vx0": vx0,
        "vz0": vz0, "omega0": omega0, "save_every": int(save_every),
    }  # fmt: skip
    return _Run(scene, start, settings, last_step).through(motion, progress)


class _Run:
    """Arrays that the compiled loop carries from chunk to chunk."""

    def __init__(self, scene: Scene, start: _Start, settings: dict[str, float | str], last_step: int) -> None:
        contact_law, step = _compiled_modules()
        shape = scene.shape
        self.step, self.scene, self.settings = step, scene, settings
        self.dt, self.save_every, self.last_step = float(settings["dt"]), int(settings["save_every"]), last_step
        kn, ks, c, mu, g = (float(settings[name]) for name in ("kn", "ks", "damping", "mu", "g"))
        self.law = contact_law.Law(kn, ks, c, mu, settings["onset"] == "overlap", settings["coulomb"] == "spring")
        mass, inertia = scene.mass, scene.inertia
        self.body = step.Body(mass, inertia, 1.0 / mass, 1.0 / inertia, shape.radius, g, *shape.theta_c)
        self.corners = np.array(shape.corners)
        self.kept = np.zeros((len(self.corners), 5))
        self.state = np.zeros(step.STATE_SIZE)
        self.state[:6] = (start.x, start.z, start.theta, start.vx, start.vz, start.omega)
        self.state[6:10] = (start.x, start.z, math.cos(start.theta), math.sin(start.theta))
        beyond = start.theta >= shape.theta_c[0] or -start.theta >= shape.theta_c[1]
        self.state[step.CROSSED_AT] = 0.0 if beyond else math.nan
        self.counts = np.array([0, 1, 0, 0])
        self.seconds, self.at_crossing = np.zeros(6), np.zeros(6)
        self.rows = np.empty((last_step // self.save_every + 2, step.COLUMNS))
        self.speed = _natural_speed(scene, start, kn, g)

    def through(self, motion: Motion | None, progress: Callable[[float], object] | None) -> History:
        """All chunks, one after the other."""
        step = self.step
        for a_x, a_z in self._base(motion):
            # Forces of the base cannot add more speed than the time integral of its acceleration.
            self.speed += self.dt * float(np.abs(a_x).sum() + np.abs(a_z).sum())
            limit = HEADROOM * self.speed
            clock = step.Clock(self.dt, self.last_step, self.save_every, limit, OMEGA_STILL)
            ending = uninterrupted(
                step.advance, a_x, a_z, self.body, self.law, clock, self.corners, self.kept, self.state, self.counts,
                self.seconds, self.at_crossing, self.rows,
            )  # fmt: skip
            if progress is not None:
                progress(float(self.counts[step.STEP]) * self.dt)
            if ending != step.RUNNING:
                break
        return self._history(ending, motion)

    def _base(self, motion: Motion | None) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Base accelerations chunk by chunk."""
        for first in range(0, self.last_step + 1, CHUNK):
            yield accelerations(motion, _times(first, self.last_step, self.dt))

    def _history(self, ending: int, motion: Motion | None) -> History:
        step, state = self.step, self.state
        rows = self.rows[: self.counts[step.SAVED]].copy()
        theta = float(state[step.THETA])
        outcome = self._outcome(ending, theta)
        fell = outcome is Outcome.OVERTURNED
        time, x, z, theta_at, omega = (column.copy() for column in rows.T[:5])
        base_ax, base_az = accelerations(motion, time)
        return History(
            time=time,
            x=x,
            z=z,
            theta=theta_at,
            omega=omega,
            base_ax=base_ax,
            base_az=base_az,
            energies=Energies(*(column.copy() for column in rows.T[5:12])),
            mode_clock=rows[:, 12:],
            outcome=outcome,
            side=(1 if theta > 0.0 else -1) if fell else 0,
            end_time=float(self.counts[step.STEP]) * self.dt,
            overturning_time=float(state[step.CROSSED_AT]) if fell else math.nan,
            mode_seconds=self.seconds,
            mode_seconds_to_overturning=self.at_crossing if fell else np.full(6, math.nan),
            scene=self.scene,
            settings=self.settings,
        )

    def _outcome(self, ending: int, theta: float) -> Outcome:
        step = self.step
        if ending == step.BLOWN_UP:
            return Outcome.UNSTABLE
        if ending == step.FALLEN:
            return Outcome.OVERTURNED
        vx, vz, omega = np.abs(self.state[3:6])
        on_a_side = self.counts[step.LAST_MODE] in (Mode.REST, Mode.SLIDE)
        if not (on_a_side and vx + vz + self.body.radius * omega < SPEED_AT_REST):
            return Outcome.MOVING
        right, left = self.scene.shape.theta_c
        return Outcome.AT_REST if -left < theta < right else Outcome.OVERTURNED


def _times(first: int, last: int, dt: float) -> FloatArray:
    """Times [s] of a chunk of steps from the first on."""
    return np.arange(first, min(first + CHUNK, last + 1), dtype=np.float64) * dt


def _compiled_modules() -> tuple[ModuleType, ModuleType]:
    """Contact law and step, imported when a run starts since numba is slow to load."""
    from dem import contact_law, step

    return contact_law, step


def _dashpot(damping: float | None, damping_ratio: float | None, critical: float) -> float:
    """c [N s/m] from exactly one of the two ways to give it."""
    if (damping is None) == (damping_ratio is None):
        raise ValueError(f"damping={damping}, damping_ratio={damping_ratio}: want exactly one of the two")
    if damping_ratio is None:
        assert damping is not None
        checks.not_negative("damping", damping, "N s/m")
        return damping
    checks.not_negative("damping_ratio", damping_ratio, "(share of critical)")
    return damping_ratio * critical


def _check_start(x0: float, theta0: float, vx0: float, vz0: float, omega0: float) -> None:
    checks.finite("x0", x0, "m")
    checks.finite("vx0", vx0, "m/s")
    checks.finite("vz0", vz0, "m/s")
    checks.finite("omega0", omega0, "rad/s")
    if not abs(checks.real(theta0)) < 0.5 * math.pi:
        raise ValueError(f"theta0={theta0} rad: want a tilt between -pi/2 and pi/2")


def _initial_height(scene: Scene, theta: float, gap: float | None, kn: float, g: float) -> float:
    """Centroid above the floor [m] for the gap, or for the lowest corners pressed in by the weight."""
    corners = scene.shape.corners
    heights = corners[:, 1] * math.cos(theta) - corners[:, 0] * math.sin(theta)
    lowest = float(heights.min())
    if gap is None:
        carrying = int((heights < lowest + 1e-9 * scene.shape.radius).sum())
        gap = -scene.mass * g / (carrying * kn)
    checks.finite("gap0", gap, "m")
    return gap - lowest


def _natural_speed(scene: Scene, start: _Start, kn: float, g: float) -> float:
    """Speed [m/s] that the initial motion, a fall and the springs pressed in at the start can make together."""
    radius = scene.shape.radius
    fall = math.sqrt(2.0 * g * (abs(start.z) + 2.0 * radius))
    pressed = max(0.0, radius - start.z) * math.sqrt(kn * len(scene.shape.corners) / scene.mass)
    return abs(start.vx) + abs(start.vz) + radius * abs(start.omega) + fall + pressed
