"""
Steady rocking
==============

Under a sine of constant amplitude a block may settle into a steady swing. Where it exists and where it is stable is
known in closed form for the linear equation (Spanos & Koh 1984, Hogan 1989).
"""

import matplotlib.pyplot as plt
import numpy as np

from rocking.steady_states import stable_range, steady_states

e = 0.9
ratio = np.linspace(0.8, 12.0, 200)
ends = {n: np.array([stable_range(w, e, n) for w in ratio]) for n in (1, 3)}

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.9))
for n, colour in ((1, "#1f5f99"), (3, "#c0392b")):
    low, high = ends[n].T
    left.fill_between(
        ratio,
        low,
        np.minimum(high, 40.0),
        color=colour,
        alpha=0.35,
        label=f"one swing in {n} period(s)",
    )
left.axhline(1.0, color="k", lw=0.8, ls="--")
left.set(
    xlabel="ω/p", ylabel="amplitude / (gα)", ylim=(0, 15), title=f"stable orbits exist, e = {e}"
)
left.legend(fontsize=8)

w = 4.0
amplitude = np.linspace(0.1, 9.0, 400)
for k in (0, 1):
    found = [steady_states(w, a, e) for a in amplitude]
    peaks = [s[k].peak if len(s) > k and s[k].admissible else np.nan for s in found]
    stable = [bool(len(s) > k and s[k].stable) for s in found]
    right.plot(amplitude, np.where(stable, peaks, np.nan), "-", color="#1f5f99")
    right.plot(amplitude, np.where(stable, np.nan, peaks), ":", color="0.4")
right.axhline(1.0, color="k", lw=0.8, ls="--")
right.set(
    xlabel="amplitude / (gα)",
    ylabel="peak tilt / α",
    title=f"ω/p = {w:g}; dotted: unstable",
    ylim=(0, 1.5),
)
figure.tight_layout()
plt.show()
