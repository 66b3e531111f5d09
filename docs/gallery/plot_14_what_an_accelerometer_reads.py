"""
What an accelerometer on the block reads
========================================

Pickups fixed to a block turn with it and feel gravity. The paper read the start of rocking and the fall off their
vertical channel; here both are found by rule in a simulated record with noise.
"""

import matplotlib.pyplot as plt
import numpy as np

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from rocking.detection import detect_onset, detect_overturning
from rocking.instruments import accelerometer

block = Block(b=0.15, h=0.50)
table = RampedSinusoid(frequency=2.0, duration=40.0, final_amplitude=24.0)
t = np.arange(0.0, 40.0, 0.005)
run = solve(Method1(block), table, t_end=40.0, save_at=t)
noise = 0.02 * np.random.default_rng(2).standard_normal(run.t.size)
up = accelerometer(run, position=(0.0, 0.45), direction=(0.0, 1.0)) + noise

onset = detect_onset(run.t, up)
fall = detect_overturning(run.t, up)
print(f"starts to rock at {run.onset_time:.3f} s, found at {onset.time:.3f} s")
print(
    f"passes its balance at {run.overturning_time:.3f} s, the fall is found at {fall.time:.3f} s"
)

figure, (ax, below) = plt.subplots(2, 1, figsize=(7.5, 4.8), sharex=True)
ax.plot(run.t, up, lw=0.4, color="k")
for found in (onset.time, fall.time):
    ax.axvline(found, color="#c0392b", lw=1)
ax.set(
    ylabel="reads [m/s²]", title="vertical pickup; red: start and fall as found", ylim=(0, 20)
)
below.plot(run.t, run.theta / block.alpha, lw=0.6, color="#1f5f99")
for true in (run.onset_time, run.overturning_time):
    below.axvline(true, color="#c0392b", lw=1)
below.set(xlabel="time [s]", ylabel="θ/α", ylim=(-1.3, 1.3))
plt.show()
