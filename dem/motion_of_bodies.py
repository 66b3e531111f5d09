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
from dem.contact_forces import book, index

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
        p = index(lists.at[index(m)])
        load = lists.load[p]
        if lists.pair[q.FIRST, p] == b:
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
    own = index(b)
    if not field.pitches:
        return field.x[j], field.z[j], 0.0
    q_x, q_z = bodies[q.X, own] - field.about_x, bodies[q.Z, own] - field.about_z
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
    own = index(b)
    if bodies[q.FELL, own] == bodies[q.FELL, own]:  # what it does later no longer counts
        return False
    turned = bodies[q.THETA, own] - bodies[q.START_THETA, own]
    beyond_right, beyond_left = turned >= bodies[q.TILT_RIGHT, own], -turned >= bodies[q.TILT_LEFT, own]
    if beyond_right or beyond_left:
        if bodies[q.BEYOND, own] == 0.0:
            bodies[q.BEYOND, own] = 1.0
            past = turned - bodies[q.TILT_RIGHT, own] if beyond_right else turned + bodies[q.TILT_LEFT, own]
            bodies[q.CROSSED, own] = time - (
                past / bodies[q.OMEGA, own] if time > 0.0 and bodies[q.OMEGA, own] != 0.0 else 0.0
            )
    else:
        bodies[q.BEYOND, own] = 0.0
    if abs(turned) >= limits.tilt or bodies[q.Z, own] < bodies[q.START_Z, own] - limits.drop[b]:
        bodies[q.FELL, own] = time
        return True
    return False


@hot
def verdict(bodies, b, limits):
    """Has the body blown up or left the scene? Comparisons are such that nan counts."""
    own = index(b)
    speed = abs(bodies[q.VX, own]) + abs(bodies[q.VZ, own]) + bodies[q.RADIUS, own] * abs(bodies[q.OMEGA, own])
    if not speed < limits.speed:
        return BLOWN_UP
    inside = limits.x_low < bodies[q.X, own] < limits.x_high and limits.z_low < bodies[q.Z, own] < limits.z_high
    return FINE if inside else LEFT


@hot
def turn_and_place(bodies, outline, b, angle, synchronise):
    """Direction cosines after turning by a small angle, and corners and normals there."""
    own = index(b)
    c, s = bodies[q.COS, own], bodies[q.SIN, own]
    if synchronise or abs(angle) > 0.01:
        c, s = math.cos(bodies[q.THETA, own]), math.sin(bodies[q.THETA, own])
    else:  # series to 1e-16 for 0.01 rad
        square = angle * angle
        dc = -square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
        ds = angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))
        c, s = c + (c * dc - s * ds), s + (s * dc + c * ds)
    bodies[q.COS, own], bodies[q.SIN, own] = c, s
    x, z = bodies[q.X, own], bodies[q.Z, own]
    for corner in range(outline.span[q.FROM, b], outline.span[q.FROM, b] + outline.span[q.COUNT, b]):
        i = index(corner)
        outline.place[q.AT_X, i] = x + (outline.place[q.LOCAL_X, i] * c + outline.place[q.LOCAL_Z, i] * s)
        outline.place[q.AT_Z, i] = z + (outline.place[q.LOCAL_Z, i] * c - outline.place[q.LOCAL_X, i] * s)
        outline.place[q.N_X, i] = outline.place[q.LOCAL_NX, i] * c + outline.place[q.LOCAL_NZ, i] * s
        outline.place[q.N_Z, i] = outline.place[q.LOCAL_NZ, i] * c - outline.place[q.LOCAL_NX, i] * s


@hot
def energies(bodies, b, vx, vz, omega, g, elastic):
    """Kinetic and potential energy of body b from the velocities before and those now in `bodies`."""
    own = index(b)
    bodies[q.KINETIC, own] = 0.5 * (
        bodies[q.MASS, own] * (vx * bodies[q.VX, own] + vz * bodies[q.VZ, own])
        + bodies[q.INERTIA, own] * omega * bodies[q.OMEGA, own]
    )
    bodies[q.POTENTIAL, own] = bodies[q.MASS, own] * g * bodies[q.Z, own]
    bodies[q.ELASTIC, own] = elastic


@hot
def kick_body(bodies, lists, b, field, j, limits, dt, g, first_step, saving):
    """Velocities half a step after the pose, ledgers, and at a sample the energies; returns the velocities before."""
    own = index(b)
    fx, fz, moment, dashpot, friction, onset, elastic = gather(lists, b, saving)
    bodies[q.DASHPOT, own] += dashpot
    bodies[q.FRICTION, own] += friction
    bodies[q.ONSET, own] += onset
    frame_x, frame_z, frame_turn = frame(bodies, b, field, j)
    vx, vz, omega = bodies[q.VX, own], bodies[q.VZ, own], bodies[q.OMEGA, own]
    ax = fx * bodies[q.PER_MASS, own] - frame_x
    az = fz * bodies[q.PER_MASS, own] - frame_z
    turn = moment * bodies[q.PER_INERTIA, own] - frame_turn
    bodies[q.UNBALANCE, own] = (abs(ax) + abs(az) + bodies[q.RADIUS, own] * abs(turn)) / g
    if limits.settling > 0.0:
        ax, az = held_back(ax, vx, limits.settling), held_back(az, vz, limits.settling)
        turn = held_back(turn, omega, limits.settling)
    whirl = field.rate[j] if field.pitches else 0.0
    if first_step:  # the initial velocities are those at the pose: half a step back
        vx, vz = kicked(vx, vz, ax, az, whirl, -0.5 * dt)
        omega -= 0.5 * dt * turn
    else:
        bodies[q.WORK, own] -= bodies[q.MASS, own] * (
            book(bodies[q.FIELD_X, own], frame_x, dt * vx) + book(bodies[q.FIELD_Z, own] - g, frame_z - g, dt * vz)
        ) + bodies[q.INERTIA, own] * book(bodies[q.FIELD_TURN, own], frame_turn, dt * omega)
    bodies[q.FIELD_X, own], bodies[q.FIELD_Z, own], bodies[q.FIELD_TURN, own] = frame_x, frame_z, frame_turn
    bodies[q.VX, own], bodies[q.VZ, own] = kicked(vx, vz, ax, az, whirl, dt)
    bodies[q.OMEGA, own] = omega + dt * turn
    if saving:
        energies(bodies, b, vx, vz, omega, g, elastic)
    return vx, vz, omega


@hot
def drift_body(bodies, outline, b, dt, synchronise):
    """Pose a step later; returns how far it may have come since the contacts were listed [m]."""
    own = index(b)
    bodies[q.X, own] += dt * bodies[q.VX, own]
    bodies[q.Z, own] += dt * bodies[q.VZ, own]
    angle = dt * bodies[q.OMEGA, own]
    bodies[q.THETA, own] += angle
    turn_and_place(bodies, outline, b, angle, synchronise)
    return (
        abs(bodies[q.X, own] - bodies[q.LISTED_X, own])
        + abs(bodies[q.Z, own] - bodies[q.LISTED_Z, own])
        + bodies[q.RADIUS, own] * abs(bodies[q.THETA, own] - bodies[q.LISTED_THETA, own])
    )
