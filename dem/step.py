"""The time step: pose, corner forces, kick, mode, record, drift; and the compiled loop over steps.

Source  Winkler, Meguro & Yamazaki (1995), Fig. 9 (cycle of the computation); leap-frog: positions at k dt,
        velocities at (k - 1/2) dt
Status  energy balance closes; mirror image gives the mirrored bits (tests)

Energy. With the kinetic energy taken as m v(k-1/2) v(k+1/2)/2, the work of every force over the step from k-1 to k
is exactly the mean of its two values times the way between. Each ledger below adds that: `dashpot` and `friction`
lose it, `base` gains it, and `onset` takes what the force law itself makes or loses where a corner lands or leaves
inside a step (a spring that starts with F_n = kn overlap has not been fed over the whole step). What is left open is
that the lever of a corner turns within the step, of second order in dt.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba

from dem.compiled import compiled
from dem.contact_law import clipped, friction_limit, normal_spring, normal_total, shear_total

RUNNING, FALLEN, BLOWN_UP, ENDED = 0, 1, 2, 3  # how a chunk of steps ended
REST, SLIDE, ROTATION, SLIDE_ROTATION, TRANSLATION_JUMP, ROTATION_JUMP = range(6)
# Columns kept per corner from step to step.
SPRING_N, SPRING_S, DASHPOT_N, DASHPOT_S, TOUCHING = range(5)
# Entries of `state` between chunks, and of `counts`.
X, Z, THETA, VX, VZ, OMEGA, LAST_X, LAST_Z, LAST_COS, LAST_SIN, LAST_AX, LAST_AZ = range(12)
W_DASHPOT, W_FRICTION, W_ONSET, W_BASE, CROSSED_AT = 12, 13, 14, 15, 16
STATE_SIZE = 17
STEP, UNTIL_SAVE, SAVED, LAST_MODE = range(4)
COLUMNS = 18  # columns of a saved row: t, x, z, theta, omega, then the seven energies and the seconds in each mode


class Body(NamedTuple):
    """mass [kg], inertia [kg m^2] and their reciprocals, radius to the farthest corner [m], g [m/s^2],
    theta_c to +x and -x [rad]."""

    mass: float
    inertia: float
    per_mass: float
    per_inertia: float
    radius: float
    g: float
    tilt_right: float
    tilt_left: float


class Clock(NamedTuple):
    """dt [s]; last step; steps between saved rows; speed beyond which the run has blown up [m/s];
    angular velocity below which a jump counts as one of translation [rad/s]."""

    dt: float
    last_step: int
    save_every: int
    speed_limit: float
    still: float


class Pose(NamedTuple):
    """Centroid [m] and direction of the body."""

    x: float
    z: float
    cos: float
    sin: float


class Rate(NamedTuple):
    """Velocities [m/s] and angular velocity, clockwise [rad/s]."""

    vx: float
    vz: float
    omega: float


class Load(NamedTuple):
    """Sums over the corners: forces [N], clockwise moment [N m], corners that press and that slide,
    and this step's entries of the energy ledgers [J]."""

    fx: float
    fz: float
    moment: float
    pressing: int
    sliding: int
    dashpot: float
    friction: float
    onset: float


@numba.njit
def book(old: float, new: float, way: float) -> float:
    """Work over a way [m] of a force [N] that goes from old to new."""
    return 0.5 * (old + new) * way


