"""The time step of an assembly as a list of stages, and the compiled loop over steps, by one or more workers.

    list contacts (when due) -> press pairs -> watch interfaces -> move bodies -> record, decide

Source  Winkler, Meguro & Yamazaki (1995), Fig. 9
Status  any number of workers gives the same bits; so do lists made anew at every step (tests)

Each worker presses its share of the pairs, waits for the others, moves its share of the bodies, waits again. All sums
run over the pairs of a body in the same order, whoever adds them up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem import arrays as q
from dem.barrier import wait_for_all
from dem.compiled import compiled, inner
from dem.contact_forces import press_pairs
from dem.motion_of_bodies import (
    FALLEN,
    FINE,
    SYNCHRONISE,
    drift_body,
    kick_body,
    verdict,
    watch_fall,
)
from dem.narrow_phase import locate, make_lists

RUNNING, ENDED, NO_ROOM = 0, 1, 5  # how a chunk of steps ended, besides FALLEN, LEFT and BLOWN_UP
# Entries of `counts`: step; steps until the next sample; samples; which of the two lists is in use; 1 when the contacts
# must be listed; 1 in the very first step; times the contacts were listed; what ended the run, found a step before.
STEP, UNTIL_SAVE, SAVED, WHICH, DUE, FIRST, LISTED, FINISHING = range(8)
# What each worker tells the others after moving its bodies, and how far apart.
MOVED, VERDICT, NEWLY_FALLEN, HAD_ROOM = range(4)
APART = 16


class Clock(NamedTuple):
    """dt [s]; last step; steps between samples, and between looks at the interfaces; g [m/s^2]; falls that end the
    run (0: none do)."""

    dt: float
    last_step: int
    save_every: int
    watch_every: int
    g: float
    falls: int


class Opening(NamedTuple):
    """An interface counts as open beyond this gap at a corner [m] or this relative rotation [rad]."""

    gap: float
    rotation: float


@inner
def share_of(total, worker, workers):
    """From, to of a worker's share."""
    return total * worker // workers, total * (worker + 1) // workers


@inner
def watch_interfaces(bodies, outline, watched, opening, reach, time, low, high):
    """Note the time at which an interface is first seen open."""
    for i in range(low, high):
        if watched.opened[i] == watched.opened[i]:
            continue
        turned = bodies[q.THETA, watched.between[i, 1]] - bodies[q.THETA, watched.between[i, 0]] - watched.turn[i]
        gap = 0.0
        for end in range(2):
            if watched.ends[i, end, 0] >= 0:
                d, _ = locate(outline, watched.ends[i, end, 0], watched.ends[i, end, 1], reach)
                gap = max(gap, -d)
        if abs(turned) > opening.rotation or gap > opening.gap:
            watched.opened[i] = time


@inner
def sample(bodies, saved, n, b, vx, vz, omega):
    """Pose and velocity of body b at the time of the pose; vx, vz, omega: half a step before it."""
    column = saved.column[b]
    if column < 0:
        return
    row = saved.motion[n, column]
    row[0], row[1], row[2] = bodies[q.X, b], bodies[q.Z, b], bodies[q.THETA, b]
    row[3], row[4] = 0.5 * (vx + bodies[q.VX, b]), 0.5 * (vz + bodies[q.VZ, b])
    row[5] = 0.5 * (omega + bodies[q.OMEGA, b])


@inner
def sum_energies(bodies, movable, saved, n, time):
    """Energies of a sample, summed over the bodies in their order."""
    row = saved.energy[n]
    row[:] = 0.0
    for b in range(movable):
        row[0] += bodies[q.KINETIC, b]
        row[1] += bodies[q.POTENTIAL, b]
        row[2] += bodies[q.ELASTIC, b]
        row[3] += bodies[q.DASHPOT, b]
        row[4] += bodies[q.FRICTION, b]
        row[5] += bodies[q.ONSET, b]
        row[6] += bodies[q.WORK, b]
    saved.time[n] = time


@inner
def move_bodies(
    bodies, outline, lists, field, j, limits, saved, clock, step, first_step, saving, n, update_after, told, low, high
):
    """Watch, kick, sample and drift bodies low..high; write to `told` whether lists are due and what has happened."""
    worst, moved, fallen = FINE, 0, 0
    for b in range(low, high):
        fallen += watch_fall(bodies, b, limits, step * clock.dt)
        vx, vz, omega = kick_body(bodies, lists, b, field, j, limits, clock.dt, clock.g, first_step, saving)
        worst = max(worst, verdict(bodies, b, limits))
        if saving:
            sample(bodies, saved, n, b, vx, vz, omega)
        way = drift_body(bodies, outline, b, clock.dt, (step + 1) % SYNCHRONISE == 0)
        if not way < update_after:
            moved = 1
    told[MOVED], told[VERDICT], told[NEWLY_FALLEN] = moved, worst, fallen


