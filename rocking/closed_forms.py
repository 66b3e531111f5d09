"""Closed forms of the rocking block: what theory gives without integrating anything.

The linear equation of motion throughout (small alpha), unless said otherwise; alpha is the slenderness angle [rad], p
the frequency parameter [rad/s].

Source   named with each formula.
"""

from __future__ import annotations

import math

from rocking.block import G_STANDARD, Block
from rocking.validation import positive, real, within

MOST_IMPACTS = 1_000_000
"""Impacts whose times are summed one by one."""


def west_acceleration(b: float, h: float, a_z: float = 0.0, g: float = G_STANDARD) -> float:
    """Horizontal base acceleration [m/s^2] at which a block starts to rock, (b/h)(g + a_z).

    West's formula, in Milne (1885); eq. (1) of Winkler, Meguro & Yamazaki (1995).  Exact for a rigid rectangle.

    Args:
        b, h: breadth and height [m].
        a_z: vertical base acceleration [m/s^2], up positive, above -g.
        g: gravity [m/s^2].
    """
    positive("b", b, "m")
    positive("h", h, "m")
    positive("g", g, "m/s^2")
    if not -g < real(a_z) < math.inf:
        raise ValueError(f"g + a_z={g + real(a_z)!r} m/s^2 with a_z={a_z!r}: want a positive number")
    return b / h * (g + a_z)


def quarter_period(theta0: float, alpha: float, p: float) -> float:
    """Time [s] from release at theta0 to the first impact, acosh(1 / (1 - theta0/alpha)) / p.

    Housner (1963), eq. for the period of free rocking; it grows without bound as theta0 nears alpha.

    Args:
        theta0: tilt at release [rad], 0 to below alpha.
        alpha: slenderness angle [rad].
        p: frequency parameter [rad/s].
    """
    positive("alpha", alpha, "rad")
    positive("p", p, "rad/s")
    if not 0.0 <= real(theta0) < alpha:
        raise ValueError(f"theta0={theta0!r} rad: want 0 to below alpha={alpha!r}")
    return math.acosh(1.0 / (1.0 - theta0 / alpha)) / p


def free_peak(theta0: float, alpha: float, e: float, n: int) -> float:
    """Peak tilt [rad] after n impacts of a block released at theta0.

        alpha (1 - sqrt(1 - e^(2n) (1 - (1 - theta0/alpha)^2)))

    Housner (1963): each impact leaves the share e^2 of the kinetic energy.

    Args:
        theta0, alpha: tilt at release and slenderness angle [rad], 0 <= theta0 <= alpha.
        e: restitution, omega after / before an impact [1], 0 to 1.
        n: number of impacts, 0 or more.
    """
    positive("alpha", alpha, "rad")
    within("theta0", theta0, 0.0, alpha)
    within("e", e, 0.0, 1.0)
    if not (real(n) >= 0.0 and real(n) % 1.0 == 0.0):
        raise ValueError(f"n={n!r}: want 0 or more impacts, a whole number")
    return alpha * (1.0 - math.sqrt(1.0 - e ** (2 * n) * (1.0 - (1.0 - theta0 / alpha) ** 2)))


def free_impact_time(theta0: float, alpha: float, p: float, e: float, n: int) -> float:
    """Time [s] of impact n = 1, 2, ... after release at theta0: one quarter period, then two of each smaller peak.

    Housner (1963).  Arguments as of `quarter_period` and `free_peak`.
    """
    if not (1.0 <= real(n) <= MOST_IMPACTS and real(n) % 1.0 == 0.0):
        raise ValueError(f"n={n!r}: want impact 1 or a later one, up to {MOST_IMPACTS}")
    n = int(n)
    total = quarter_period(theta0, alpha, p)
    for i in range(1, n):
        total += 2.0 * quarter_period(free_peak(theta0, alpha, e, i), alpha, p)
    return total


def zeno_time(omega: float, alpha: float, p: float, e: float) -> float:
    """Time [s] that all further impacts take of a block that has just left an impact with a small omega [rad/s].

        2 omega / (p^2 alpha (1 - e))

    A geometric series: a small swing takes 2 omega / (p^2 alpha), the next one e times that.
    """
    positive("alpha", alpha, "rad")
    positive("p", p, "rad/s")
    within("omega", omega, 0.0, math.inf)
    if not 0.0 <= real(e) < 1.0:
        raise ValueError(f"e={e!r}: want 0 to below 1")
    return 2.0 * omega / (p * p * alpha * (1.0 - e))


