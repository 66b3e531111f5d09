"""Bouncing: the corner leaves the floor after an impact.

Changes     impacts at an instant: the modes, Method 2 (Ishiyama's six) in place of Method 1, with a normal restitution
            and no slip limit but that of friction; contacts that last: two freedoms, a spring and a dashpot under each
            corner (`rocking.soft_floor`), along the floor as strong as friction lets them be
Parameters  normal_restitution e_n [1], 0 where it is absent; it takes the place of restitution.  friction mu [1],
            infinite where it is absent.  stops [1]: 1 where each impact stops the corner along the floor, whatever
            friction that takes, 0 (unless given) where it may be left with a slip, as energy and friction ask; of
            impacts at an instant.  contact_frequency f [Hz] of a corner on its spring, infinite where impacts
            happen at an instant.  tangential_ratio [1], its stiffness along the floor over that normal to it: 20 unless
            given, with which it is all but held.  spring_slider [1]: 1 where friction limits its spring along
            the floor alone (`rocking.spring_slider`), 2 where it is that of the spring into it alone, too, 0 (unless
            given) where it limits spring and dashpot in series.
            Both are without effect where impacts happen at an instant
Use when    short blocks or stiff floors: after an impact the corner is seen to lift, or the block rattles.  With f a
            corner may bounce while the other one is still in contact; what a swing of a slender block loses is then
            much the same for a higher f and a lower e_n
Limits      at an instant those of Method 2: impacts are frictional (Chatterjee & Ruina 1998), so that e of eq. (4)
            follows: near Housner's, and the lower the more the corner bounces; with `stops` they are kinematic, e
            stays nearer to Housner's, and e_n is no more than lets no energy be made (0.8 of a rectangle).  No effect
            that changes restitution goes with it then.  With f it goes with effects on form and flow, and not with
            rounded_edges, base_adhesion or compliant_base; sliding says the friction of its corners
Source      Ishiyama (1982); Lipscombe & Pellegrino (1993) for bouncing of short blocks; `rocking.method2`.  The
            dashpot leaves e_n of a speed within half a period, xi = -ln e_n / sqrt(pi^2 + ln^2 e_n); a contact that
            does not pull ends earlier and leaves somewhat more (Schwager & Poeschel 2007, Granular Matter 9, 465-469)
Status      tests of Method 2, and of the floor that gives
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from rocking.composed import ComposedMethod1
from rocking.effect import Effect
from rocking.form import Form
from rocking.hybrid import System
from rocking.method1 import Method1
from rocking.method2 import ImpactLaw, Method2
from rocking.spring_slider import sliding_as

HELD = 20.0
"""Stiffness of a corner along the floor over that normal to it with which it is all but held in place."""


@dataclass(frozen=True)
class Bouncing(Effect):
    """Normal restitution [1] of a corner, friction [1], frequency of its contact [Hz], stiffness of that along the
    floor [1], whether impacts stop it there [1], and whether friction limits that spring alone [1]."""

    normal_restitution: float = 0.0
    friction: float = math.inf
    contact_frequency: float = math.inf
    tangential_ratio: float = HELD
    stops: float = 0.0
    spring_slider: float = 0.0

    name: ClassVar[str] = "bouncing"
    units: ClassVar[dict[str, str]] = {
        "normal_restitution": "1",
        "friction": "1",
        "contact_frequency": "Hz",
        "tangential_ratio": "1",
        "stops": "1",
        "spring_slider": "1",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "normal_restitution": (0.0, 1.0),
        "friction": (0.0, math.inf),
        "contact_frequency": (0.0, math.inf),
        "tangential_ratio": (0.0, math.inf),
        "stops": (0.0, 1.0),
        "spring_slider": (0.0, 2.0),
    }

    def ways_used(self) -> frozenset[str]:
        """Further freedoms where contacts last, other modes where impacts happen at an instant."""
        return frozenset({"modes" if self.contact_frequency == math.inf else "freedoms"})

    def has_feet(self) -> bool:
        """Where contacts last."""
        return self.contact_frequency < math.inf

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block on a spring and a dashpot under each corner.

        Raises:
            ValueError: the springs are so soft that the block cannot stand, friction and normal restitution do not go
                together, or the block has an effect that these equations do not have.
        """
        if self.stops:
            raise ValueError(
                f"bouncing.stops={self.stops!r}: want 0 beside bouncing.contact_frequency={self.contact_frequency!r} "
                "Hz, where bouncing.tangential_ratio says what a contact does along the floor"
            )
        if self.friction == 0.0:
            raise ValueError(
                f"bouncing.friction={self.friction!r}: want more than 0 beside bouncing.contact_frequency="
                f"{self.contact_frequency!r} Hz, or inf where the corners are held"
            )
        if self.friction < math.inf and self.normal_restitution == 1.0:
            raise ValueError(
                f"bouncing.normal_restitution=1.0: want less than 1 beside bouncing.friction={self.friction!r} and a "
                "contact_frequency, for a corner that slips takes a dashpot"
            )
        form = system.form
        felt = form.mass / (1.0 + form.half_breadth**2 / form.rho2)  # of the block at a corner, normal to the floor
        stiffness = felt * (2.0 * math.pi * self.contact_frequency) ** 2
        lost = -math.log(self.normal_restitution) if self.normal_restitution > 0.0 else math.inf
        share = lost / math.hypot(math.pi, lost) if lost < math.inf else 1.0
        try:
            return sliding_as(self.name, self.spring_slider)(
                system, stiffness, share * math.sqrt(felt / form.mass), 0.0, self.tangential_ratio, self.friction
            )
        except ValueError as error:
            if not str(error).startswith("corner_stiffness"):
                raise
            raise ValueError(f"bouncing.contact_frequency={self.contact_frequency!r} Hz: {error}") from None

    def modes(self, method: Method1 | Method2, form: Form | None) -> Method2:
        """The block under Method 2 with this restitution of its corners.

        Raises:
            ValueError: Method 2 cannot have these numbers, or another effect has given a friction.
        """
        if self.stops not in (0.0, 1.0):
            raise ValueError(f"bouncing.stops={self.stops!r}: want 0 or 1")
        impact_law: ImpactLaw = "kinematic" if self.stops else "frictional"
        if isinstance(method, Method2):
            if self.friction < math.inf:
                raise ValueError(
                    f"bouncing.friction={self.friction!r}: sliding.friction={method.friction!r} says it too"
                )
            if self.normal_restitution == 0.0:
                return method
            return replace(
                method, normal_restitution=self.normal_restitution, impact_law=impact_law, restitution=None,
                ratio_kept=0.0,
            )  # fmt: skip
        law: dict[str, Any] = {"impact_law": impact_law}
        if self.normal_restitution == 0.0 and method.restitution is not None:
            law = {"impact_law": "two_corner", "restitution": method.restitution}
        return Method2(
            method.block, friction=self.friction, normal_restitution=self.normal_restitution, g=method.g,
            rest_speed=method.rest_speed, form=form, **law,
        )  # fmt: skip
