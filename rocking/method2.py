"""Method 2: a block that rests, slides, rotates, does both, or leaves the floor, after Ishiyama (1982).

Source   Ishiyama (1982), Earthquake Eng. Struct. Dyn. 10, 635-650: six modes, a normal and a tangential coefficient
         of restitution, centric and eccentric impacts; Winkler, Meguro & Yamazaki (1995), "Method 2".
Status   equations in `method2_equations`, transitions in `method2_transitions`, impact laws in `impacts`.  Kinetic
         friction below 4/3 (beyond it a sliding corner may jam: Painleve's paradox) or infinite as a switch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from rocking.block import G_STANDARD, Block
from rocking.form import Form, levers
from rocking.hybrid import (
    REST,
    ROTATION,
    ROTATION_JUMP,
    SLIDE,
    SLIDE_ROTATION,
    TRANSLATION_JUMP,
    WITHIN,
    Anchor,
    Discrete,
)
from rocking.method2_equations import (
    FRICTIONAL,
    KINEMATIC,
    TWO_CORNER,
    Parameters,
    balance,
    flow,
    guards,
)
from rocking.method2_transitions import jump
from rocking.validation import as_floats, positive, within

ImpactLaw = Literal["frictional", "kinematic", "two_corner"]
NUMBERS = (
    "friction", "kinetic_friction", "normal_restitution", "tangential_restitution", "g", "rest_speed", "chatter_time",
    "ratio_kept",
)  # fmt: skip
"""Arguments that are numbers in any case."""

IMPACT_LAWS = {"frictional": FRICTIONAL, "kinematic": KINEMATIC, "two_corner": TWO_CORNER}

JAMMING_FRICTION = 4.0 / 3.0
"""Kinetic friction from which a sliding corner of a uniform rectangle jams at some tilt."""

KINEMATIC_CHI = 0.36
"""`kinematic_chi` of a uniform rectangle, whose R^2 / rho2 is 3."""


TILTS = tuple(math.radians(0.25 * k) for k in range(361))
"""Tilts [rad] at which a sliding corner of a form that is no rectangle is looked at for jamming."""


def kinematic_chi(form: Form) -> float:
    """Least chi [1] with which (1 - e_n^2)(1 - e_t^2) >= chi (1 - e_n e_t)^2 rules out a gain of energy at any tilt.

    At an arm (r_x, r_z) the corner's velocities w = (u, v) carry the energy w A^-1 w / 2 with A of `rocking.impacts`.
    It does not grow from w to (-e_t u, -e_n v) if the pair satisfies that with chi = A_xz^2 / (A_xx A_zz), which for
    r = R (sin psi, -cos psi) and k = R^2 / rho2 is largest at psi = pi/4: (k/2)^2 / (1 + k/2)^2.  It grows with k: the
    longer arm counts, and of a rounded edge, whose arm changes with the tilt, the longest that there may be.
    """
    arm = math.hypot(form.half_breadth + abs(form.offset), form.mass_height - form.edge_radius)
    longest = arm + form.edge_radius
    half_k = 0.5 * longest**2 / form.rho2
    return (half_k / (1.0 + half_k)) ** 2


@dataclass(frozen=True)
class Method2:
    """A block that may slide and jump as well as rock.

    Args:
        block: the block.
        friction: static coefficient mu_s [1], 0 or more; `math.inf` never lets the corner slip.
        kinetic_friction: mu_k [1], 0 to mu_s and below 4/3; mu_s if not given.
        normal_restitution: e_n [1], 0 to 1: normal velocity after / before, of a corner or of a flat landing.
        tangential_restitution: e_t [1], -1 (frictionless) over 0 (sticks) to 1 (reverses).
        impact_law: "frictional" (Chatterjee & Ruina: e_n exactly, e_t within the friction cone; a rocking impact with
            e_n = e_t = 0 then has Housner's restitution), "kinematic" (v -> -e_n v, u -> -e_t u at the corner), or
            "two_corner" (rocking impacts are plastic, e_n and e_t have no say in them, and have `restitution` where the
            base does not slide; landings from the air are frictional).
        restitution: e of eq. (4) [1] for "two_corner", 0 to 1, of impacts before which the base did not slide; not
            with another law.  Below Housner's, where corners alone would have to pull, a couple as of rolling
            resistance takes the rest.
        g: acceleration of gravity [m/s^2].
        rest_speed: a rocking impact after which |omega| / p is below this [1] brings the block upright.
        chatter_time: a series of bounces that would end within this time [s] is finished at once.
        ratio_kept: what impacts of a sliding base keep [1], for "two_corner": 0 the place of the normal impulse, 1 the
            ratio of angular velocities, as far as no energy is made; linear in between.
        form: shape and mass where the block is no uniform rectangle with sharp edges.

    Raises:
        ValueError: an argument is out of its range; the kinematic pair (e_n, e_t) would create energy at some tilt;
            with "two_corner" one side's restitution would be above 1; a sliding corner of the form may jam.
    """

    block: Block
    friction: float
    kinetic_friction: float | None = None
    normal_restitution: float = 0.0
    tangential_restitution: float = 0.0
    impact_law: ImpactLaw = "frictional"
    restitution: float | None = None
    g: float = G_STANDARD
    rest_speed: float = 1e-6
    chatter_time: float = 1e-5
    ratio_kept: float = 0.0
    form: Form | None = None

    name = "method2"
    state_names = ("x", "z", "theta", "u", "v", "omega")
    guard_names = ("fall", "landing", "contact", "slip", "stick", "lift", "tip")
    carries_pitch = True
    inadmissible_reason = (
        "friction without limit would have to pull the corner down: no mode is admissible (want a finite friction)"
    )
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        if not isinstance(self.block, Block):
            raise ValueError(f"block={self.block!r}: want a Block")
        within("friction", self.friction, 0.0, math.inf)
        if self.kinetic_friction is not None:
            within("kinetic_friction", self.kinetic_friction, 0.0, self.friction)
        if self.form is not None and not isinstance(self.form, Form):
            raise ValueError(f"form={self.form!r}: want a rocking.form.Form, or None for the rectangle of the block")
        self._check_jamming()
        within("normal_restitution", self.normal_restitution, 0.0, 1.0)
        within("tangential_restitution", self.tangential_restitution, -1.0, 1.0)
        positive("g", self.g, "m/s^2")
        positive("rest_speed", self.rest_speed, "1")
        positive("chatter_time", self.chatter_time, "s")
        if not isinstance(self.impact_law, str) or self.impact_law not in IMPACT_LAWS:
            raise ValueError(f"impact_law={self.impact_law!r}: want one of {', '.join(IMPACT_LAWS)}")
        within("ratio_kept", self.ratio_kept, 0.0, 1.0)
        as_floats(self, *NUMBERS)
        if self.ratio_kept > 0.0 and self.impact_law != "two_corner":
            raise ValueError(
                f"ratio_kept={self.ratio_kept!r}: want impact_law='two_corner' with it, not {self.impact_law!r}"
            )
        if self.impact_law == "kinematic":
            self._check_kinematic_energy()
        if self.impact_law == "two_corner":
            self._check_two_corner()
        elif self.restitution is not None:
            raise ValueError(
                f"restitution={self.restitution!r}: want impact_law='two_corner' with it, not {self.impact_law!r}"
            )

    def _check_jamming(self) -> None:
        if self.mu_k == math.inf:
            return
        if self.form is None:
            if self.mu_k >= JAMMING_FRICTION:
                raise ValueError(
                    f"friction={self.mu_k!r} (kinetic): want below 4/3, where a sliding corner may jam, or math.inf"
                )
            return
        form = self.form
        # The least over all arms across, for the highest that there may be: enough for most.
        highest = (
            math.hypot(form.half_breadth + abs(form.offset), form.mass_height - form.edge_radius) + form.edge_radius
        )
        if (self.mu_k * highest) ** 2 < 4.0 * form.rho2:
            return
        for s in (1.0, -1.0):
            # In the worse of both directions of slip.
            for tilt in TILTS:
                _, _, up, across = levers(
                    math, tilt, form.half_breadth, form.edge_radius, form.half_breadth - s * form.offset,
                    form.mass_height - form.edge_radius,
                )  # fmt: skip
                if form.rho2 + across**2 - self.mu_k * up * abs(across) > 0.0:
                    continue
                raise ValueError(
                    f"friction={self.mu_k!r} (kinetic): want less, a sliding corner of {form} may jam, or math.inf"
                )

    def _check_kinematic_energy(self) -> None:
        e_n, e_t = self.normal_restitution, self.tangential_restitution
        chi = KINEMATIC_CHI if self.form is None else kinematic_chi(self.form)
        if (1.0 - e_n**2) * (1.0 - e_t**2) < chi * (1.0 - e_n * e_t) ** 2:
            raise ValueError(
                f"normal_restitution={e_n!r}, tangential_restitution={e_t!r}: the kinematic pair creates energy at "
                f"some tilt; want (1 - e_n^2)(1 - e_t^2) >= {chi:.4g} (1 - e_n e_t)^2"
            )

    def _check_two_corner(self) -> None:
        if self.restitution is None:
            raise ValueError("restitution=None: want a number with impact_law='two_corner'")
        within("restitution", self.restitution, 0.0, 1.0)
        as_floats(self, "restitution")
        self.shape.restitutions(self.restitution)

    @property
    def shape(self) -> Form:
        """The form that is given, else the uniform rectangle with sharp edges."""
        return Form.of(self.block) if self.form is None else self.form

    @property
    def mu_k(self) -> float:
        """Kinetic friction in force [1]."""
        return self.friction if self.kinetic_friction is None else self.kinetic_friction

    @property
    def theta_c(self) -> float:
        """Tilt of unstable balance [rad], the smaller of the two."""
        return min(self.shape.theta_c(1.0), self.shape.theta_c(-1.0))

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        form = self.shape
        right, left = form.restitutions(self.restitution)
        return Parameters(
            a=float(form.half_breadth),
            r=float(form.edge_radius),
            o=float(form.offset),
            H=float(form.mass_height),
            rho2=form.rho2,
            g=float(self.g),
            hold=form.adhesion / form.mass,
            mu_s=float(self.friction),
            mu_k=float(self.mu_k),
            e_n=float(self.normal_restitution),
            e_t=float(self.tangential_restitution),
            law=float(IMPACT_LAWS[self.impact_law]),
            e_right=right,
            e_left=left,
            ratio_kept=float(self.ratio_kept),
            omega_rest=self.rest_speed * self.block.p(self.g),
            chatter_time=float(self.chatter_time),
            balance_right=form.theta_c(1.0),
            balance_left=form.theta_c(-1.0),
        )

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, u: float = 0.0, x: float = 0.0, z: float = 0.0, v: float = 0.0
    ) -> tuple[tuple[float, ...], Discrete]:
        """State at the start: at rest, leaning on a corner, or in the air.

        Args:
            theta, omega: rotation [rad] and angular velocity [rad/s].
            u, v: horizontal and vertical velocity [m/s] of the carrying corner: that to which the block leans, else
                turns, else slides.
            x: position [m] of the middle of the base when upright; the lower corner's is half of the breadth off.
            z: height [m] of the lower corner over the floor, 0 or more.

        Raises:
            ValueError: z is negative, a velocity would drive a corner into the floor, or a corner on the floor moves
                along it with infinite friction.
        """
        within("z", z, 0.0, math.inf)
        leans = theta if theta != 0.0 else omega
        # An upright block that slides carries, once it trips, on the corner that leads.
        s = -1.0 if (leans if leans != 0.0 else u) < 0.0 else 1.0
        y = (x + s * self.shape.half_breadth, float(z), float(theta), float(u), float(v), float(omega))
        return y, Discrete(self._initial_mode(y, leans), s, -1.0 if u < 0.0 else 1.0)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The carrying corner, or the centre of the edge on which the block rolls."""
        form = self.shape
        r = form.edge_radius
        return Anchor(s * form.half_breadth, r, y[0] + r * y[2], y[1] + r, rate[3] + r * rate[5], rate[4])

    def _initial_mode(self, y: tuple[float, ...], leans: float) -> int:
        _, z, _, u, v, omega = y
        if z == 0.0 and v < 0.0:
            raise ValueError(f"v={v!r} m/s: want 0 or more for a corner on the floor")
        if z > 0.0 or v > 0.0:
            return TRANSLATION_JUMP if omega == 0.0 else ROTATION_JUMP
        if u != 0.0 and self.friction == math.inf:
            raise ValueError(f"u={u!r} m/s: want 0 for a corner on the floor with friction=inf, which holds it")
        if leans == 0.0:
            if u == 0.0:
                return REST
            form = self.shape
            arm = form.half_breadth - math.copysign(1.0, u) * form.offset
            return SLIDE if self.mu_k * form.mass_height <= arm * (1.0 + WITHIN) else SLIDE_ROTATION
        return ROTATION if u == 0.0 else SLIDE_ROTATION
