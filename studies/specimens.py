"""The specimens of the shaking-table tests: wooden blocks, named as in the paper.

Source   Winkler, Meguro & Yamazaki (1995), Table 1 (sizes) and section "Numerical stability" (1.4 kg for the lightest,
         Block 4, from which the density follows).
"""

from __future__ import annotations

from rocking import WOOD_DENSITY, Block

SIZES = {
    1: (0.300, 1.00, 0.500),
    2: (0.225, 0.75, 0.375),
    3: (0.150, 0.50, 0.250),
    4: (0.075, 0.25, 0.125),
    5: (0.250, 0.50, 0.250),
    6: (0.200, 0.50, 0.250),
    7: (0.100, 0.50, 0.250),
}
"""Breadth, height, depth [m] by number."""


def specimen(number: int) -> Block:
    """Block `number` of Table 1.

    Raises:
        ValueError: there is no such block.
    """
    if number not in SIZES:
        raise ValueError(f"block {number!r}: want one of {', '.join(map(str, SIZES))} (Table 1 of the paper)")
    return Block(*SIZES[number], density=WOOD_DENSITY)
