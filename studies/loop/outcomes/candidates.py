"""Which effects outcomes can show, and between which sizes they are looked for.

An outcome says little, so that only large effects can be seen in a few hundred of them: the ranges are wider than what
records of rotation would need, and end where an effect would have been seen without any model (a gain of 1.35).
Effects of the rotation sensor and of a clock do not change who falls.

Status   sizes in terms of the block, so that they serve a tombstone and a matchbox alike.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from rocking import G_STANDARD
from studies.campaigns import DeclaredBlock
from studies.loop.models.candidates import Candidate, grips
from studies.loop.models.model import DRIFT, RESTITUTION
from studies.loop.models.parameters import Parameter
from studies.loop.swings.learning import TERM

UNSEEN = {
    "rotation_gain": "outcomes do not depend on the rotation sensor",
    "rotation_offset": "outcomes do not depend on the rotation sensor",
    "base_motion_lag": "outcomes do not depend on when a motion is recorded",
}
"""Effects that change no outcome, and why."""

COSTLY = {"compliant_base": 3, "bouncing": 2}
"""Effects of which fewer points are tried, by that factor: a stiff contact takes as much longer to run."""


def ranged(name: str, low: float, high: float, *, log: bool = False) -> Parameter:
    """A parameter that is looked for between two sizes; its scale is the whole range, or that of its logarithm."""
    scale = math.log(high / low) if log else high - low
    return Parameter(name, scale, low, high, log)


def restitution(low: float) -> Parameter:
    """Restitution from a lowest value to 1."""
    return ranged(RESTITUTION, low, 1.0)


@dataclass(frozen=True)
class Form:
    """A candidate whose parameters are looked for within their bounds."""

    candidate: Candidate

    @property
    def cost(self) -> int:
        """By how much fewer points are tried."""
        return COSTLY.get(self.candidate.effect, 1)


def _form(
    name: str, parameters: Mapping[str, tuple[float, float]], fixed: Mapping[str, float] | None = None,
    log: tuple[str, ...] = (),
) -> Form:  # fmt: skip
    effect = name.partition("[")[0]
    own = tuple(ranged(f"{effect}.{key}", *ends, log=key in log) for key, ends in parameters.items())
    start = {p.name: p.outer(0.5 * (p.inner(p.low) + p.inner(p.high))) for p in own}
    return Form(Candidate(name, effect, own, (start,), {f"{effect}.{k}": v for k, v in (fixed or {}).items()}))


def forms(block: DeclaredBlock, friction: float | None = None) -> tuple[Form, ...]:
    """The forms of the effects that are looked for in outcomes of this block.

    friction: of the block on its base [1], where the laboratory declares it.
    """
    return (*_of_the_block(block), *_of_the_contact(block, friction), *_of_the_base(block))


def _of_the_block(block: DeclaredBlock) -> tuple[Form, ...]:
    b, H, I = block.breadth, block.centre_height, block.I_c  # noqa: E741
    return (
        _form("rounded_edges", {"radius": (0.0, 0.3 * b)}),
        _form("concave_base", {"breadth": (0.3 * b, b)}),
        _form("eccentric_mass", {"offset": (-0.15 * b, 0.15 * b)}),
        _form("mass_distribution", {"height": (0.7 * H, 1.4 * H), "inertia": (0.6 * I, 1.6 * I)}),
    )


def _of_the_contact(block: DeclaredBlock, friction: float | None) -> tuple[Form, ...]:
    grip, _ = grips(block, friction)
    weight, p, alpha = block.mass * G_STANDARD, block.p(), block.alpha
    # Angular velocity with which a block comes down that leaned by about a quarter of alpha.
    omega = 0.7 * p * alpha
    moment, spring = 0.5 * weight * block.breadth, weight * block.R
    soft = weight / (0.004 * block.breadth)
    pulled = {"slack": (0.05 * alpha, 0.8 * alpha), "stiffness": (0.05 * spring, 10.0 * spring)}
    tan = math.tan(alpha)
    return (
        _form("velocity_dependent_restitution", {"slope": (-0.2 / omega, 0.2 / omega)}),
        _form("viscous_damping", {"coefficient": (0.0, 0.2 * p)}),
        _form("quadratic_drag", {"coefficient": (0.0, 0.6 / alpha)}),
        _form("compliant_base", {"corner_stiffness": (0.2 * soft, 10.0 * soft)},
              {"damping_ratio": 0.2, "friction": grip}, ("corner_stiffness",)),
        *(_form(f"tether[{side}]", pulled, {"side": sign}, ("stiffness",))
          for side, sign in (("both", 0.0), ("right", 1.0), ("left", -1.0))),
        _form("sliding", {"friction": (0.8 * tan, 1.5 * tan)}),
        _form("bouncing", {"normal_restitution": (0.0, 0.9)}, {"friction": math.inf}),
        _form("base_adhesion", {"moment": (0.0, 2.5 * moment)}),
    )  # fmt: skip


def _of_the_base(block: DeclaredBlock) -> tuple[Form, ...]:
    second = {f"second_harmonic_{kind}": (-0.8, 0.8) for kind in ("ratio", "quadrature")}
    return (
        _form("base_tilt", {"angle": (-0.4 * block.alpha, 0.4 * block.alpha)}),
        _form("table_pitch[acceleration]", {"per_acceleration": (-4e-4, 4e-4)}),
        _form("table_pitch[displacement]", {"per_displacement": (-0.25, 0.25)}),
        _form("vertical_motion[ratio]", {"ratio": (-1.0, 1.0)}),
        _form("vertical_motion[second_harmonic]", second),
        _form("base_motion_gain", {"gain": (0.75, 1.35)}),
    )


def terms(block: DeclaredBlock) -> tuple[Form, ...]:
    """Coefficients of a learned term, for what no effect explains."""
    p, alpha = block.p(), block.alpha
    torque, omega = p**2 * alpha, 0.7 * p * alpha
    sizes = {
        "spring": 0.4 * p**2,
        "cubic": 0.6 * p**2 / alpha**2,
        "side_damping": 0.2 * p,
        "friction": 0.2 * torque,
        "restitution_side": 0.1,
        "restitution_square": 0.2 / omega**2,
    }
    found = [_term(f"learned[{name}]", f"{TERM}.{name}", size) for name, size in sizes.items()]
    return (*found, _term(DRIFT, DRIFT, 2e-3))


def _term(name: str, full: str, size: float) -> Form:
    return Form(Candidate(name, TERM, (ranged(full, -size, size),), ({full: 0.0},), {}))
