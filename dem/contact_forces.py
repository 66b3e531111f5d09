"""Forces of the contacts of two bodies: what happens to each of their slots in a step, and the sums.

Source  Winkler, Meguro & Yamazaki (1995), Fig. 7 and the section on forces from displacements; after Cundall
Status  momentum kept, energy ledgers close, lever rule, sliding on an incline (tests)

Springs are incremental, F_n by kn times the growth of the overlap and F_s by -ks times the slip, and both are carried
through the hand-over from one variant of a slot to the other. The rules of `dem.contact_law` hold: no tension, no
adhesion (N = F_n + D_n >= 0), Coulomb's limit on N (or on F_n), no shear dashpot while sliding.

Onset. A contact begins a share tau of the step before it is found. How the first step goes is a choice:

- 'located': F_n = kn d, the overlap that there is, but the force acts as (1 + tau)/2 of it, and that of the shear
  spring likewise. Over this step and the next the work of the force is then kn d^2/2, what the spring holds. Where a
  contact ends, a share tau' of the step after it was last seen, it has pushed for too long, and the next step takes
  back half of N (1 - tau'), which closes the work again. Landing and leaving so keep the energy to a higher order in
  dt;
- 'overlap': F_n = kn d, acting in full;
- 'incremental': F_n and F_s grow by the whole step that finds the contact, as in the paper.

A corner that comes from the side, and has not crossed its edge in this step, begins with F_n = kn d. Where a corner at
an end of that edge presses already on one of its own two edges, it joins a contact that holds the bodies apart, and
begins with what the step adds: kn d would be energy from nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem import arrays as q
from dem.compiled import hot, inner
from dem.contact_law import clipped
from dem.narrow_phase import beginning, joins, locate, within

LOCATED, OVERLAPPING, INCREMENTAL = 0, 1, 2
index = np.uintp  # an index that is not negative: numba need not look whether it counts from the end
IDLE, HELD, FRESH, JOINING, HANDED, ENDED, SLID_OFF, GONE = range(8)


class Rule(NamedTuple):
    """onset: one of the three above; limit_on_spring: Coulomb's limit is mu F_n, not mu (F_n + D_n)."""

    onset: int
    limit_on_spring: bool


class Motion(NamedTuple):
    """A contact's motion in the step: overlap and place now; approach and slip that the springs feel; the bodies'
    approach and slip [m]; normal and shear velocity [m/s]."""

    overlap: float
    place: float
    approach: float
    slip: float
    way_n: float
    way_t: float
    v_n: float
    v_t: float


class Force(NamedTuple):
    """Springs F_n, F_s, what acts of them, totals N, T [N]; slip spring's trial force before Coulomb [N]."""

    spring_n: float
    spring_s: float
    acting_n: float
    acting_s: float
    total_n: float
    total_s: float
    trial: float


@inner
def _awakened(bodies, outline, lists, first, last, k, judgement, dt):
    """As `state_of`, of an idle slot."""
    v = beginning(bodies, outline, lists, first, last, k, judgement, dt)
    if v < 0:
        return IDLE, v, 0.0, 0.0
    c, e = lists.slot[k, q.CORNER + v], lists.slot[k, q.EDGE + v]
    d, place = locate(outline, c, e, judgement.reach)
    joining = joins(bodies, outline, lists, first, last, c, e, judgement, dt)
    return JOINING if joining else FRESH, v, d, place


@hot
def state_of(bodies, outline, lists, first, last, k, judgement, dt):
    """(what slot k does in this step, its variant, overlap, place)."""
    v = lists.slot[k, q.ACTIVE]
    if v < 0:
        return _awakened(bodies, outline, lists, first, last, k, judgement, dt)
    e = lists.slot[k, q.EDGE + v]
    d, place = locate(outline, lists.slot[k, q.CORNER + v], e, judgement.reach)
    if lists.kept[k, q.OVERLAP] <= 0.0:  # ended in the step before
        back = d > 0.0 and within(outline, e, place, judgement.end_slack)
        return FRESH if back else GONE, v, d, place
    if d <= 0.0:
        return ENDED, v, d, place
    if within(outline, e, place, judgement.end_slack):
        return HELD, v, d, place
    other = 1 - v
    c, e_other = lists.slot[k, q.CORNER + other], lists.slot[k, q.EDGE + other]
    if c >= 0:
        d_other, place_other = locate(outline, c, e_other, judgement.reach)
        if d_other > 0.0 and within(outline, e_other, place_other, judgement.end_slack):
            return HANDED, other, d_other, place_other
    return HELD if within(outline, e, place, judgement.end_slack + d) else SLID_OFF, v, d, place


