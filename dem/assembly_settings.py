"""How contacts of an assembly are judged, and what ends a run of it.

Source  Winkler, Meguro & Yamazaki (1995), "contact updating"; `python -m studies.contact_judgement`
        measures what each parameter changes (criteria of overturning, drops, cost)
Status  plain numbers, checked when they are given
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from dem import checks


@dataclass(frozen=True)
class ContactJudgement:
    """When a corner counts as on an edge, and when contacts are updated; the defaults depend on the scene.

    skin: places where bodies may touch are listed within this distance [m]. It changes the speed, not the result. None:
        an eighth of the shortest edge or least breadth in the scene, at most a tenth of a typical body's half-diagonal;
        more than half of that edge or breadth is refused
    update_after: the list is made anew when a body may have moved by this much relative to the table [m], 0: at every
        step. None: the most with which no contact can be missed, 0.475 of the skin, less where two bodies could turn so
        far that edges come to face corners they were not listed with
    reach: an edge is felt from this far off [m]
    end_slack: a corner may lie this far beyond the end of an edge when it begins to touch [m]
    facing: how exactly an edge has to face a corner that begins to touch it [rad]
    """

    skin: float | None = None
    update_after: float | None = None
    reach: float = 0.0
    end_slack: float = 1e-9
    facing: float = 0.1

    def __post_init__(self) -> None:
        if self.skin is not None:
            checks.positive("skin", self.skin, "m")
        checks.not_negative("update_after", 0.0 if self.update_after is None else self.update_after, "m")
        checks.not_negative("reach", self.reach, "m")
        checks.not_negative("end_slack", self.end_slack, "m")
        if not 0.0 < checks.real(self.facing) <= 0.15:
            raise ValueError(f"facing={self.facing} rad: want an angle above 0, at most 0.15")


@dataclass(frozen=True)
class Criteria:
    """What ends a run and what is noted.

    stop: 'fall': the first body that falls ends the run; 'all': when all have fallen; 'never': only the end
    tilt: a body has fallen when it has turned by this much relative to the table [rad]
    drop: or when its centroid has sunk by this much [m]; None: half of its own least breadth
    gap, rotation: an interface is open beyond this gap at one of its corners [m] or this relative rotation [rad]
    margin: a body leaves the scene when it is farther from the box around the scene than this [m]; None: ten times the
        box, and 10 m
    """

    stop: str = "fall"
    tilt: float = 0.5 * math.pi
    drop: float | None = None
    gap: float = 1e-3
    rotation: float = 5e-3
    margin: float | None = None

    def __post_init__(self) -> None:
        if self.stop not in ("fall", "all", "never"):
            raise ValueError(f"stop={self.stop!r}: want 'fall', 'all' or 'never'")
        for name, unit in (("tilt", "rad"), ("drop", "m"), ("gap", "m"), ("rotation", "rad"), ("margin", "m")):
            value = getattr(self, name)
            if value is not None or name not in ("drop", "margin"):
                checks.positive(name, value, unit)
