"""
Is my bookshelf safe?
=====================

A bookshelf of 0.30 m by 1.80 m stands on a floor that may shake. Which single push fells it? Each point of the map
is one cycle of a sine, with its period and its peak acceleration.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, NullLocator

from excitation import PiecewiseLinear
from rocking import Block, Method1
from rocking.closed_forms import ishiyama_velocity, west_acceleration
from rocking.maps import overturning_map

shelf = Block(b=0.30, h=1.80)


def build(period, peak):
    cycle = np.sin(2.0 * np.pi * np.arange(201) / 200.0)
    return Method1(shelf), PiecewiseLinear(period / 200.0, peak * cycle)


axes = {"period": np.geomspace(0.2, 3.0, 60), "peak": np.geomspace(1.0, 15.0, 60)}
ds = overturning_map(
    build, axes, t_end=12.0, solver="taylor", units={"period": "s", "peak": "m/s^2"}
)

# %%
# Below the dashed line it does not even rock. Between the lines it rocks and comes back; in the dark area it
# falls. A push of a given velocity lies on a falling line: velocity fells, not acceleration alone.

figure, ax = plt.subplots(figsize=(7, 4.5))
ax.contourf(
    ds.period, ds.peak, ds.overturned.T, levels=[0.5, 1.5], colors=["#c0392b"], alpha=0.75
)
ax.axhline(
    west_acceleration(shelf.b, shelf.h), ls="--", color="k", label="starts to rock: $(b/h)\\,g$"
)
velocity = ishiyama_velocity(shelf)
ax.plot(
    ds.period,
    np.pi * velocity / ds.period,
    ":",
    color="k",
    label=f"peak velocity {velocity:.2f} m/s (Ishiyama's limit)",
)
ax.set(
    xscale="log",
    yscale="log",
    ylim=(1.0, 15.0),
    xlabel="period of the push [s]",
    ylabel="peak acceleration [m/s²]",
)
for axis, ticks in ((ax.xaxis, [0.2, 0.5, 1, 2, 3]), (ax.yaxis, [1, 2, 5, 10])):
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())
ax.set_title("A bookshelf of 0.30 × 1.80 m: red falls")
ax.legend()
plt.show()