@hot
def motion_of(state, kept, d, place, v_n, v_t, dt, first_step):
    """Ways in this step: from positions where the same corner was on the same edge before, else from velocities."""
    if first_step:
        return Motion(d, place, 0.0, 0.0, 0.0, 0.0, v_n, v_t)
    if state in (FRESH, JOINING):
        return Motion(d, place, -v_n * dt, v_t * dt, -v_n * dt, v_t * dt, v_n, v_t)
    approach = d - kept[q.OVERLAP]
    if state == HANDED:
        return Motion(d, place, approach, v_t * dt, -v_n * dt, v_t * dt, v_n, v_t)
    slip = kept[q.PLACE] - place  # the shear direction is that of the edge reversed
    return Motion(d, place, approach, slip, approach, slip, v_n, v_t)


@hot
def pressed(spring_n, trial, share, lasted, motion, law, rule):
    """Law of a contact: `share` of its springs acts; its dashpots have acted for `lasted` steps."""
    c, mu = law[q.DAMPING], law[q.MU]
    acting_n = spring_n * share
    total_n = max(0.0, acting_n - c * motion.v_n * lasted)
    pressure = acting_n if rule.limit_on_spring else total_n
    limit = mu * pressure if pressure > 0.0 else 0.0
    acting_s = clipped(trial * share, limit)
    total_s = acting_s
    if abs(trial * share) <= limit:  # sticking; a sliding corner has no shear dashpot
        total_s = acting_s - c * motion.v_t * lasted
        if not rule.limit_on_spring:
            total_s = clipped(total_s, limit)
    return Force(spring_n, acting_s / share, acting_n, acting_s, total_n, total_s, trial)


@hot
def begun(state, motion, law, rule, first_step):
    """Forces in the first step of a contact."""
    kn, ks = law[q.KN], law[q.KS]
    d, approach = motion.overlap, motion.approach
    if first_step:
        return pressed(kn * d, 0.0, 1.0, 1.0, motion, law, rule)
    if rule.onset == INCREMENTAL or (state == JOINING and approach <= d):
        return pressed(kn * max(0.0, approach), -ks * motion.slip, 1.0, 1.0, motion, law, rule)
    if approach <= d:  # it came from the side, or was there
        return pressed(kn * d, -ks * motion.slip, 1.0, 1.0, motion, law, rule)
    tau = d / approach
    share = 0.5 * (1.0 + tau) if rule.onset == LOCATED else 1.0
    return pressed(kn * d, -ks * motion.slip * tau, share, 0.5 + tau, motion, law, rule)


@hot
def ended(kept, motion, law, rule):
    """No springs any more; what the last step pushed too long is taken back."""
    back = 0.0
    if rule.onset == LOCATED:
        back = 0.5 * motion.overlap / (kept[q.OVERLAP] - motion.overlap)  # -(1 - tau')/2
    n, t = back * kept[q.TOTAL_N], back * kept[q.TOTAL_S]
    return Force(0.0, 0.0, n, t, n, t, kept[q.SPRING_S] - law[q.KS] * motion.slip)


@hot
def force_of(state, kept, motion, law, rule, first_step):
    """Forces of a slot that is not idle."""
    if state in (HELD, HANDED):
        spring = max(0.0, kept[q.SPRING_N] + law[q.KN] * motion.approach)
        return pressed(spring, kept[q.SPRING_S] - law[q.KS] * motion.slip, 1.0, 1.0, motion, law, rule)
    if state in (FRESH, JOINING):
        return begun(state, motion, law, rule, first_step)
    if state == ENDED:
        return ended(kept, motion, law, rule)
    return Force(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, kept[q.SPRING_S])


@hot
def book(old, new, way):
    """Work over a way [m] of a force [N] that goes from old to new."""
    return 0.5 * (old + new) * way