@inner
def decide(told, workers, fallen_before, falls):
    """What all workers together have found: (lists due, verdict, bodies fallen so far)."""
    due, worst, fallen = 0, FINE, fallen_before
    for w in range(workers):
        due = max(due, told[w * APART + MOVED])
        worst = max(worst, told[w * APART + VERDICT])
        fallen += told[w * APART + NEWLY_FALLEN]
    if worst == FINE and falls > 0 and fallen >= falls:
        worst = FALLEN
    return due, worst, fallen


def _advance_assembly(
    worker, workers, counters, told, field, bodies, outline, lists_a, lists_b, grid, cell, movable, materials,
    judgement, rule, limits, clock, opening, watched, saved, counts,
):  # fmt: skip
    """Run one chunk of steps, one per entry of field.x; returns how it ended.

    Called by each worker with the same arguments but for `worker`; all arrays are updated in place.
    """
    lists, spare, which = lists_a, lists_b, counts[WHICH]
    if which == 1:
        lists, spare = lists_b, lists_a
    step, until_save, n = counts[STEP], counts[UNTIL_SAVE], counts[SAVED]
    due, finishing, fallen = counts[DUE], counts[FINISHING], np.int64(0)
    first_step = counts[FIRST] == 1
    no = np.bool_(False)  # where False itself is given, all is compiled once more for it
    for b in range(movable):
        fallen += bodies[q.FELL, b] == bodies[q.FELL, b]
    low, high = share_of(movable, worker, workers)
    watch_low, watch_high = share_of(watched.opened.size, worker, workers)
    pair_low, pair_high = share_of(lists.size[0], worker, workers)
    until_watch = -step % clock.watch_every
    mine = told[worker * APART :]
    ending, listed = RUNNING, counts[LISTED]
    wait_for_all(counters, worker, workers)  # all have read what the first worker writes in the end
    for j in range(field.x.size):
        if due > 0 and finishing == FINE:
            if worker == 0:
                told[HAD_ROOM] = make_lists(
                    bodies, outline, lists, spare, grid, cell, movable, materials, judgement
                )  # fmt: skip
            wait_for_all(counters, worker, workers)
            if told[HAD_ROOM] == 0:
                ending = NO_ROOM
                break
            lists, spare, which = spare, lists, 1 - which
            pair_low, pair_high = share_of(lists.size[0], worker, workers)
            listed += 1
            due = 0
        until_save -= 1
        if step == clock.last_step and finishing == FINE:
            finishing = ENDED
        saving = until_save == 0 or finishing != FINE
        if first_step or saving:  # two places, lest the compiler copy it into this loop, which it slows down
            press_pairs(
                bodies, outline, lists, pair_low, pair_high, rule, judgement, clock.dt, first_step, saving
            )  # fmt: skip
        else:
            press_pairs(bodies, outline, lists, pair_low, pair_high, rule, judgement, clock.dt, no, no)
        if until_watch == 0:
            until_watch = clock.watch_every
            watch_interfaces(
                bodies, outline, watched, opening, judgement.reach, step * clock.dt, watch_low, watch_high
            )  # fmt: skip
        wait_for_all(counters, worker, workers)
        move_bodies(
            bodies, outline, lists, field, j, limits, saved, clock, step, first_step, saving, n,
            judgement.update_after, mine, low, high,
        )  # fmt: skip
        wait_for_all(counters, worker, workers)
        if saving:
            if worker == 0:
                sum_energies(bodies, movable, saved, n, step * clock.dt)
            n += 1
            until_save = clock.save_every
        first_step = False
        until_watch -= 1
        due, found, fallen = decide(told, workers, fallen, clock.falls)
        step += 1
        if finishing != FINE:
            ending = finishing
            break
        finishing = found
    wait_for_all(counters, worker, workers)
    if worker == 0:
        counts[STEP], counts[UNTIL_SAVE], counts[SAVED], counts[WHICH] = step, until_save, n, which
        counts[DUE], counts[LISTED], counts[FINISHING] = due, listed, finishing
        counts[FIRST] = 1 if first_step else 0
    return ending


advance_assembly = compiled(_advance_assembly, _nrt=False)
