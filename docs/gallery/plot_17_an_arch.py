"""
An arch, thick enough or not
============================

A semicircular arch of rigid voussoirs stands under its own weight when its thickness is at least about 0.1075 of
the radius of its centre line. Two arches of distinct elements, one on either side of that.
"""

import math

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon

import dem

contact = dem.Contact(mu=math.inf, damping_ratio=0.3, kn=1e8, ks=1e8)
criteria = dem.Criteria(stop="never", drop=0.5)
figure, axes = plt.subplots(1, 2, figsize=(8, 3.4), sharey=True)
for ax, thickness in zip(axes, (0.125, 0.09), strict=True):
    arch = dem.arch(24, thickness)
    run = dem.simulate_assembly(
        arch, t_end=0.32, contact=contact, settle=False, criteria=criteria
    )
    sunk = run.z[0].max() - run.z[-1].max()
    for wall in arch.walls:
        ax.add_patch(Polygon(wall.vertices, facecolor="0.6"))
    for i, body in enumerate(arch.bodies):
        c, s = np.cos(run.theta[-1, i]), np.sin(run.theta[-1, i])
        x, z = body.shape.corners.T
        shape = np.column_stack([run.x[-1, i] + x * c + z * s, run.z[-1, i] - x * s + z * c])
        ax.add_patch(Polygon(shape, facecolor="#e8d5b0", edgecolor="k", lw=0.7))
    ax.set(xlim=(-1.3, 1.3), ylim=(-0.15, 1.3), aspect="equal", xlabel="x [m]")
    ax.set_title(
        f"t/R = {thickness:g}: it sinks by {1e3 * sunk:.1f} mm in {run.end_time:.2f} s",
        fontsize=10,
    )
figure.tight_layout()
plt.show()