@hot
def losses(state, kept, force, motion, law, first_step):
    """Energies of the step (dashpots, friction, onset) [J]: what the bodies gave and the springs did not take."""
    dashpot = book(kept[q.TOTAL_N] - kept[q.ACTING_N], force.total_n - force.acting_n, motion.way_n)
    dashpot -= book(kept[q.TOTAL_S] - kept[q.ACTING_S], force.total_s - force.acting_s, motion.way_t)
    friction, onset = 0.0, 0.0
    if first_step:
        return dashpot, friction, onset
    if force.trial != force.spring_s:
        friction = book(kept[q.ACTING_S], force.acting_s, (force.trial - force.spring_s) / law[q.KS])
    usual = state == HELD and force.spring_n > 0.0
    if not (usual and kept[q.ACTING_N] == kept[q.SPRING_N] and kept[q.ACTING_S] == kept[q.SPRING_S]):
        onset = book(kept[q.ACTING_N], force.acting_n, motion.way_n)
        onset -= book(kept[q.SPRING_N], force.spring_n, (force.spring_n - kept[q.SPRING_N]) / law[q.KN])
        onset -= book(kept[q.ACTING_S], force.acting_s, motion.way_t) + friction
        onset -= book(kept[q.SPRING_S], force.spring_s, (force.spring_s - kept[q.SPRING_S]) / law[q.KS])
    return dashpot, friction, onset


@hot
def keep(lists, k, state, v, motion, force):
    """Store what the next step needs."""
    kept = lists.kept[k]
    kept[q.OVERLAP], kept[q.PLACE] = motion.overlap, motion.place
    kept[q.SPRING_N], kept[q.SPRING_S] = force.spring_n, force.spring_s
    kept[q.TOTAL_N], kept[q.TOTAL_S] = force.total_n, force.total_s
    kept[q.ACTING_N], kept[q.ACTING_S] = force.acting_n, force.acting_s
    over = state in (GONE, SLID_OFF) or (state == ENDED and force.total_n == 0.0 and force.total_s == 0.0)
    lists.slot[k, q.ACTIVE] = -1 if over else v


@hot
def on_bodies(bodies, outline, lists, k, v, a, b):
    """(fx, fz on body a [N], clockwise moments on a and b [N m]) of slot k from its totals."""
    c, e = lists.slot[k, q.CORNER + v], lists.slot[k, q.EDGE + v]
    n, t = lists.kept[k, q.TOTAL_N], lists.kept[k, q.TOTAL_S]
    if outline.link[q.OWNER, c] != a:
        n, t = -n, -t
    n_x, n_z = outline.place[q.N_X, e], outline.place[q.N_Z, e]
    fx, fz = n * n_x + t * n_z, n * n_z - t * n_x
    x, z = outline.place[q.AT_X, c], outline.place[q.AT_Z, c]
    return (
        fx,
        fz,
        (z - bodies[q.Z, a]) * fx - (x - bodies[q.X, a]) * fz,
        (x - bodies[q.X, b]) * fz - (z - bodies[q.Z, b]) * fx,
    )


@hot
def velocity(bodies, outline, c, e, a, b):
    """(v_n, v_t) of the corner against the edge [m/s]."""
    x, z = outline.place[q.AT_X, c], outline.place[q.AT_Z, c]
    v_x = (
        bodies[q.VX, a]
        + bodies[q.OMEGA, a] * (z - bodies[q.Z, a])
        - bodies[q.VX, b]
        - bodies[q.OMEGA, b] * (z - bodies[q.Z, b])
    )
    v_z = (
        bodies[q.VZ, a]
        - bodies[q.OMEGA, a] * (x - bodies[q.X, a])
        - bodies[q.VZ, b]
        + bodies[q.OMEGA, b] * (x - bodies[q.X, b])
    )
    if outline.link[q.OWNER, c] != a:
        v_x, v_z = -v_x, -v_z
    n_x, n_z = outline.place[q.N_X, e], outline.place[q.N_Z, e]
    return v_x * n_x + v_z * n_z, v_x * n_z - v_z * n_x


