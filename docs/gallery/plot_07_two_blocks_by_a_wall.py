"""
A column of two blocks, free and by a wall
==========================================

Is a cupboard safer against the wall? The paper's question (Figs 17 to 20): two blocks of h = 0.5 m, b/h = 0.3, on a
table that shakes harder and harder, free and next to a wall that is fixed to the table.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.patches import Polygon

import dem
from excitation import RampedSinusoid

contact = dem.Contact(mu=0.7, damping_ratio=0.2)
motion = RampedSinusoid(frequency=3.0, duration=6.0, final_amplitude=18.0)
scenes = {
    "free": dem.column(2, 0.15, 0.50, 0.25, 597.0),
    "by a wall": dem.column(2, 0.15, 0.50, 0.25, 597.0, wall_gap=0.01),
}
criteria = dem.Criteria(stop="never", tilt=1.2)
runs = {
    name: dem.simulate_assembly(scene, motion, t_end=5.0, contact=contact, criteria=criteria)
    for name, scene in scenes.items()
}
for name, run in runs.items():
    when = run.overturning_time
    print(
        f"{name}: {run.overturned or 'nothing'} falls at {when:.2f} s, at {18.0 * when / 6.0:.1f} m/s²"
    )

# %%
# Moments of both. One frequency and a ramp of six seconds is no criterion: the figures of the paper are made with
# ramps of 90 s over all frequencies.


def outline(run, i, t):
    """Corners of body i at the sample next to t."""
    k = min(np.searchsorted(run.time, t), run.time.size - 1)
    c, s = np.cos(run.theta[k, i]), np.sin(run.theta[k, i])
    x, z = run.assembly.bodies[i].shape.corners.T
    return np.column_stack([run.x[k, i] + x * c + z * s, run.z[k, i] - x * s + z * c])


def scene(ax, run, t):
    """The wall and the blocks; patches of the blocks."""
    ax.set(xlim=(-0.5, 0.8), ylim=(0.0, 1.15), aspect="equal", xticks=[], yticks=[])
    for wall in run.assembly.walls:
        ax.add_patch(Polygon(wall.vertices, facecolor="0.6"))
    blocks = range(len(run.assembly.bodies))
    return [
        ax.add_patch(Polygon(outline(run, i, t), facecolor="#e8d5b0", edgecolor="k"))
        for i in blocks
    ]


figure, axes = plt.subplots(2, 5, figsize=(8.5, 4))
for row, (name, run) in zip(axes, runs.items(), strict=True):
    row[0].set_ylabel(name)
    for ax, t in zip(row, (2.0, 2.6, 3.2, 3.5, 3.7), strict=True):
        scene(ax, run, t)
        ax.set_title(f"{t:.1f} s", fontsize=9)
figure.tight_layout()
plt.show()

# %%
# And as an animation.

figure, axes = plt.subplots(1, 2, figsize=(6, 3.2))
patches = {
    name: scene(ax, run, 0.0) for ax, (name, run) in zip(axes, runs.items(), strict=True)
}
clock = figure.suptitle("")


def frame(t):
    """Move the blocks to where they are at t."""
    for name, run in runs.items():
        for i, patch in enumerate(patches[name]):
            patch.set_xy(outline(run, i, t))
    clock.set_text(f"{t:.2f} s")


film = FuncAnimation(figure, frame, frames=np.arange(2.0, 4.4, 0.06), interval=60)
plt.show()
