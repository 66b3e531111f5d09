"""Learned memory: a restitution that depends on the impacts before, or on the base, where no effect with a name does.

Adds        e += first exp(-n / first_impacts) + recent exp(-t / recent_time) + worn (1 - exp(-w / worn_use))
            + pushed sign(omega) a_x + shaken |a_x|, n impacts since the start of the test that were faster than
            least_speed, the last of them a time t ago; w the sum of |omega|^worn_exponent over these and those of all
            tests before, which are `used`; a_x of the base, in the axes of the floor, as the block falls on its edge
            with omega
Parameters  first [1], recent [1], worn [1], pushed [s^2/m] and shaken [s^2/m], 0 where absent; first_impacts [1];
            recent_time [s]; least_speed [rad/s]; worn_use and used [(rad/s)^worn_exponent], worn_exponent [1]: 0 where
            each impact wears alike, 2 where it wears as it takes energy
Use when    the first impacts of each test lose more or less than the later ones (a surface beds in), those after a
            short swing other than those after a long one at the same speed (air or a pad that takes time to come back),
            those of a block that has been used for long other than those of a new one (wear), or those on a base that
            is accelerated other than those on one at rest
Limits      two decays and a rise; it goes with effects on form, flow and impact, and not with a floor that gives or
            other modes
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
    worn: what those of a block that has been used for long have more [1], over how much use [(rad/s)^worn_exponent].
    used: use before the start, of the same unit.
    pushed, shaken: what an impact has more per acceleration of the base, with its sense or without [s^2/m].
    """

    first: float = 0.0
    first_impacts: float = 4.0
    recent: float = 0.0
    recent_time: float = 0.3
    least_speed: float = 0.0
    worn: float = 0.0
    worn_use: float = 1.0
    worn_exponent: float = 2.0
    used: float = 0.0
    pushed: float = 0.0
    shaken: float = 0.0

    name: ClassVar[str] = "learned_memory"
    units: ClassVar[dict[str, str]] = {
        "first": "1",
        "first_impacts": "1",
        "recent": "1",
        "recent_time": "s",
        "least_speed": "rad/s",
        "worn": "1",
        "worn_use": "(rad/s)^worn_exponent",
        "worn_exponent": "1",
        "used": "(rad/s)^worn_exponent",
        "pushed": "s^2/m",
        "shaken": "s^2/m",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "first": (-1.0, 1.0),
        "first_impacts": (0.1, 1e4),
        "recent": (-1.0, 1.0),
        "recent_time": (1e-4, 1e4),
        "least_speed": (0.0, 1e6),
        "worn": (-1.0, 1.0),
        "worn_use": (1e-6, 1e12),
        "worn_exponent": (0.0, 4.0),
        "used": (0.0, 1e12),
        "pushed": (-1.0, 1.0),
        "shaken": (-1.0, 1.0),
    }

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block with the impacts so far, the time since the last one and its use as states."""
        return RememberingBlock(system, **self.parameters())