@inner
def _sum_in_order(bodies, outline, lists, p):
    """Sums over more than two contacts in the order of their corners, which does not hang on how slots are listed."""
    load, a, b = lists.load[p], lists.pair[q.FIRST, p], lists.pair[q.SECOND, p]
    load[: q.MOMENT_SECOND + 1] = 0.0
    last_corner = -1
    while True:
        k_next, c_next = -1, outline.link.shape[1]
        for k in range(lists.pair[q.START, p], lists.pair[q.START, p + 1]):
            v = lists.slot[k, q.ACTIVE]
            if v >= 0 and last_corner < lists.slot[k, q.CORNER + v] < c_next:
                k_next, c_next = k, lists.slot[k, q.CORNER + v]
        if k_next < 0:
            return
        last_corner = c_next
        fx, fz, m_a, m_b = on_bodies(bodies, outline, lists, k_next, lists.slot[k_next, q.ACTIVE], a, b)
        load[q.FORCE_X] += fx
        load[q.FORCE_Z] += fz
        load[q.MOMENT_FIRST] += m_a
        load[q.MOMENT_SECOND] += m_b


@hot
def held(kept, d, place, v_n, v_t, law, rule):
    """The usual step of a contact that has been and stays where it is, as `pressed` and `losses` have it.

    Returns N, T [N], and what dashpots and friction take [J].
    """
    approach, slip = d - kept[q.OVERLAP], kept[q.PLACE] - place
    spring_n = kept[q.SPRING_N] + law[q.KN] * approach
    trial = kept[q.SPRING_S] - law[q.KS] * slip
    n = max(0.0, spring_n - law[q.DAMPING] * v_n)
    pressure = spring_n if rule.limit_on_spring else n
    limit = law[q.MU] * pressure if pressure > 0.0 else 0.0
    spring_s, t, friction = trial, trial, 0.0
    if abs(trial) <= limit:
        t = trial - law[q.DAMPING] * v_t
        if not rule.limit_on_spring:
            t = clipped(t, limit)
    else:
        spring_s = clipped(trial, limit)
        t = spring_s
        friction = book(kept[q.SPRING_S], spring_s, (trial - spring_s) / law[q.KS])
    dashpot = book(kept[q.TOTAL_N] - kept[q.SPRING_N], n - spring_n, approach)
    dashpot -= book(kept[q.TOTAL_S] - kept[q.SPRING_S], t - spring_s, slip)
    kept[q.OVERLAP], kept[q.PLACE], kept[q.SPRING_N], kept[q.SPRING_S] = d, place, spring_n, spring_s
    kept[q.TOTAL_N], kept[q.TOTAL_S], kept[q.ACTING_N], kept[q.ACTING_S] = n, t, spring_n, spring_s
    return n, t, dashpot, friction


@hot
def is_usual(kept, d, law):
    """Has the contact been there, do all of its springs act, and does it press on?"""
    return (
        d > 0.0
        and kept[q.OVERLAP] > 0.0
        and kept[q.ACTING_N] == kept[q.SPRING_N]
        and kept[q.ACTING_S] == kept[q.SPRING_S]
        and kept[q.SPRING_N] + law[q.KN] * (d - kept[q.OVERLAP]) > 0.0
    )


@hot
def out_of_reach(outline, lists, k, reach):
    """Do both variants of an idle slot lie apart?"""
    d, _ = locate(outline, index(lists.slot[k, q.CORNER]), index(lists.slot[k, q.EDGE]), reach)
    if d > 0.0:
        return False
    c = lists.slot[k, q.CORNER + 1]
    if c < 0:
        return True
    d, _ = locate(outline, index(c), index(lists.slot[k, q.EDGE + 1]), reach)
    return d <= 0.0


@inner
def press_slot(bodies, outline, lists, p, k, rule, judgement, dt, first_step):
    """A slot in a step in which something happens to it: forces on body a, moments on both, energies lost, touching."""
    law, a, b = lists.law[p], lists.pair[q.FIRST, p], lists.pair[q.SECOND, p]
    first, last = lists.pair[q.START, p], lists.pair[q.START, p + 1]
    state, v, d, place = state_of(bodies, outline, lists, first, last, k, judgement, dt)
    if state == IDLE:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    kept = lists.kept[k]
    v_n, v_t = velocity(bodies, outline, lists.slot[k, q.CORNER + v], lists.slot[k, q.EDGE + v], a, b)
    motion = motion_of(state, kept, d, place, v_n, v_t, dt, first_step)
    force = force_of(state, kept, motion, law, rule, first_step)
    dashpot, friction, onset = losses(state, kept, force, motion, law, first_step)
    keep(lists, k, state, v, motion, force)
    fx, fz, m_a, m_b = on_bodies(bodies, outline, lists, k, v, a, b)
    return fx, fz, m_a, m_b, dashpot, friction, onset, 1


