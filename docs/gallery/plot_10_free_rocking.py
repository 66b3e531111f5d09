"""
Free rocking, and Housner's closed form
=======================================

A block is leaned over and let go. The linear equation has closed forms for each impact; the nonlinear one parts
from them as the block is stockier.
"""

import matplotlib.pyplot as plt

from rocking import Block, Method1, solve
from rocking.closed_forms import free_impact_time, free_peak

block = Block(b=0.40, h=0.80)
theta0 = 0.9 * block.alpha
linear = Method1(block, form="linear", restitution=0.95)
runs = {
    "linear": solve(linear, theta=theta0, t_end=5.0, solver="exact"),
    "nonlinear": solve(Method1(block, restitution=0.95), theta=theta0, t_end=5.0),
}

figure, ax = plt.subplots(figsize=(7, 4))
for name, run in runs.items():
    ax.plot(run.t, run.theta / block.alpha, label=name)
for n in range(1, 9):
    t = free_impact_time(theta0, block.alpha, block.p(), linear.e, n)
    ax.plot(t, 0.0, "ko", ms=4)
peaks = [free_peak(theta0, block.alpha, linear.e, n) / block.alpha for n in range(8)]
ax.step(
    [0.0, *runs["linear"].impact_times[:8]],
    [*peaks, peaks[-1]],
    where="post",
    color="0.6",
    lw=0.8,
)
ax.set(
    xlabel="time [s]", ylabel="θ/α", title="dots and steps: Housner (1963), impacts and peaks"
)
ax.legend()
error = runs["linear"].impact_times[0] - free_impact_time(
    theta0, block.alpha, block.p(), linear.e, 1
)
print(f"first impact less the closed form: {error:.1e} s")
plt.show()