@numba.njit
def press_corner(kept, i, law, overlap, approach, slip, v_n, v_t, first):
    """Contact law at corner i, which touches or has just left; updates its row of `kept`, returns (N, T, slides,
    energies lost to dashpot, friction, onset)."""
    fn_old, fs_old = kept[i, SPRING_N], kept[i, SPRING_S]
    fn, normal, trial, fs, shear, slides = 0.0, 0.0, fs_old - law.ks * slip, 0.0, 0.0, False
    fresh = kept[i, TOUCHING] == 0.0
    if overlap > 0.0:
        fn, acting = normal_spring(fn_old, approach, law), 1.0
        if fresh and (law.onset_overlap or first):
            fn = law.kn * overlap
            if approach > overlap:  # it touched inside this step: slip and dashpots count from there
                part = overlap / approach
                trial, acting = -law.ks * slip * part, 0.5 + part  # the force acts until half a step from now
        normal = normal_total(fn, v_n * acting, law)
        limit = friction_limit(fn, normal, law)
        fs = clipped(trial, limit)
        slides = abs(trial) > limit
        shear = shear_total(fs, v_t * acting, limit, slides, law)
    dn, ds = normal - fn, shear - fs
    dashpot = book(kept[i, DASHPOT_N], dn, approach) - book(kept[i, DASHPOT_S], ds, slip)
    friction, onset = 0.0, 0.0
    if trial != fs:
        friction = book(fs_old, fs, (trial - fs) / law.ks)
    if (fresh or fn == 0.0) and not first:  # elsewhere the spring has taken up just what the body gave
        onset = book(fn_old, fn, approach - (fn - fn_old) / law.kn)
        onset -= book(fs_old, fs, slip + (trial - fs_old) / law.ks)
    kept[i, SPRING_N], kept[i, SPRING_S], kept[i, DASHPOT_N], kept[i, DASHPOT_S] = fn, fs, dn, ds
    kept[i, TOUCHING] = 1.0 if overlap > 0.0 else 0.0
    return normal, shear, slides, dashpot, friction, onset


@numba.njit
def load_corners(corners, kept, law, pose, last, rate, first):
    """Floor forces on all corners: motion of each relative to the floor over the step, then the contact law."""
    fx, fz, moment, pressing, sliding = 0.0, 0.0, 0.0, 0, 0
    dashpot, friction, onset = 0.0, 0.0, 0.0
    for i in range(corners.shape[0]):
        along, up = corners[i, 0], corners[i, 1]
        r_z = up * pose.cos - along * pose.sin
        height = pose.z + r_z
        if height >= 0.0 and kept[i, TOUCHING] == 0.0:
            continue
        r_x = along * pose.cos + up * pose.sin
        # Differences of positions telescope: no drift of the stored forces.
        approach = last.z + (up * last.cos - along * last.sin) - height
        slip = pose.x + r_x - (last.x + (along * last.cos + up * last.sin))
        v_n, v_t = rate.vz - rate.omega * r_x, rate.vx + rate.omega * r_z
        normal, shear, slides, lost_d, lost_f, lost_o = press_corner(
            kept, i, law, -height, approach, slip, v_n, v_t, first
        )
        fx += shear
        fz += normal
        moment += r_z * shear - r_x * normal
        if normal > 0.0:
            pressing += 1
            sliding += slides
        dashpot += lost_d
        friction += lost_f
        onset += lost_o
    return Load(fx, fz, moment, pressing, sliding, dashpot, friction, onset)


@numba.njit
def kick(rate: Rate, load: Load, body: Body, a_x: float, a_z: float, dt: float) -> Rate:
    """Velocities dt later, Newton in the frame of the base; dt may be negative."""
    return Rate(
        rate.vx + dt * (load.fx * body.per_mass - a_x),
        rate.vz + dt * (load.fz * body.per_mass - (body.g + a_z)),
        rate.omega + dt * (load.moment * body.per_inertia),
    )


@numba.njit
def mode_of(load: Load, omega: float, still: float) -> int:
    """Which of the six modes: by the corners that press, whether one slides, and whether the body turns."""
    if load.pressing == 0:
        return TRANSLATION_JUMP if abs(omega) < still else ROTATION_JUMP
    slides = 1 if load.sliding > 0 else 0
    return (REST if load.pressing > 1 else ROTATION) + slides


@numba.njit
def share_to_balance(theta: float, after: float, body: Body) -> float:
    """Share of the step at which the tilt passes its balance outwards; negative if it does not."""
    if theta < body.tilt_right <= after:
        return (body.tilt_right - theta) / (after - theta)
    if -theta < body.tilt_left <= -after:
        return (body.tilt_left + theta) / (theta - after)
    return -1.0


