"""A block on springs under its corners: runs with numbers of the floor, and where its feet are."""

from typing import Any

import numpy as np

from rocking import Block, Method1, solve
from rocking.effects import parse

BLOCK = Block(b=0.15, h=0.50, d=0.25)


def on_springs(k: float, xi: float, mu: float, ratio: float = 1.0, block: Block = BLOCK, **options: Any) -> Any:
    """A run; `slider` and `spread` among the options are those of the floor."""
    numbers = {
        "corner_stiffness": k, "damping_ratio": xi, "friction": mu, "tangential_ratio": ratio,
        "spring_slider": options.pop("slider", 0.0), "spread": options.pop("spread", 0.0),
    }  # fmt: skip
    effects = parse([f"compliant_base.{name}={value!r}" for name, value in numbers.items()])
    return solve(Method1(block), options.pop("motion", None), effects=effects, **options)


def feet(y: np.ndarray, side: float) -> tuple[np.ndarray, ...]:
    """Stretch along the floor, height and both velocities of the foot of `BLOCK` on that side, shape (time,)."""
    x, z, theta, u, v, omega = y.T[:6]
    r_x = side * 0.075 * np.cos(theta) - 0.25 * np.sin(theta)
    r_z = -side * 0.075 * np.sin(theta) - 0.25 * np.cos(theta)
    return x + r_x - y[:, 6 if side > 0.0 else 7], z + r_z, u + omega * r_z, v - omega * r_x
