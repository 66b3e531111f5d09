"""One body in a step: sum of its contacts, kick, fall and ledger, drift, corners. Nothing here knows contacts.

Source  leap-frog: positions at k dt, velocities at (k - 1/2) dt; Newton in the frame of a table that moves and pitches
Status  energy ledgers close; a tilting table against the inertial frame (tests)

With q the place from the point about which the table pitches, clockwise at the rate W, and the table's axes,

    q'' = F/m - (a + g e_z, turned into the table's axes) - 2 W J q' - W' J q + W^2 q,   J q = (q_z, -q_x)
    theta'' = M/I - W'

The term in q' is solved for the mean of the two velocities and does no work. Energy: the kinetic one is
m v(k-1/2) v(k+1/2)/2, with which the work of each force over a step is the mean of its two values times the way.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem import arrays as q
from dem.compiled import hot
from dem.contact_forces import book

FINE, FALLEN, LEFT, BLOWN_UP = 0, 2, 3, 4
SYNCHRONISE = 64  # steps between direction cosines computed anew from the angle


class Field(NamedTuple):
    """The table's frame at each step: acceleration and gravity in its axes [m/s^2], pitch rate [rad/s] and its
    derivative [rad/s^2], arrays of shape (step,); point of pitch [m]; whether it pitches."""

    x: np.ndarray
    z: np.ndarray
    rate: np.ndarray
    turn: np.ndarray
    about_x: float
    about_z: float
    pitches: bool


class Limits(NamedTuple):
    """speed beyond which a run has blown up [m/s]; where bodies may be: x from, to, z from, to [m]; rotation that is a
    fall [rad]; sinking that is one, shape (body,) [m]; share of unbalanced force taken away while settling."""

    speed: float
    x_low: float
    x_high: float
    z_low: float
    z_high: float
    tilt: float
    drop: np.ndarray
    settling: float


@hot
def gather(lists, b, saving):
    """Sums over the pairs of body b: forces, moment, energies lost in pairs it is first of, elastic energy there."""
    fx, fz, moment, dashpot, friction, onset, elastic = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for m in range(lists.of_body[b], lists.of_body[b + 1]):
        load = lists.load[lists.at[m]]
        if lists.pair[q.FIRST, lists.at[m]] == b:
            fx, fz, moment = fx + load[q.FORCE_X], fz + load[q.FORCE_Z], moment + load[q.MOMENT_FIRST]
            dashpot, friction = dashpot + load[q.LOST_DASHPOT], friction + load[q.LOST_FRICTION]
            onset = onset + load[q.LOST_ONSET]
            if saving:
                elastic += load[q.IN_SPRINGS]
        else:
            fx, fz, moment = fx - load[q.FORCE_X], fz - load[q.FORCE_Z], moment + load[q.MOMENT_SECOND]
    return fx, fz, moment, dashpot, friction, onset, elastic


@hot
def frame(bodies, b, field, j):
    """Acceleration of the table's frame at body b, gravity in it, the term in the velocity left out."""
    if not field.pitches:
        return field.x[j], field.z[j], 0.0
    q_x, q_z = bodies[q.X, b] - field.about_x, bodies[q.Z, b] - field.about_z
    rate, turn = field.rate[j], field.turn[j]
    return (
        field.x[j] + turn * q_z - rate * rate * q_x,
        field.z[j] - turn * q_x - rate * rate * q_z,
        turn,
    )


@hot
def kicked(vx, vz, ax, az, whirl, dt):
    """Velocities dt later; whirl: pitch rate [rad/s]."""
    if whirl == 0.0:
        return vx + dt * ax, vz + dt * az
    w = dt * whirl
    r_x, r_z = vx - w * vz + dt * ax, vz + w * vx + dt * az
    return (r_x - w * r_z) / (1.0 + w * w), (r_z + w * r_x) / (1.0 + w * w)


@hot
def held_back(acceleration, speed, share):
    """Cundall's local damping: a share of what is left over works against the motion."""
    if speed == 0.0:
        return acceleration
    return acceleration - math.copysign(share * abs(acceleration), speed)


@hot
def watch_fall(bodies, b, limits, time):
    """Note when the balance is passed outwards and when the body has fallen; True when it falls just now."""
    turned = bodies[q.THETA, b] - bodies[q.START_THETA, b]
    beyond_right, beyond_left = turned >= bodies[q.TILT_RIGHT, b], -turned >= bodies[q.TILT_LEFT, b]
    if beyond_right or beyond_left:
        if bodies[q.BEYOND, b] == 0.0:
            bodies[q.BEYOND, b] = 1.0
            past = turned - bodies[q.TILT_RIGHT, b] if beyond_right else turned + bodies[q.TILT_LEFT, b]
            bodies[q.CROSSED, b] = time - (
                past / bodies[q.OMEGA, b] if time > 0.0 and bodies[q.OMEGA, b] != 0.0 else 0.0
            )
    else:
        bodies[q.BEYOND, b] = 0.0
    if bodies[q.FELL, b] == bodies[q.FELL, b]:
        return False
    if abs(turned) >= limits.tilt or bodies[q.Z, b] < bodies[q.START_Z, b] - limits.drop[b]:
        bodies[q.FELL, b] = time
        return True
    return False


