r"""
What a fallen tombstone tells
=============================

Since the 1880s peak accelerations have been read off fallen tombstones by West's formula, :math:`a > g\,b/h`. Here
is how far off that can be: the peak of a one-cycle push that fells stones of one shape and several sizes, over
West's.
"""

import matplotlib.pyplot as plt
import numpy as np

from rocking import Block
from rocking.closed_forms import full_sine_pulse, west_acceleration
from rocking.pulse_overturning import one_impact_band

period = np.geomspace(0.15, 3.0, 16)
figure, ax = plt.subplots(figsize=(7, 4.4))
for height in (0.5, 1.0, 2.0):
    stone = Block(b=0.3 * height, h=height)
    ratio = 2.0 * np.pi / period / stone.p()
    needed = []
    for w in ratio:
        band = one_impact_band(w, stone.housner_restitution)
        needed.append(full_sine_pulse(w) if band is None else band.low)
    west = west_acceleration(stone.b, stone.h) / (9.80665 * stone.alpha)
    ax.plot(period, np.array(needed) / west, label=f"{height:g} m")
ax.axhline(1.0, color="k", ls="--", lw=0.8)
ax.set(yscale="log", xlabel="period of the push [s]", ylabel="felling acceleration / West's")
ax.set_title("Stones of b/h = 0.3: West's formula reads too low")
ax.legend(title="height")
plt.show()
