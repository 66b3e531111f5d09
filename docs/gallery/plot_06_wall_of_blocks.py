"""
A wall of blocks
================

A dry masonry wall on a table that shakes, by distinct elements. Colour tells how far each block has moved from
where it was.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import dem
from excitation import SteadySinusoid

wall = dem.running_bond(courses=6, across=5)
contact = dem.Contact(mu=0.6, damping_ratio=0.3)
motion = SteadySinusoid(frequency=2.0, amplitude=9.0, duration=1.8)  # Hz, m/s^2, s
run = dem.simulate_assembly(
    wall,
    motion,
    t_end=1.8,
    contact=contact,
    save_every=500,
    criteria=dem.Criteria(stop="never"),
)
print(run)


def outlines(run, k):
    """Corners of the bodies at sample k."""
    shapes = []
    for i, body in enumerate(run.assembly.bodies):
        c, s = np.cos(run.theta[k, i]), np.sin(run.theta[k, i])
        x, z = body.shape.corners.T
        shapes.append(
            np.column_stack([run.x[k, i] + x * c + z * s, run.z[k, i] - x * s + z * c])
        )
    return shapes


# %%
# Four moments. The top courses go first.

figure, axes = plt.subplots(2, 2, figsize=(8.5, 4.6), sharex=True, sharey=True)
for ax, share in zip(axes.flat, (0.0, 0.7, 0.85, 1.0), strict=True):
    k = round(share * (run.time.size - 1))
    moved = np.hypot(run.x[k] - run.x[0], run.z[k] - run.z[0])
    drawn = PolyCollection(
        outlines(run, k), array=1e3 * moved, cmap="YlOrRd", edgecolors="k", linewidths=0.6
    )
    drawn.set_clim(0.0, 100.0)
    ax.add_collection(drawn)
    ax.set(xlim=(-0.4, 1.4), ylim=(0.0, 0.7), aspect="equal", title=f"{run.time[k]:.2f} s")
figure.colorbar(drawn, ax=axes, label="moved [mm]", shrink=0.6)
plt.show()
