"""A block on a floor that gives: springs and dashpots under its corners or spread under its base; three freedoms.

With F and N of each corner that touches (compression d of its foot, slip e since it touched, both with their rates),

    N = (1 - w) max(k d + c d', 0),  F = -(k_t q + c_t q') while d > 0,  c = 2 xi sqrt(k m),  c_t = 2 xi sqrt(k_t m)
    q' = e' while friction holds, |F| <= mu N (of a bed: mu times what it carries besides), else such that |F| = mu N
    m x'' = sum F - m A_x,  m z'' = sum N - m A_z,  I_c theta'' = sum (r_z F - r_x N) - I_c psi''

about the centre of mass (x, z), the base in the axes of the floor and psi'' its pitch acceleration.  The share w of
the normal stiffness is a Winkler bed: a pressure max(w k d + w c d', 0) / a on each unit of length of the base (2 a
wide) that is below the floor, as stiff in all as the two corners; its sums are in closed form.  Where each foot
touched is part of the state, so that tangential forces start from zero at each touch-down; a foot that slips drags
that place along, e - q.  So F goes to zero with N where a foot leaves: that slip is in every impact.

Without a limit to friction (mu infinite, the default) a foot is held sideways as long as it is below the floor, also in
the instants in which a dashpot would have to pull and N is zero, and lets go at once.

What effects add on the side s of a rigid block they add here on the side to which this one leans (`leaning`).

Source   Psycharis & Jennings (1983), Earthquake Eng. Struct. Dyn. 11, 57-76: two-spring foundation and Winkler bed with
         uplift, here without their small angles; the tangential springs are those of the distinct elements of Winkler,
         Meguro & Yamazaki (1995), their slider in series with spring and dashpot.
Status   energy balance, the static sink, periods of small oscillation, the rigid limit, the history of the distinct
         element with the same contacts, and a bed of many separate springs (tests).  A block that stands on both
         corners has mode REST, on one ROTATION, on none ROTATION_JUMP; it never stands wholly still.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

from rocking.composed import ComposedMethod1, OnRigidBlock, added
from rocking.hybrid import REST, ROTATION, ROTATION_JUMP, Anchor, Base, Discrete, in_floor_axes
from rocking.validation import positive, within

UNLIMITED = 1e300
"""Friction that holds in any case, as a number that may be multiplied by zero."""

FALL, RIGHT_LANDS, LEFT_LANDS, RIGHT_LIFTS, LEFT_LIFTS = range(5)


class Parameters(NamedTuple):
    """What the equations take; masses are divided out."""

    a: float  # half of the breadth between the feet [m]
    o: float  # offset of the centre of mass [m]
    H: float  # its height [m]
    rho2: float  # I_c / m [m^2]
    g: float  # [m/s^2]
    k: float  # stiffness over mass [1/s^2]
    c: float  # dashpot over mass [1/s]
    k_t: float  # the same along the floor [1/s^2]
    c_t: float  # [1/s]
    spread: float  # w, share of both that is a bed [1]
    mu: float  # friction of a foot [1], `UNLIMITED` where it holds in any case
    balance_right: float  # tilt of unstable balance to +x [rad]
    balance_left: float  # to -x [rad], positive
    elastic: float  # 1 where friction is that of the springs into the floor alone (`rocking.spring_slider`) [1]
    hooks: Any  # Hooks; those of an impact are not asked for, since its loss follows from the dashpots


class Foot(NamedTuple):
    """One corner: its arm from the centre of mass, its height over the floor and the velocities of both."""

    r_x: Any  # [m]
    r_z: Any
    x: Any  # [m]
    height: Any
    u: Any  # [m/s]
    v: Any


def foot(xp: Any, y: Any, side: float, par: Parameters) -> Foot:
    """The corner of that side, +1.0 or -1.0."""
    sin, cos = xp.sin(y[2]), xp.cos(y[2])
    along, up = side * par.a - par.o, -par.H
    r_x, r_z = along * cos + up * sin, -along * sin + up * cos
    return Foot(r_x, r_z, y[0] + r_x, y[1] + r_z, y[3] + y[5] * r_z, y[4] - y[5] * r_x)


class Held(NamedTuple):
    """What a foot gives, over mass [m/s^2], and how fast its place on the floor is dragged along [m/s]."""

    F: Any
    N: Any
    dragged: Any


def pressed(xp: Any, at: Foot, touches: Any, par: Parameters) -> Any:
    """N of a foot over mass [m/s^2]."""
    return xp.where(touches, (1.0 - par.spread) * xp.maximum(-par.k * at.height - par.c * at.v, 0.0), 0.0)


def forces(xp: Any, at: Foot, touched: Any, touches: Any, beside: Any, par: Parameters) -> Held:
    """A foot that first touched the floor at x = touched, with a bed that carries `beside` [m/s^2] where it stands."""
    N = pressed(xp, at, touches, par)
    spring = par.k_t * (at.x - touched)
    F = -spring - par.c_t * at.u
    most = par.mu * (N + beside)
    slips = touches & (par.mu < UNLIMITED) & (xp.abs(F) > most)
    F = xp.where(touches, xp.where(slips, xp.minimum(xp.maximum(F, -most), most), F), 0.0)
    # The spring and its dashpot then stretch as the force that is left lets them.
    stretching = -(F + spring) / xp.where(par.c_t > 0.0, par.c_t, 1.0)
    return Held(F, N, xp.where(slips, at.u - stretching, 0.0))


def positive_part(xp: Any, at_middle: Any, slope: Any, low: Any, high: Any) -> tuple[Any, Any]:
    """The part of [low, high] in which at_middle + slope xi is positive; of no length where it nowhere is."""
    zero = -at_middle / xp.where(slope == 0.0, 1.0, slope)
    within = xp.minimum(xp.maximum(zero, low), high)
    first = xp.where(slope > 0.0, within, low)
    last = xp.where(slope < 0.0, within, high)
    return first, xp.where((slope == 0.0) & (at_middle <= 0.0), first, last)


def bed(xp: Any, y: Any, par: Parameters) -> tuple[Any, Any]:
    """Normal force over mass [m/s^2] of the bed, and its moment [m^2/s^2] about the centre of mass."""
    sin, cos = xp.sin(y[2]), xp.cos(y[2])
    # Compression and its rate at xi along the base from its middle are linear in xi.
    depth, depth_slope = par.H * cos - par.o * sin - y[1], sin
    rate, rate_slope = -y[4] - y[5] * (par.o * cos + par.H * sin), y[5] * cos
    k, c = par.spread * par.k / par.a, par.spread * par.c / par.a
    pressure, slope = k * depth + c * rate, k * depth_slope + c * rate_slope
    low, high = positive_part(xp, depth, depth_slope, -par.a, par.a)
    low, high = positive_part(xp, pressure, slope, low, high)
    first, second, third = high - low, 0.5 * (high**2 - low**2), (high**3 - low**3) / 3.0
    N, about_middle = pressure * first + slope * second, pressure * second + slope * third
    return N, -(cos * (about_middle - par.o * N) - par.H * sin * N)


def touching(q: Discrete) -> tuple[Any, Any]:
    """Whether the right and the left foot touch."""
    return (q.mode == REST) | ((q.mode == ROTATION) & (q.s > 0.0)), (q.mode == REST) | (
        (q.mode == ROTATION) & (q.s < 0.0)
    )


def leaning(xp: Any, theta: Any, par: Parameters) -> Any:
    """The side to which the block leans, for what effects add: +-1 from where a foot leaves the floor, 0 upright [1].

    Between, both feet carry, and the side goes from one to the other as the moment of their springs does; a torque
    that has a sign on either side then keeps to it, and pulls an upright block to neither.
    """
    return xp.minimum(xp.maximum(2.0 * par.a * xp.sin(theta) * par.k / par.g, -1.0), 1.0)


def accelerations(
    xp: Any, y: Any, base: Base, par: Parameters, right: Foot, left: Foot, held_right: Held, held_left: Held,
    of_bed: tuple[Any, Any],
) -> tuple[Any, Any, Any]:  # fmt: skip
    """(x'', z'', theta'') under what both feet and the bed give; what they do not hold is free."""
    F_r, N_r, _ = held_right
    F_l, N_l, _ = held_left
    N_b, moment_b = of_bed
    A_x, A_z = in_floor_axes(xp, base, par.g)
    # A pitch about the middle of where the block stands carries the centre of mass along.
    A_x = A_x + base.pitch_acceleration * y[1]
    A_z = A_z - base.pitch_acceleration * y[0]
    moment = right.r_z * F_r - right.r_x * N_r + left.r_z * F_l - left.r_x * N_l + moment_b
    omega_dot = moment / par.rho2 - base.pitch_acceleration
    # What effects add to a block on a fixed corner is a couple of so much times its inertia there.
    s = leaning(xp, y[2], par)
    squares = right.r_x**2 + right.r_z**2, left.r_x**2 + left.r_z**2
    inertia = par.rho2 + 0.5 * ((1.0 + s) * squares[0] + (1.0 - s) * squares[1])
    omega_dot = omega_dot + added(y[2], y[5], s, base, par) * inertia / par.rho2
    return F_r + F_l - A_x, N_r + N_l + N_b - A_z, omega_dot


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """dy/dt."""
    right, left = foot(xp, y, 1.0, par), foot(xp, y, -1.0, par)
    on_right, on_left = touching(q)
    of_bed = bed(xp, y, par)
    held_right = forces(xp, right, y[6], on_right, of_bed[0], par)
    held_left = forces(xp, left, y[7], on_left, of_bed[0], par)
    changes = accelerations(xp, y, base, par, right, left, held_right, held_left, of_bed)
    return y[3], y[4], y[5], *changes, held_right.dragged, held_left.dragged


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """Fall; each foot lands (under the floor and sinking), each foot lifts (above it and rising)."""
    on_right, on_left = touching(q)
    right, left = foot(xp, y, 1.0, par), foot(xp, y, -1.0, par)
    fall = 0.5 * math.pi - xp.abs(y[2])
    # The speed is asked for as well, since the height of a foot that has just met the floor is zero but for rounding.
    land_right, land_left = xp.maximum(right.height, right.v), xp.maximum(left.height, left.v)
    lift_right, lift_left = xp.maximum(-right.height, -right.v), xp.maximum(-left.height, -left.v)
    return (
        fall, xp.where(on_right, 1.0, land_right), xp.where(on_left, 1.0, land_left),
        xp.where(on_right, lift_right, 1.0), xp.where(on_left, lift_left, 1.0),
    )  # fmt: skip


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """A foot meets the floor, where its tangential spring starts anew, or leaves it."""
    on_right, on_left = touching(q)
    now_right = (on_right | (k == RIGHT_LANDS)) & (k != RIGHT_LIFTS)
    now_left = (on_left | (k == LEFT_LANDS)) & (k != LEFT_LIFTS)
    foot_right = xp.where(k == RIGHT_LANDS, foot(xp, y, 1.0, par).x, y[6])
    foot_left = xp.where(k == LEFT_LANDS, foot(xp, y, -1.0, par).x, y[7])
    mode = xp.where(now_right & now_left, REST, xp.where(now_right | now_left, ROTATION, ROTATION_JUMP))
    s = xp.where(now_right & now_left, q.s, xp.where(now_right, 1.0, xp.where(now_left, -1.0, q.s)))
    return (y[0], y[1], y[2], y[3], y[4], y[5], foot_right, foot_left), Discrete(mode, s, q.slip)


def balance(xp: Any, y: Any, par: Parameters) -> Any:
    """|theta| less the tilt of unstable balance of the rigid block to that side."""
    return xp.where(y[2] > 0.0, y[2] - par.balance_right, -y[2] - par.balance_left)


@dataclass(frozen=True)
class BlockOnSoftFloor(OnRigidBlock):
    """A block on springs and dashpots; made by `rocking.effects.compliant_base`, and by `bouncing` for a hard contact.

    Args:
        rigid: the block on a rigid floor, with its form and hooks; its restitution is not used, for the loss of an
            impact follows from the dashpots.
        corner_stiffness: normal stiffness k of a corner [N/m], positive.
        damping_ratio: xi = c / (2 sqrt(k m)) of a corner [1], 0 or more, normal and tangential.
        spread: share of the normal springs and dashpots that is spread under the base [1]: 0 for corners alone, 1 for
            a Winkler bed as stiff in all as the two corners.
        tangential_ratio: k_t / k of a corner [1], positive: 1 as in the distinct elements of the paper; 10 or more
            where friction holds the corners in place on a layer that gives downward alone.
        friction: mu of a corner [1], positive; infinite where it holds in any case.  It takes a dashpot.

    Raises:
        ValueError: a number is out of its range, the floor is so soft that the block cannot stand on it, or the block
            has an effect that these equations do not have: rounded edges, adhesion, one on restitution.
    """

    rigid: ComposedMethod1
    corner_stiffness: float
    damping_ratio: float
    spread: float = 0.0
    tangential_ratio: float = 1.0
    friction: float = math.inf

    name = "soft_floor"
    state_names = ("x", "z", "theta", "u", "v", "omega", "foot_right", "foot_left")
    state_labels = MappingProxyType(
        {
            "x": ("m", "position of the centre of mass relative to the base"),
            "z": ("m", "height of the centre of mass over the unloaded floor"),
            "u": ("m s-1", "horizontal velocity of the centre of mass relative to the base"),
            "v": ("m s-1", "vertical velocity of the centre of mass relative to the base"),
        }
    )
    # "contact" is the right foot's, "landing" the left foot's.
    guard_names: ClassVar[tuple[str, ...]] = ("fall", "contact", "landing", "right_lifts", "left_lifts")
    carries_pitch = True
    inadmissible_reason = ""
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        positive("corner_stiffness", self.corner_stiffness, "N/m")
        within("damping_ratio", self.damping_ratio, 0.0, math.inf)
        within("spread", self.spread, 0.0, 1.0)
        self._check_along()
        if not self.friction > 0.0:
            raise ValueError(f"friction={self.friction!r}: want more than 0, or inf where the corners are held")
        self._check_slider()
        form = self.rigid.form
        striking = [effect.name for effect in self.effects if "restitution" in effect.ways()]
        foreign = ["rounded_edges"] * (form.edge_radius != 0.0) + ["base_adhesion"] * (form.adhesion != 0.0) + striking
        if foreign:
            name = further[0].name if (further := [e for e in self.effects if "freedoms" in e.ways()]) else self.name
            raise ValueError(f"{name}: it does not go together with {foreign[0]}")
        arm2 = form.half_breadth**2 * (1.0 - 2.0 * self.spread / 3.0)
        least = 0.5 * form.mass * self.g * form.mass_height / arm2
        if self.corner_stiffness <= least:
            raise ValueError(
                f"corner_stiffness={self.corner_stiffness!r} N/m: want more than m g H / (2 a^2 (1 - 2 w / 3)) = "
                f"{least:.6g} N/m, below which the block cannot stand"
            )

    def _check_along(self) -> None:
        positive("tangential_ratio", self.tangential_ratio, "1")

    def _check_slider(self) -> None:
        if self.friction < math.inf and self.damping_ratio == 0.0:
            raise ValueError(f"damping_ratio=0.0: want more than 0 beside friction={self.friction!r}, or friction=inf")

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        form = self.rigid.form
        per_mass = self.corner_stiffness / form.mass
        dashpot, along = 2.0 * self.damping_ratio * math.sqrt(per_mass), float(self.tangential_ratio)
        if along == math.inf:
            along = 0.0  # nothing moves along the floor that a spring could hold
        return Parameters(
            form.half_breadth, form.offset, form.mass_height, form.rho2, float(self.g), per_mass, dashpot,
            along * per_mass, math.sqrt(along) * dashpot, float(self.spread), min(float(self.friction), UNLIMITED),
            form.theta_c(1.0), form.theta_c(-1.0), 0.0,
            self.rigid.hooks,
        )  # fmt: skip

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, beside: tuple[Sequence[float], Discrete] | None = None
    ) -> tuple[tuple[float, ...], Discrete]:
        """In static balance of heights: in balance altogether when upright and still, else let go from the lean.

        The feet carry the whole weight between them: both as long as the lean leaves the other one under the floor.

        Args:
            theta, omega: rotation [rad] and angular velocity [rad/s].
            beside: a state at about that rotation, the lower corner of which is kept as deep in the floor and moving
                there; without effect if it leans to the other side.
        """
        par = self.parameters
        if beside is not None and beside[0][2] * theta > 0.0:
            return self._beside(par, theta, omega, *beside)
        if theta == 0.0 and omega == 0.0:
            tilt = self._standing(par)
            return self._placed(par, tilt, 0.0, math.copysign(1.0, tilt))
        leans = theta if theta != 0.0 else omega
        return self._placed(par, theta, omega, -1.0 if leans < 0.0 else 1.0)

    @staticmethod
    def _beside(
        par: Parameters, theta: float, omega: float, y: Sequence[float], q: Discrete
    ) -> tuple[tuple[float, ...], Discrete]:
        """Another rotation and angular velocity about the lower corner of a state, which stays as it is."""
        side = math.copysign(1.0, theta)
        at = foot(math, tuple(y), side, par)
        moved = foot(math, (0.0, 0.0, theta, 0.0, 0.0, omega), side, par)
        state = (at.x - moved.x, at.height - moved.height, theta, at.u - moved.u, at.v - moved.v, omega)
        right, left = foot(math, state, 1.0, par), foot(math, state, -1.0, par)
        on_right, on_left = right.height < 0.0, left.height < 0.0
        was_right, was_left = touching(q)
        feet = (y[6] if on_right and was_right else right.x, y[7] if on_left and was_left else left.x)
        mode = REST if on_right and on_left else ROTATION if on_right or on_left else ROTATION_JUMP
        s = side if on_right == on_left else 1.0 if on_right else -1.0
        return (*state, *feet), Discrete(mode, s, q.slip)

    @staticmethod
    def _standing(par: Parameters) -> float:
        """Tilt [rad] in balance on the whole base: sin(theta) = g (o + H tan(theta)) / (2 k a^2 (1 - 2 w / 3))."""
        softness, theta = 0.5 * par.g / (par.k * par.a**2 * (1.0 - 2.0 * par.spread / 3.0)), 0.0
        while True:
            sine = softness * (par.o + par.H * math.tan(theta))
            # No balance on both feet: the block is let go upright, and tips.
            if not abs(sine) < 1.0:
                return 0.0
            if abs(math.asin(sine) - theta) <= 1e-14:
                break
            theta = math.asin(sine)
        whole = 2.0 * par.a * abs(math.sin(theta)) < par.g / par.k
        return theta if whole or par.spread == 0.0 else math.copysign(BlockOnSoftFloor._standing_on_a_part(par), par.o)

    @staticmethod
    def _standing_on_a_part(par: Parameters) -> float:
        """Tilt [rad], 0 or more, in balance on a part of the bed; 0 where there is none."""
        from scipy.optimize import brentq  # here, since few need it and it takes long to import

        def excess(theta: float) -> float:
            # Moment of the pressures about the middle of the base, less that of the weight; over k.
            step, depth = 2.0 * par.a * math.sin(theta), BlockOnSoftFloor._depth(par, 2.0 * par.a * math.sin(theta))
            on_bed = par.spread * depth**2 / step * (par.a - depth / (3.0 * math.sin(theta)))
            held = (1.0 - par.spread) * depth * par.a + on_bed
            return held - par.g / par.k * (abs(par.o) + par.H * math.tan(theta))

        low = math.asin(min(0.5 * par.g / (par.k * par.a), 1.0))
        steeper = (low + (0.5 * math.pi - low) * (i / 400.0) ** 3 for i in range(1, 400))
        high = next((theta for theta in steeper if excess(theta) > 0.0), None)
        return 0.0 if high is None else float(brentq(excess, low * (1.0 + 1e-12), high, xtol=1e-15, rtol=1e-14))

    @staticmethod
    def _depth(par: Parameters, step: float) -> float:
        """How deep [m] the lower corner is under the block's weight, where the other one is `step` [m] above it."""
        weight, corner = par.g / par.k, 1.0 - par.spread
        if step < weight:
            return 0.5 * (weight + step)
        # On a part of the bed alone, (1 - w) d + w d^2 / step is the weight.
        return 2.0 * weight / (corner + math.sqrt(corner**2 + 4.0 * par.spread * weight / step))

    @staticmethod
    def _placed(par: Parameters, theta: float, omega: float, s: float) -> tuple[tuple[float, ...], Discrete]:
        """The state at that tilt, turning about the foot of the side s."""
        cos, sin = math.cos(theta), math.sin(theta)
        step = 2.0 * par.a * s * sin
        both, depth = step < par.g / par.k, BlockOnSoftFloor._depth(par, step)
        along, up = s * par.a - par.o, -par.H
        r_x, r_z = along * cos + up * sin, -along * sin + up * cos
        x, z = s * par.a * cos - r_x, -depth - r_z
        feet = (par.a * cos, -par.a * cos)
        return (x, z, theta, -omega * r_z, omega * r_x, omega, *feet), Discrete(REST if both else ROTATION, s, 1.0)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of mass."""
        form = self.rigid.form
        return Anchor(form.offset, form.mass_height, y[0], y[1], rate[3], rate[4])
