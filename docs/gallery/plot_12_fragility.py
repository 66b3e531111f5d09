"""
The fragility of a display case
===============================

One history of a rocking block says little; the share of many does. A case of 0.45 m by 1.50 m under thirty made
records, each scaled up step by step: the fraction that fells it, with its interval, and a lognormal curve.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import norm

import excitation as ex
from rocking import Block, Method1
from rocking.fragility import fragility, run_records

case = Method1(Block(b=0.45, h=1.50))
source = ex.KanaiTajimi(rms=1.0, duration=15.0)
records = [
    ex.scaled_to(source.record(time_step=0.01, seed=seed), pga=1.0) for seed in range(30)
]
scales = np.linspace(2.0, 16.0, 12)  # m/s^2, as each record has a peak of one

runs = run_records(
    case, records, scales, lambda record, k: ex.scaled(record, k).motion(interpolation="linear"),
    t_end=25.0, solver="taylor", intensity=np.ones(30), intensity_name="PGA", intensity_units="m/s^2",
)  # fmt: skip
ds = fragility(runs, limits=[0.5])

figure, ax = plt.subplots(figsize=(7, 4.2))
x = np.geomspace(1.5, 17.0, 200)
for limit, colour, name in (
    (0.5, "#1f5f99", "tilts by half of α"),
    (np.inf, "#c0392b", "falls"),
):
    one = ds.sel(limit=limit)
    error = [one.fraction - one.fraction_low, one.fraction_high - one.fraction]
    ax.errorbar(scales, one.fraction, error, fmt="o", ms=4, lw=0.8, color=colour)
    median, beta = float(one["median"]), float(one.beta)
    ax.plot(
        x,
        norm.cdf(np.log(x / median) / beta),
        color=colour,
        label=f"{name}: median {median:.1f} m/s², β = {beta:.2f}",
    )
ax.set(
    xlabel="peak acceleration [m/s²]",
    ylabel="share of 30 records",
    title="Fragility with 95 % intervals",
)
ax.legend()
plt.show()
