"""One corner on an edge: forces of spring, dashpot and friction from its motion; no geometry here.

Source  Winkler, Meguro & Yamazaki (1995), Fig. 7 and the section on forces from displacements; after Cundall
Status  closed forms of drop, rebound, sliding and lever rule hold (tests)

Springs are incremental: F_n grows by kn times the approach of the step, F_s by -ks times its slip. What the paper
leaves open is settled so:

- no tension: F_n >= 0; no adhesion: the total N = F_n + D_n, D_n = -c v_n, is cut at 0;
- Coulomb holds for the total, |F_s| <= mu N (the default), or for the spring alone, |F_s| <= mu F_n, clipped in the
  store; a clipped corner is sliding and has D_s = 0; a sticking one has D_s = -c v_t. With the total, F_s + D_s is cut
  at the limit too, and a corner with N = 0 passes no shear, whatever mu, and forgets F_s: a landing that slides then
  takes just mu times its normal impulse in shear, as in rigid impact. With the spring alone it takes 0.97 of that at
  xi = 0.1 and 0.77 at xi = 0.5. The choice moves the ratio e of rocking by up to 0.004;
- after separation all stored forces are 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numba


class Law(NamedTuple):
    """Contact parameters: kn, ks [N/m], c [N s/m], mu; onset_overlap: first F_n from the overlap; limit_on_spring:
    Coulomb's limit is mu F_n, not mu (F_n + D_n)."""

    kn: float
    ks: float
    c: float
    mu: float
    onset_overlap: bool
    limit_on_spring: bool


@numba.njit
def normal_spring(stored: float, approach: float, law: Law) -> float:
    """F_n [N] after moving in by approach [m]; never tension."""
    return max(0.0, stored + law.kn * approach)


@numba.njit
def normal_total(spring: float, v_n: float, law: Law) -> float:
    """N = F_n - c v_n [N], never adhesion; v_n [m/s] is positive on leaving."""
    return max(0.0, spring - law.c * v_n)


@numba.njit
def friction_limit(spring: float, normal: float, law: Law) -> float:
    """mu N or mu F_n [N], as the law says; 0 without that pressure also where mu is infinite."""
    pressure = spring if law.limit_on_spring else normal
    return law.mu * pressure if pressure > 0.0 else 0.0


@numba.njit
def clipped(force: float, limit: float) -> float:
    """The force [N] brought to within +-limit."""
    return max(-limit, min(limit, force))


@numba.njit
def shear_total(spring: float, v_t: float, limit: float, sliding: bool, law: Law) -> float:
    """F_s + D_s [N]; a sliding corner has no dashpot force."""
    if sliding:
        return spring
    total = spring - law.c * v_t
    return total if law.limit_on_spring else clipped(total, limit)
