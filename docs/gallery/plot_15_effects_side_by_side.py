"""
Effects side by side
====================

What a real block has and the ideal one lacks, one at a time: the free rocking of one block with each of six
effects, over that of the ideal block.
"""

import matplotlib.pyplot as plt
import numpy as np

from rocking import Block, Method1, solve
from rocking.effects import load

block = Block(b=0.15, h=0.50)
system = Method1(block, restitution=0.92)
effects = {
    "rounded edges, 5 mm": load("rounded_edges")(radius=0.005),
    "floor tilted by 0.5°": load("base_tilt")(angle=np.radians(0.5)),
    "mass off by 4 mm": load("eccentric_mass")(offset=0.004),
    "quadratic drag": load("quadratic_drag")(coefficient=0.15),
    "fast impacts lose more": load("velocity_dependent_restitution")(slope=-0.03),
    "a string at 0.12 rad": load("tether")(slack=0.12, stiffness=300.0),
}
t = np.linspace(0.0, 3.0, 1500)
ideal = solve(system, theta=0.2, t_end=3.0, save_at=t)

figure, axes = plt.subplots(3, 2, figsize=(8, 6), sharex=True, sharey=True)
for ax, (name, effect) in zip(axes.flat, effects.items(), strict=True):
    run = solve(system, theta=0.2, t_end=3.0, save_at=t, effects=[effect])
    ax.plot(t, ideal.theta, color="0.7")
    ax.plot(t, run.theta, color="#c0392b", lw=1)
    ax.set_title(name, fontsize=10)
for ax in axes[-1]:
    ax.set_xlabel("time [s]")
for ax in axes[:, 0]:
    ax.set_ylabel("θ [rad]")
figure.tight_layout()
plt.show()