def rectangular_pulse(duration: float, p: float) -> float:
    """Least amplitude of a rectangular acceleration pulse that overturns, over g alpha [1]: 1 / (1 - exp(-p t)).

    Housner (1963), corrected: exp(p t) = A / (A - 1).

    Args:
        duration: t of the pulse [s].
        p: frequency parameter [rad/s].
    """
    positive("duration", duration, "s")
    positive("p", p, "rad/s")
    return -1.0 / math.expm1(-p * duration)


MOST_RATIO = 1e6
"""Frequency of a pulse over p up to which it is looked at: a half sine then takes half as many times g alpha."""


def _sine_pulse(ratio: float, half_cycles: int) -> float:
    """Amplitude over g alpha at which the state after the pulse lies on the path to unstable balance.

    With tau = p t the leaning block obeys x'' - x = -1 + A sin(ratio tau + psi), x = theta/alpha, from when
    A sin psi = 1 on; it overturns when x + x' > 1 at the end of the pulse.
    """
    from scipy.optimize import brentq

    _check_ratio(ratio)

    def beyond(A: float) -> float:
        psi = math.asin(1.0 / A)
        end = (half_cycles * math.pi - psi) / ratio
        c = -A / (1.0 + ratio * ratio)
        # x = 1 + c sin(ratio tau + psi) + k cosh tau + l sinh tau, x(0) = x'(0) = 0; only x + x' - 1 is wanted.
        k, l_ = -1.0 - c * math.sin(psi), -c * ratio * math.cos(psi)
        phase = half_cycles * math.pi
        # Divided by exp(end), so that a long pulse does not overflow.
        forced = c * (math.sin(phase) + ratio * math.cos(phase)) * math.exp(-end)
        return forced + k + l_

    if beyond(1.0) >= 0.0:  # to rounding, of pulses that last for ever
        return 1.0
    high = 2.0
    while beyond(high) < 0.0:
        high *= 2.0
    return float(brentq(beyond, 1.0, high, xtol=1e-13, rtol=1e-14))


def _check_ratio(ratio: float) -> None:
    positive("frequency ratio", ratio, "1")
    if ratio > MOST_RATIO:
        raise ValueError(f"frequency ratio={ratio!r}: want at most {MOST_RATIO:g}")


def half_sine_pulse(ratio: float) -> float:
    """Least amplitude of a half-sine acceleration pulse that overturns, over g alpha [1].

    Housner (1963) with the onset of rocking at A sin(psi) = 1 taken into account; not sqrt(1 + ratio^2).

    Args:
        ratio: angular frequency of the sine over p [1], at most `MOST_RATIO`.
    """
    return _sine_pulse(ratio, 1)


def full_sine_pulse(ratio: float) -> float:
    """Amplitude of a one-cycle sine at which a block overturns without an impact, over g alpha [1].

    After Zhang & Makris (2001); overturning after an impact may need less (`rocking.pulse_overturning`).

    Args:
        ratio: angular frequency of the sine over p [1], at most `MOST_RATIO`.
    """
    return _sine_pulse(ratio, 2)


def full_cosine_pulse(ratio: float) -> float:
    """Amplitude of a one-cycle cosine at which a block overturns without an impact, over g alpha [1].

        (1 + ratio^2) / (1 - exp(-2 pi/ratio))

    After Zhang & Makris (2001): the block leans at once, and x + x' = 1 at the end of the pulse; up to there
    x = 1 - c cos(ratio tau) + (c - 1) cosh(tau), c = 1/(1 - exp(-2 pi/ratio)), is nowhere below zero.  Overturning
    after an impact may need less (`rocking.pulse_overturning`).

    Args:
        ratio: angular frequency of the cosine over p [1], at most `MOST_RATIO`.
    """
    _check_ratio(ratio)
    return -(1.0 + ratio * ratio) / math.expm1(-2.0 * math.pi / ratio)


def ishiyama_velocity(block: Block, g: float = G_STANDARD) -> float:
    """Lower limit of the peak base velocity [m/s] that overturns, 0.4 sqrt(8 g R (1 - cos alpha) / 3) / cos alpha.

    Ishiyama (1982); close to 10 b / sqrt(h) in cm/s with b and h in cm.  The velocity is that of a shock that
    overturns, times 0.4, his lower bound of what simulated motions of longer duration needed: a rule, not a theorem.
    His limit of the peak acceleration is that of the start of rocking, `west_acceleration`.
    """
    if not isinstance(block, Block):
        raise ValueError(f"block={block!r}: want a Block")
    positive("g", g, "m/s^2")
    return 0.4 * math.sqrt(8.0 * g * block.R * (1.0 - math.cos(block.alpha)) / 3.0) / math.cos(block.alpha)
