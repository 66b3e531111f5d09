"""
Sliding, rocking, jumping
=========================

Under a strong table a block does not only rock. Method 2 tells its six modes apart; the colours show which one
holds when.
"""

import matplotlib.pyplot as plt
import numpy as np

from excitation import RampedSinusoid
from rocking import Block, Method2, Mode, solve

block = Block(b=0.15, h=0.50)
shaking = RampedSinusoid(frequency=4.0, duration=8.0, final_amplitude=48.0)
run = solve(
    Method2(block, friction=0.5), shaking, t_end=8.0, save_at=np.linspace(0.0, 8.0, 6000)
)
print(run)

figure, (ax, below) = plt.subplots(2, 1, figsize=(7.5, 5), sharex=True, height_ratios=[3, 1])
ax.plot(run.t, run.theta / block.alpha, color="k", lw=0.7)
ax.set(
    ylabel="θ/θ$_c$",
    title="Block 3 on a table of 4 Hz that shakes harder and harder",
    ylim=(-1.4, 1.4),
)
colours = plt.get_cmap("Set2")(np.arange(len(Mode)))
for mode in Mode:
    inside = np.where(run.mode == mode, 1.0, np.nan)
    below.fill_between(
        run.t, 0.0, inside, color=colours[mode], lw=0, label=mode.name.lower().replace("_", " ")
    )
below.set(xlabel="time [s]", yticks=[], xlim=(0, 8), ylim=(0, 1))
below.legend(ncols=6, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.55))
figure.tight_layout()
plt.show()

# %%
# Share of the time in each mode:

spent = run.mode_durations()
for mode in Mode:
    print(f"{mode.name.lower():18s} {spent[mode] / spent.sum():.3f}")
