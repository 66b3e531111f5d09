"""Learned memory: a restitution that depends on the impacts before, where no effect with a name explains it.

Adds        e += first exp(-n / first_impacts) + recent exp(-t / recent_time), n impacts since the start of the test
            that were faster than least_speed, the last of them a time t ago
Parameters  first [1] and recent [1], 0 where absent; first_impacts [1]; recent_time [s]; least_speed [rad/s]
Use when    the first impacts of each test lose more or less than the later ones (a surface beds in), or those after a
            short swing other than those after a long one at the same speed (air or a pad that takes time to come back)
Limits      two decays; it goes with effects on form, flow and impact, and not with a floor that gives or other modes
Source      a plain description, as in the identification of systems with memory from residuals; `rocking.remembering`
Status      by hand from impact to impact, and the absent value (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from rocking.composed import ComposedMethod1
from rocking.effect import Effect
from rocking.hybrid import System
from rocking.remembering import RememberingBlock


@dataclass(frozen=True)
class LearnedMemory(Effect):
    """What the first impacts [1] and those after short pauses [1] have more, over how many [1] and how long [s].

    least_speed: of the impacts that count [rad/s].
    """

    first: float = 0.0
    first_impacts: float = 4.0
    recent: float = 0.0
    recent_time: float = 0.3
    least_speed: float = 0.0

    name: ClassVar[str] = "learned_memory"
    units: ClassVar[dict[str, str]] = {
        "first": "1",
        "first_impacts": "1",
        "recent": "1",
        "recent_time": "s",
        "least_speed": "rad/s",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "first": (-1.0, 1.0),
        "first_impacts": (0.1, 1e4),
        "recent": (-1.0, 1.0),
        "recent_time": (1e-4, 1e4),
        "least_speed": (0.0, 1e6),
    }

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block with the impacts so far and the time since the last one as states."""
        return RememberingBlock(system, self.first, self.first_impacts, self.recent, self.recent_time, self.least_speed)
