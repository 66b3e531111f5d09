"""
Gradient of the overturning margin
==================================

How close to falling does a block come, and on what does that hang most? The solver ``diffrax`` gives derivatives
that go right through the impacts: the largest tilt over that of balance, and how it moves with each size and with
the restitution.
"""

import matplotlib.pyplot as plt
import numpy as np

from excitation import OneSinePulse
from rocking import Block, Method1
from rocking.solvers.diffrax.parameters import parameters_for
from rocking.solvers.diffrax.response import response, sensitivity

block = Block(b=0.25, h=1.00)
system = Method1(block)
pulse = OneSinePulse(amplitude=3.0, period=0.8)  # m/s^2, s
names = {"b": block.b, "h": block.h, "restitution": system.e}


def run(x):
    parameters = parameters_for(system, **x)
    return response(system, pulse, parameters=parameters, t_end=4.0)


value, slope = sensitivity(run, names)
theta_c = block.alpha
print(f"largest tilt {float(value.peak_rotation) / theta_c:.3f} of that of balance")

# %%
# What one per cent more of each does to the largest tilt, beside plain differences of two runs:

per_cent = {k: 0.01 * names[k] * float(slope.peak_rotation[k]) for k in names}
checked = {}
for k in names:
    step = 1e-4 * names[k]
    up, down = (
        float(run(names | {k: names[k] + sign * step}).peak_rotation) for sign in (1, -1)
    )
    checked[k] = 0.01 * names[k] * (up - down) / (2 * step)

figure, ax = plt.subplots(figsize=(6.5, 3.6))
place = np.arange(len(names))
ax.bar(place - 0.2, np.degrees(list(per_cent.values())), 0.4, label="through the impacts")
ax.bar(place + 0.2, np.degrees(list(checked.values())), 0.4, label="differences", color="0.7")
ax.set_xticks(place, ["breadth", "height", "restitution"])
ax.axhline(0.0, color="k", lw=0.8)
ax.set(ylabel="change of the largest tilt [deg]", title="One per cent more of ...")
ax.legend()
figure.tight_layout()
plt.show()
