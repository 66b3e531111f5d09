"""
The rocking spectrum of a record
================================

A response spectrum says how oscillators answer to a record; a rocking spectrum says it of blocks, after Makris &
Konstantinidis (2003). Size is told by :math:`2\\pi/p`, slenderness by :math:`\\alpha`.
"""

import matplotlib.pyplot as plt
import numpy as np

import excitation as ex
from rocking.maps import rocking_spectrum

record = ex.scaled_to(
    ex.KanaiTajimi(rms=1.0, duration=20.0).record(time_step=0.01, seed=5), pga=4.0
)
motion = record.motion(interpolation="linear")

period = np.linspace(0.8, 5.0, 120)
alpha = np.radians([11.0, 13.0, 15.0, 17.0])
ds = rocking_spectrum(motion, period, alpha, t_end=30.0, solver="taylor")

figure, (left, right) = plt.subplots(2, 1, figsize=(7, 5.5), height_ratios=[1, 2.2])
left.plot(record.times, record.acceleration, lw=0.6, color="0.3")
left.set(xlabel="time [s]", ylabel="a$_x$ [m/s²]", title="The record, and its rocking spectrum")
for angle in ds.alpha.values:
    curve = ds.relative_rotation.sel(alpha=angle)
    right.plot(ds.period, curve, label=f"α = {np.degrees(angle):.0f}°")
    fell = ds.overturned.sel(alpha=angle)
    right.plot(
        ds.period[fell], np.full(int(fell.sum()), 1.02), "|", color=right.lines[-1].get_color()
    )
right.set(xlabel="2π/p, the size of the block [s]", ylabel="largest tilt / α", ylim=(0, 1.08))
right.legend(title="marks on top: it falls")
figure.tight_layout()
plt.show()