@hot
def verdict(bodies, b, limits):
    """Has the body blown up or left the scene? Comparisons are such that nan counts."""
    speed = abs(bodies[q.VX, b]) + abs(bodies[q.VZ, b]) + bodies[q.RADIUS, b] * abs(bodies[q.OMEGA, b])
    if not speed < limits.speed:
        return BLOWN_UP
    inside = limits.x_low < bodies[q.X, b] < limits.x_high and limits.z_low < bodies[q.Z, b] < limits.z_high
    return FINE if inside else LEFT


@hot
def turn_and_place(bodies, outline, b, angle, synchronise):
    """Direction cosines after turning by a small angle, and corners and normals there."""
    c, s = bodies[q.COS, b], bodies[q.SIN, b]
    if synchronise or abs(angle) > 0.01:
        c, s = math.cos(bodies[q.THETA, b]), math.sin(bodies[q.THETA, b])
    else:  # series to 1e-16 for 0.01 rad
        square = angle * angle
        dc = -square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
        ds = angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))
        c, s = c + (c * dc - s * ds), s + (s * dc + c * ds)
    bodies[q.COS, b], bodies[q.SIN, b] = c, s
    x, z = bodies[q.X, b], bodies[q.Z, b]
    for i in range(outline.span[q.FROM, b], outline.span[q.FROM, b] + outline.span[q.COUNT, b]):
        outline.place[q.AT_X, i] = x + (outline.place[q.LOCAL_X, i] * c + outline.place[q.LOCAL_Z, i] * s)
        outline.place[q.AT_Z, i] = z + (outline.place[q.LOCAL_Z, i] * c - outline.place[q.LOCAL_X, i] * s)
        outline.place[q.N_X, i] = outline.place[q.LOCAL_NX, i] * c + outline.place[q.LOCAL_NZ, i] * s
        outline.place[q.N_Z, i] = outline.place[q.LOCAL_NZ, i] * c - outline.place[q.LOCAL_NX, i] * s


@hot
def energies(bodies, b, vx, vz, omega, g, elastic):
    """Kinetic and potential energy of body b from the velocities before and those now in `bodies`."""
    bodies[q.KINETIC, b] = 0.5 * (
        bodies[q.MASS, b] * (vx * bodies[q.VX, b] + vz * bodies[q.VZ, b])
        + bodies[q.INERTIA, b] * omega * bodies[q.OMEGA, b]
    )
    bodies[q.POTENTIAL, b] = bodies[q.MASS, b] * g * bodies[q.Z, b]
    bodies[q.ELASTIC, b] = elastic


@hot
def kick_body(bodies, lists, b, field, j, limits, dt, g, first_step, saving):
    """Velocities half a step after the pose, ledgers, and at a sample the energies; returns the velocities before."""
    fx, fz, moment, dashpot, friction, onset, elastic = gather(lists, b, saving)
    bodies[q.DASHPOT, b] += dashpot
    bodies[q.FRICTION, b] += friction
    bodies[q.ONSET, b] += onset
    frame_x, frame_z, frame_turn = frame(bodies, b, field, j)
    vx, vz, omega = bodies[q.VX, b], bodies[q.VZ, b], bodies[q.OMEGA, b]
    ax = fx * bodies[q.PER_MASS, b] - frame_x
    az = fz * bodies[q.PER_MASS, b] - frame_z
    turn = moment * bodies[q.PER_INERTIA, b] - frame_turn
    bodies[q.UNBALANCE, b] = (abs(ax) + abs(az) + bodies[q.RADIUS, b] * abs(turn)) / g
    if limits.settling > 0.0:
        ax, az = held_back(ax, vx, limits.settling), held_back(az, vz, limits.settling)
        turn = held_back(turn, omega, limits.settling)
    whirl = field.rate[j] if field.pitches else 0.0
    if first_step:  # the initial velocities are those at the pose: half a step back
        vx, vz = kicked(vx, vz, ax, az, whirl, -0.5 * dt)
        omega -= 0.5 * dt * turn
    else:
        bodies[q.WORK, b] -= bodies[q.MASS, b] * (
            book(bodies[q.FIELD_X, b], frame_x, dt * vx) + book(bodies[q.FIELD_Z, b] - g, frame_z - g, dt * vz)
        ) + bodies[q.INERTIA, b] * book(bodies[q.FIELD_TURN, b], frame_turn, dt * omega)
    bodies[q.FIELD_X, b], bodies[q.FIELD_Z, b], bodies[q.FIELD_TURN, b] = frame_x, frame_z, frame_turn
    bodies[q.VX, b], bodies[q.VZ, b] = kicked(vx, vz, ax, az, whirl, dt)
    bodies[q.OMEGA, b] = omega + dt * turn
    if saving:
        energies(bodies, b, vx, vz, omega, g, elastic)
    return vx, vz, omega


@hot
def drift_body(bodies, outline, b, dt, synchronise):
    """Pose a step later; returns how far it may have come since the contacts were listed [m]."""
    bodies[q.X, b] += dt * bodies[q.VX, b]
    bodies[q.Z, b] += dt * bodies[q.VZ, b]
    angle = dt * bodies[q.OMEGA, b]
    bodies[q.THETA, b] += angle
    turn_and_place(bodies, outline, b, angle, synchronise)
    return (
        abs(bodies[q.X, b] - bodies[q.LISTED_X, b])
        + abs(bodies[q.Z, b] - bodies[q.LISTED_Z, b])
        + bodies[q.RADIUS, b] * abs(bodies[q.THETA, b] - bodies[q.LISTED_THETA, b])
    )
