"""A block on a floor that gives, of whose springs along the floor friction limits the spring alone.

As `rocking.soft_floor`, but for a foot that friction does not hold.  Its spring there is never stretched by more than
friction gives it, whatever the dashpot does beside it, which has what is left,

    |q| <= mu N / k_t,  F = -(k_t q + c_t e') as long as |F| <= mu N, else such that |F| = mu N
    q' = e' while |q| < mu N / k_t;  slipping, q = +-mu N / k_t, until it would stretch no faster than that grows

or, `elastic`, the friction of the spring into the floor, with no dashpot beside the spring of a foot that slips,

    |q| <= mu k d / k_t,  F = -(k_t q + c_t e') while |q| < mu k d / k_t; slipping, F = -+mu k d

(of a bed what it carries counts with its dashpots in either), so that a foot that turns back is pulled at once by a
spring that is stretched as far as it may be, where a slider in series with spring and dashpot leaves that to the
dashpot.  When a foot begins to slip and when it holds again are events: which of its feet slip, and to which side, is
part of the discrete state.

Source   Cundall & Strack (1979), Geotechnique 29, 47-65: shear forces are stored, and cut in the store to what friction
         gives; here in continuous time, with dashpots in what friction gives or without them
Status   energy balance, Coulomb's law on both corners, distinct elements, the laboratory of `studies` in its own
         steps, which shares no code with it, and equal steps of stored forces; `elastic` on a bed against nothing
         (tests).  Runs take some 1.6 times as long as those of `rocking.soft_floor`
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

from rocking.hybrid import Base, Discrete
from rocking.soft_floor import (
    BlockOnSoftFloor,
    Foot,
    Held,
    Parameters,
    accelerations,
    bed,
    foot,
    pressed,
    touching,
)
from rocking.soft_floor import guards as guards_of_feet
from rocking.soft_floor import jump as jump_of_feet

RIGHT_SLIPS, LEFT_SLIPS, RIGHT_HOLDS, LEFT_HOLDS = range(5, 9)

MARGIN = 1e-13
"""Stretch [m] beyond what friction gives from which a foot slips: one that has just come to hold is there but for
rounding."""

INSTANT = 1e-6
"""Time [s] over which the change of what a bed carries is taken: a thousandth of the shortest contacts."""


def slipping(xp: Any, q: Discrete) -> tuple[Any, Any]:
    """Direction in which the spring of the right and of the left foot is stretched while it slips, 0 where it holds.

    Both are kept as one number in place of a slip, right + 3 left.
    """
    left = xp.where(q.slip > 1.5, 1.0, xp.where(q.slip < -1.5, -1.0, 0.0))
    return q.slip - 3.0 * left, left


class Limited(NamedTuple):
    """What friction lets the spring of a foot along the floor be."""

    stretch: Any  # [m]
    most: Any  # stretch at the most [m]
    held: Held


def limited(xp: Any, at: Foot, touched: Any, touches: Any, slips: Any, beside: Any, par: Parameters) -> Limited:
    """A foot that first touched the floor at x = touched, and what it gives; where it slips it is not dragged yet."""
    N = pressed(xp, at, touches, par)
    by_spring = xp.where(touches, (1.0 - par.spread) * par.k * xp.maximum(-at.height, 0.0), 0.0)
    gives = par.mu * (xp.where(par.elastic > 0.0, by_spring, N) + beside)
    most, since = gives / par.k_t, at.x - touched
    stretch = xp.where(slips != 0.0, slips * most, since)
    within = xp.minimum(xp.maximum(stretch, -most), most)
    spring = -par.k_t * within
    damped = spring - par.c_t * at.u
    F = xp.where(
        par.elastic > 0.0, xp.where(slips != 0.0, spring, damped), xp.minimum(xp.maximum(damped, -gives), gives)
    )
    return Limited(since, most, Held(xp.where(touches, F, 0.0), N, 0.0 * at.u))


class Sliding(NamedTuple):
    """Both feet at an instant, and how fast what their springs may be stretched by changes."""

    right: Limited
    left: Limited
    at_right: Foot
    at_left: Foot
    changes: tuple[Any, Any, Any]  # x'', z'', theta''
    growth_right: Any  # of the most that the spring may be stretched by [m/s]
    growth_left: Any


def moved_bed(xp: Any, y: Any, changes: tuple[Any, Any, Any], after: float, par: Parameters) -> Any:
    """What a bed carries [m/s^2] so long after a state [s], along what it does there."""
    moved = (
        y[0], y[1] + after * y[4], y[2] + after * y[5],
        y[3], y[4] + after * changes[1], y[5] + after * changes[2],
    )  # fmt: skip
    return bed(xp, moved, par)[0]


def growth(
    xp: Any, y: Any, at: Foot, N: Any, changes: tuple[Any, Any, Any], of_bed_grows: Any, par: Parameters
) -> Any:  # fmt: skip
    """How fast what the spring of a foot may be stretched by grows [m/s]."""
    # Its acceleration upward is z'' - theta'' r_x - theta'^2 r_z.
    up = changes[1] - changes[2] * at.r_x - y[5] ** 2 * at.r_z
    by_spring = -par.k * at.v
    carried = xp.where(par.elastic > 0.0, at.height < 0.0, N > 0.0)
    grows = xp.where(par.elastic > 0.0, by_spring, by_spring - par.c * up)
    pressed_more = xp.where(carried, (1.0 - par.spread) * grows, 0.0)
    return par.mu * (pressed_more + of_bed_grows) / par.k_t


def both(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> Sliding:
    """What the feet give, and what follows from it."""
    at_right, at_left = foot(xp, y, 1.0, par), foot(xp, y, -1.0, par)
    on_right, on_left = touching(q)
    slips_right, slips_left = slipping(xp, q)
    of_bed = bed(xp, y, par)
    right = limited(xp, at_right, y[6], on_right, slips_right, of_bed[0], par)
    left = limited(xp, at_left, y[7], on_left, slips_left, of_bed[0], par)
    changes = accelerations(xp, y, base, par, at_right, at_left, right.held, left.held, of_bed)
    later, earlier = moved_bed(xp, y, changes, INSTANT, par), moved_bed(xp, y, changes, -INSTANT, par)
    of_bed_grows = (later - earlier) / (2.0 * INSTANT)
    growth_right = growth(xp, y, at_right, right.held.N, changes, of_bed_grows, par)
    growth_left = growth(xp, y, at_left, left.held.N, changes, of_bed_grows, par)
    return Sliding(right, left, at_right, at_left, changes, growth_right, growth_left)


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """dy/dt; a foot that slips drags its place along so that its spring stays stretched as far as it may be."""
    now = both(xp, y, q, base, par)
    slips_right, slips_left = slipping(xp, q)
    dragged_right = xp.where(slips_right != 0.0, now.at_right.u - slips_right * now.growth_right, 0.0)
    dragged_left = xp.where(slips_left != 0.0, now.at_left.u - slips_left * now.growth_left, 0.0)
    return y[3], y[4], y[5], *now.changes, dragged_right, dragged_left


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """Those of the feet; each foot begins to slip (its spring as stretched as it may be), and holds again.

    It holds where its spring would be stretched no faster than what friction gives grows; without a load it does not.
    """
    now = both(xp, y, q, base, par)
    on_right, on_left = touching(q)
    slips_right, slips_left = slipping(xp, q)
    return (
        *guards_of_feet(xp, y, q, base, par),
        xp.where(on_right & (slips_right == 0.0), now.right.most - xp.abs(now.right.stretch) + MARGIN, 1.0),
        xp.where(on_left & (slips_left == 0.0), now.left.most - xp.abs(now.left.stretch) + MARGIN, 1.0),
        xp.where((slips_right != 0.0) & (now.right.most > 0.0), slips_right * now.at_right.u - now.growth_right, 1.0),
        xp.where((slips_left != 0.0) & (now.left.most > 0.0), slips_left * now.at_left.u - now.growth_left, 1.0),
    )


def towards(xp: Any, at: Foot, spring: Limited) -> Any:
    """The direction in which a foot begins to slip: that in which its spring is stretched, or it moves."""
    moves = xp.where(at.u >= 0.0, 1.0, -1.0)
    return xp.where(spring.stretch > 0.0, 1.0, xp.where(spring.stretch < 0.0, -1.0, moves))


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """A foot meets the floor or leaves it, its spring let go; begins to slip; or holds again, stretched as it is."""
    after, then = jump_of_feet(xp, y, q, base, par, k)
    on_right, on_left = touching(then)
    slips_right, slips_left = slipping(xp, q)
    now = both(xp, y, q, base, par)
    right_goes, left_goes = towards(xp, now.at_right, now.right), towards(xp, now.at_left, now.left)
    right = xp.where(k == RIGHT_SLIPS, right_goes, xp.where(k == RIGHT_HOLDS, 0.0, slips_right))
    left = xp.where(k == LEFT_SLIPS, left_goes, xp.where(k == LEFT_HOLDS, 0.0, slips_left))
    place_right = xp.where(k == RIGHT_HOLDS, now.at_right.x - slips_right * now.right.most, after[6])
    place_left = xp.where(k == LEFT_HOLDS, now.at_left.x - slips_left * now.left.most, after[7])
    slip = xp.where(on_right, right, 0.0) + 3.0 * xp.where(on_left, left, 0.0)
    return (*after[:6], place_right, place_left), Discrete(then.mode, then.s, slip)


@dataclass(frozen=True)
class BlockOnSlidingSprings(BlockOnSoftFloor):
    """A block on springs and dashpots, of which friction limits the springs; made by effects with `spring_slider`.

    Args:
        rigid, corner_stiffness, damping_ratio, spread, tangential_ratio: as of `rocking.soft_floor.BlockOnSoftFloor`.
        friction: mu of a corner [1], positive and finite.
        elastic: whether it is that of the springs into the floor alone, and dashpots along it act where corners hold.

    Raises:
        ValueError: as there, but for a dashpot, which it does not need; or friction is infinite.
    """

    elastic: bool = False

    name = "spring_slider"
    guard_names = (
        "fall", "contact", "landing", "right_lifts", "left_lifts",
        "right_slips", "left_slips", "right_holds", "left_holds",
    )  # fmt: skip
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        return super().parameters._replace(elastic=float(self.elastic))

    def _check_slider(self) -> None:
        if self.friction == math.inf:
            raise ValueError("friction=inf: want it finite where friction limits the springs along the floor")

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, beside: tuple[Sequence[float], Discrete] | None = None
    ) -> tuple[tuple[float, ...], Discrete]:
        """As there; no foot slips yet: one whose spring is stretched beyond what friction gives begins to at once."""
        y, q = super().initial_state(theta, omega, beside)
        return y, Discrete(q.mode, q.s, 0.0)


SLIDERS: dict[float, Callable[..., BlockOnSoftFloor]] = {
    0.0: BlockOnSoftFloor,
    1.0: BlockOnSlidingSprings,
    2.0: partial(BlockOnSlidingSprings, elastic=True),
}
"""Blocks on springs by what friction limits: spring and dashpot, the spring alone, or that by the spring alone."""


def sliding_as(effect: str, spring_slider: float) -> Callable[..., BlockOnSoftFloor]:
    """The block on springs whose corners slip as an effect has it.

    Raises:
        ValueError: it is none of 0, 1 and 2.
    """
    if spring_slider not in SLIDERS:
        raise ValueError(f"{effect}.spring_slider={spring_slider!r}: want 0, 1 or 2")
    return SLIDERS[spring_slider]
