"""Fig. 16's unprinted parameters: which are varied, from what to what, and which method knows them.

The paper prints neither friction nor restitution nor the growth of the ramp; whatever is chosen, the reader sees beside
it how far the curves move, and how far they move when nothing but the last digit changes (the motion is chaotic).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rocking import G_STANDARD
from studies.criteria.overturning import METHODS

G = G_STANDARD


@dataclass(frozen=True)
class Variation:
    """One change of the settings."""

    group: str  # which panel it belongs to
    label: str
    changes: Mapping[str, Any]
    methods: tuple[str, ...] = METHODS


CONTACT = ("method2", "dem")

VARIATIONS = (
    Variation("friction", "friction 0.4", {"friction": 0.4}, CONTACT),
    Variation("friction", "friction 0.5", {"friction": 0.5}, CONTACT),
    Variation("friction", "friction 1.0", {"friction": 1.0}, CONTACT),
    Variation("restitution", "restitution 0.90", {"restitution": 0.90}),
    Variation("restitution", "restitution 0.95", {"restitution": 0.95}),
    Variation("ramp", "ramp to 10 g", {"ramp": 10.0 * G}),
    Variation("ramp", "ramp to 50 g", {"ramp": 50.0 * G}),
    Variation("ramp", "envelope uneven by 10 %", {"imperfection": 0.1, "seed": 1}),
    Variation("other", "nonlinear equations", {"form": "nonlinear"}, ("method1",)),
    Variation("other", "e_n 0.3, e_t 0", {"normal_restitution": 0.3}, ("method2",)),
    Variation(
        "other",
        "e_n 0.3, e_t 0.3",
        {"normal_restitution": 0.3, "tangential_restitution": 0.3},
        ("method2",),
    ),
    Variation(
        "other",
        "the same, kinematic law",
        {"normal_restitution": 0.3, "tangential_restitution": 0.3, "impact_law": "kinematic"},
        ("method2",),
    ),
    Variation("other", "step 1e-5 s", {"dt": 1e-5}, ("dem",)),
    Variation("other", "step 2e-5 s", {"dt": 2e-5}, ("dem",)),
)
"""Changes one at a time from the settings of the main panel."""

SCATTER = tuple(
    Variation("scatter", f"ramp changed by {change:+.0e}", {"ramp_factor": 1.0 + change})
    for change in (-2e-6, -1e-6, 1e-6, 2e-6)
)
"""Changes too small to mean anything: how far they move the curves is how far chance does."""

QUICK = tuple(v for v in VARIATIONS if v.label in ("friction 0.5", "ramp to 10 g", "nonlinear equations"))
"""A few of them, for a quick look."""