@numba.njit
def save(row, t, pose, theta, before, after, kept, ledger, seconds, body, law):
    """One row of the history at the time of the positions."""
    elastic = 0.0
    for i in range(kept.shape[0]):
        elastic += 0.5 * (kept[i, SPRING_N] ** 2 / law.kn + kept[i, SPRING_S] ** 2 / law.ks)
    row[0], row[1], row[2], row[3] = t, pose.x, pose.z, theta
    row[4] = 0.5 * (before.omega + after.omega)
    row[5] = 0.5 * (
        body.mass * (before.vx * after.vx + before.vz * after.vz) + body.inertia * before.omega * after.omega
    )
    row[6] = body.mass * body.g * pose.z
    row[7] = elastic
    row[8], row[9], row[10], row[11] = ledger
    row[12:] = seconds


def _advance(a_x, a_z, body, law, clock, corners, kept, state, counts, seconds, at_crossing, rows):
    """Run one chunk of steps with base accelerations a_x, a_z [m/s^2], shape (step,); returns how it ended.

    Everything from `kept` on is carried between chunks and updated in place.
    """
    dt = clock.dt
    theta = state[THETA]
    rate = Rate(state[VX], state[VZ], state[OMEGA])
    x, z = state[X], state[Z]
    last = Pose(state[LAST_X], state[LAST_Z], state[LAST_COS], state[LAST_SIN])
    base_x, base_z = state[LAST_AX], state[LAST_AZ]
    dashpot, friction, onset = state[W_DASHPOT], state[W_FRICTION], state[W_ONSET]
    base = state[W_BASE]
    step, until_save, saved, mode = counts[STEP], counts[UNTIL_SAVE], counts[SAVED], counts[LAST_MODE]
    ending = RUNNING
    for j in range(a_x.size):
        pose = Pose(x, z, math.cos(theta), math.sin(theta))
        load = load_corners(corners, kept, law, pose, last, rate, step == 0)
        dashpot += load.dashpot
        friction += load.friction
        onset += load.onset
        base -= body.mass * (book(base_x, a_x[j], x - last.x) + book(base_z, a_z[j], z - last.z))
        base_x, base_z = a_x[j], a_z[j]
        if step == 0:  # the initial velocities are those at t = 0: half a step back
            rate = kick(rate, load, body, base_x, base_z, -0.5 * dt)
        before = rate
        rate = kick(rate, load, body, base_x, base_z, dt)
        mode = mode_of(load, rate.omega, clock.still)

        if not abs(rate.vx) + abs(rate.vz) + body.radius * abs(rate.omega) < clock.speed_limit:
            ending = BLOWN_UP  # also where it is not a number
        elif abs(theta) >= 0.5 * math.pi:
            ending = FALLEN
        elif step == clock.last_step:
            ending = ENDED
        until_save -= 1
        if until_save == 0 or ending != RUNNING:
            ledger = (dashpot, friction, onset, base)
            save(rows[saved], step * dt, pose, theta, before, rate, kept, ledger, seconds, body, law)
            saved += 1
            until_save = clock.save_every
        if ending != RUNNING:
            break

        last = pose
        x += dt * rate.vx
        z += dt * rate.vz
        turned = theta + dt * rate.omega
        share = share_to_balance(theta, turned, body)
        if share >= 0.0:
            state[CROSSED_AT] = (step + share) * dt
            at_crossing[:] = seconds
            at_crossing[mode] += share * dt
        seconds[mode] += dt
        theta = turned
        step += 1

    state[X], state[Z], state[THETA] = x, z, theta
    state[VX], state[VZ], state[OMEGA] = rate.vx, rate.vz, rate.omega
    state[LAST_X], state[LAST_Z], state[LAST_COS], state[LAST_SIN] = last.x, last.z, last.cos, last.sin
    state[LAST_AX], state[LAST_AZ] = base_x, base_z
    state[W_DASHPOT], state[W_FRICTION], state[W_ONSET], state[W_BASE] = dashpot, friction, onset, base
    counts[STEP], counts[UNTIL_SAVE], counts[SAVED], counts[LAST_MODE] = step, until_save, saved, mode
    return ending


advance = compiled(_advance)
