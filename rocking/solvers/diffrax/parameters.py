"""The parameters of Method 1 and Method 2 from sizes and coefficients that are traced, or arrays of them.

`system.parameters` is computed from plain floats; here the same formulas run in JAX, so that a derivative with respect
to b, h, g or a coefficient takes all that hangs on it along, and a batch may hold a million sizes.

Source   the formulas of `rocking.block`, `rocking.method1` and `rocking.method2`.
Status   equal to `system.parameters` to rounding (tests); ranges are checked in the systems, not here.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from rocking.hybrid import System
from rocking.method1 import Method1
from rocking.method1 import Parameters as Parameters1
from rocking.method2 import IMPACT_LAWS, Method2
from rocking.method2_equations import Parameters as Parameters2

BLOCK_NAMES = ("b", "h", "g", "rest_speed")
METHOD1_NAMES: tuple[str, ...] = (*BLOCK_NAMES, "restitution")
METHOD2_NAMES: tuple[str, ...] = (
    *BLOCK_NAMES,
    "restitution",
    "friction",
    "kinetic_friction",
    "normal_restitution",
    "tangential_restitution",
    "ratio_kept",
    "chatter_time",
)


def parameters_for(system: System, **changes: Any) -> Any:
    """`system.parameters` with some of the system's own arguments replaced, which may be traced or arrays.

    >>> from rocking import Block, Method1
    >>> system = Method1(Block(b=0.2, h=0.8))
    >>> taller = parameters_for(system, h=1.0)
    >>> bool(abs(taller.alpha - Block(b=0.2, h=1.0).alpha) < 1e-15)
    True

    Args:
        system: a `Method1` or `Method2`; it gives what is not replaced, and decides on form, onset and impact law.
        changes: b, h [m], g [m/s^2], rest_speed [1] and restitution [1]; of Method 2 also friction, kinetic_friction,
            normal_restitution, tangential_restitution, ratio_kept [1] and chatter_time [s].  What the system takes
            from another (Housner's restitution from b and h, kinetic friction from static) follows it.

    Returns:
        The NamedTuple that the system's equations take; each entry has the shape that its arguments broadcast to.

    Raises:
        ValueError: the system is neither, has a form of its own, or does not have an argument of that name.
    """
    if not isinstance(system, Method1 | Method2):
        raise ValueError(f"system={system!r}: want a Method1 or a Method2")
    if isinstance(system, Method2) and system.form is not None:
        raise ValueError(f"system={system!r}: want a Method2 without a form of its own, whose b and h are its size")
    names = METHOD1_NAMES if isinstance(system, Method1) else METHOD2_NAMES
    unknown = [name for name in changes if name not in names]
    if unknown:
        raise ValueError(f"{unknown[0]}: want one of {', '.join(names)}")
    own = {name: getattr(system.block if name in ("b", "h") else system, name) for name in names}
    xp = jnp if any(isinstance(value, jax.Array) for value in changes.values()) else np
    return (_method1 if isinstance(system, Method1) else _method2)(xp, system, own | changes)


def _geometry(xp: Any, v: dict[str, Any]) -> tuple[Any, Any, Any]:
    """(R, alpha, p^2) of a uniform rectangle: p^2 = 3g/4R."""
    R = 0.5 * xp.sqrt(v["b"] ** 2 + v["h"] ** 2)
    return R, xp.arctan2(v["b"], v["h"]), 0.75 * v["g"] / R


def _housner(xp: Any, alpha: Any) -> Any:
    """Housner's restitution [1], 0 where it would be below: such a block lands on both corners and stops."""
    return xp.maximum(1.0 - 1.5 * xp.sin(alpha) ** 2, 0.0)


def _method1(xp: Any, system: Any, v: dict[str, Any]) -> Parameters1:
    _, alpha, p2 = _geometry(xp, v)
    e = _housner(xp, alpha) if v["restitution"] is None else v["restitution"]
    onset = v["b"] / v["h"] if system.onset == "west" else alpha
    return Parameters1(p2=p2, alpha=alpha, g=v["g"], onset=onset, e=e, omega_rest=v["rest_speed"] * xp.sqrt(p2))


def _method2(xp: Any, system: Any, v: dict[str, Any]) -> Parameters2:
    _, alpha, p2 = _geometry(xp, v)
    b, h = v["b"], v["h"]
    e = _housner(xp, alpha) if v["restitution"] is None else v["restitution"]
    return Parameters2(
        a=0.5 * b,
        r=0.0,
        o=0.0,
        H=0.5 * h,
        rho2=(b**2 + h**2) / 12.0,
        g=v["g"],
        hold=0.0,
        mu_s=v["friction"],
        mu_k=v["friction"] if v["kinetic_friction"] is None else v["kinetic_friction"],
        e_n=v["normal_restitution"],
        e_t=v["tangential_restitution"],
        law=float(IMPACT_LAWS[system.impact_law]),
        e_right=e,
        e_left=e,
        ratio_kept=v["ratio_kept"],
        omega_rest=v["rest_speed"] * xp.sqrt(p2),
        chatter_time=v["chatter_time"],
        balance_right=alpha,
        balance_left=alpha,
    )