@hot
def press_pair(bodies, outline, lists, p, rule, judgement, dt, first_step, saving):
    """All slots of pair p; the sums go to lists.load[p]."""
    a, b = index(lists.pair[q.FIRST, p]), index(lists.pair[q.SECOND, p])
    law, load, place_of = lists.law[index(p)], lists.load[index(p)], outline.place
    x_a, z_a, x_b, z_b = bodies[q.X, a], bodies[q.Z, a], bodies[q.X, b], bodies[q.Z, b]
    vx, vz = bodies[q.VX, a] - bodies[q.VX, b], bodies[q.VZ, a] - bodies[q.VZ, b]
    omega_a, omega_b = bodies[q.OMEGA, a], bodies[q.OMEGA, b]
    fx, fz, m_a, m_b, dashpot, friction, onset, touching = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    slack, reach = judgement.end_slack, judgement.reach
    for i in range(lists.pair[q.START, p], lists.pair[q.START, p + 1]):
        k = index(i)
        v = lists.slot[k, q.ACTIVE]
        if v >= 0 and not first_step:
            c, e = index(lists.slot[k, index(q.CORNER + v)]), index(lists.slot[k, index(q.EDGE + v)])
            d, place = locate(outline, c, e, reach)
            kept = lists.kept[k]
            if is_usual(kept, d, law) and within(outline, e, place, slack):
                x, z, n_x, n_z = place_of[q.AT_X, c], place_of[q.AT_Z, c], place_of[q.N_X, e], place_of[q.N_Z, e]
                side = 1.0 if index(outline.link[q.OWNER, c]) == a else -1.0
                v_x = side * (vx + omega_a * (z - z_a) - omega_b * (z - z_b))
                v_z = side * (vz - omega_a * (x - x_a) + omega_b * (x - x_b))
                n, t, lost_d, lost_f = held(kept, d, place, v_x * n_x + v_z * n_z, v_x * n_z - v_z * n_x, law, rule)
                n, t = side * n, side * t
                f_x, f_z = n * n_x + t * n_z, n * n_z - t * n_x
                fx, fz = fx + f_x, fz + f_z
                m_a += (z - z_a) * f_x - (x - x_a) * f_z
                m_b += (x - x_b) * f_z - (z - z_b) * f_x
                dashpot, friction, touching = dashpot + lost_d, friction + lost_f, touching + 1
                continue
            f_x, f_z, moment_a, moment_b, lost_d, lost_f, lost_o, touches = press_slot(
                bodies, outline, lists, p, i, rule, judgement, dt, first_step
            )
        elif v < 0 and out_of_reach(outline, lists, k, reach):
            continue
        else:
            f_x, f_z, moment_a, moment_b, lost_d, lost_f, lost_o, touches = press_slot(
                bodies, outline, lists, p, i, rule, judgement, dt, first_step
            )
        fx, fz, m_a, m_b = fx + f_x, fz + f_z, m_a + moment_a, m_b + moment_b
        dashpot, friction, onset = dashpot + lost_d, friction + lost_f, onset + lost_o
        touching += touches
    load[q.FORCE_X], load[q.FORCE_Z], load[q.MOMENT_FIRST], load[q.MOMENT_SECOND] = fx, fz, m_a, m_b
    load[q.LOST_DASHPOT], load[q.LOST_FRICTION], load[q.LOST_ONSET] = dashpot, friction, onset
    if touching > 2:
        _sum_in_order(bodies, outline, lists, p)
    if saving:
        load[q.IN_SPRINGS] = in_springs(lists, p)


@inner
def in_springs(lists, p):
    """Energy in the springs of pair p [J]."""
    elastic, law = 0.0, lists.law[p]
    for k in range(lists.pair[q.START, p], lists.pair[q.START, p + 1]):
        if lists.slot[k, q.ACTIVE] >= 0:
            kept = lists.kept[k]
            elastic += 0.5 * (kept[q.SPRING_N] ** 2 / law[q.KN] + kept[q.SPRING_S] ** 2 / law[q.KS])
    return elastic


@inner
def press_pairs(bodies, outline, lists, low, high, rule, judgement, dt, first_step, saving):
    """Pairs low..high."""
    for p in range(low, high):
        press_pair(bodies, outline, lists, p, rule, judgement, dt, first_step, saving)
