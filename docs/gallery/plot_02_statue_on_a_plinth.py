"""
A statue on a plinth
====================

A statue of 2 m with its mass up high stands on feet that are closer together than its body is broad. Two effects
say so. The plinth under it is not quite level, a third one.
"""

import matplotlib.pyplot as plt
import numpy as np

from excitation import AntisymmetricRickerPulse
from rocking import Block, Method1, solve
from rocking.effects import load

body = Block(b=0.70, h=2.00, d=0.6, density=2600.0)
shape = [
    load("concave_base")(breadth=0.50),  # m between the feet
    load("mass_distribution")(height=1.15),  # m, centre of mass
]
plinth = load("base_tilt")(angle=np.radians(1.5))  # falls toward +x

pulse = AntisymmetricRickerPulse(amplitude=3.2, period=0.9)  # m/s^2, s
cases = {"as a uniform block": [], "feet and mass": shape, "on the plinth": [*shape, plinth]}

figure, (top, below) = plt.subplots(2, 1, figsize=(7, 5), sharex=True, height_ratios=[1, 2.4])
for name, effects in cases.items():
    run = solve(Method1(body), pulse, t_end=6.0, effects=effects)
    below.plot(run.t, np.degrees(run.theta), label=f"{name}: {run.outcome.value}")
t = np.linspace(0.0, 6.0, 1200)
top.plot(t, pulse(t)[0], color="0.4")
top.set(ylabel="a$_x$ [m/s²]", title="A statue under a Ricker pulse")
below.set(xlabel="time [s]", ylabel="tilt [deg]", ylim=(-30, 30))
below.legend()
plt.show()
