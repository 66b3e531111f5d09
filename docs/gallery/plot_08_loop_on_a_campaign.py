"""
The loop on a campaign
======================

A small campaign is made with a block whose edges are worn, and the loop is asked what the ideal block lacks. The
laboratory here is this package itself, with noise on its readings, so it is an illustration and no evidence; that
is what the virtual laboratory in the tests is for.
"""

import json
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from rocking import Block, Method1, solve
from rocking.effects import load
from studies.loop.__main__ import main as close_the_loop

folder = Path(tempfile.mkdtemp())
random = np.random.default_rng(7)
truth = Method1(Block(b=0.15, h=0.50, d=0.25), restitution=0.92, g=9.81)
worn = load("rounded_edges")(radius=0.006)  # m

head = """
title = "Free vibration, worn edges"
[block]
breadth = 0.15
height = 0.50
depth = 0.25
mass = 11.2
[[channel]]
name = "rotation"
kind = "rotation"
noise = 2.0e-4
"""
tests = []
for i, lean in enumerate((0.20, -0.17, 0.23), start=1):
    t = np.arange(0.0, 2.0, 0.005)
    run = solve(truth, theta=lean, t_end=2.0, save_at=t, effects=[worn])
    rows = zip(t, run.theta + 2e-4 * random.standard_normal(t.size), strict=True)
    (folder / f"free-{i}.csv").write_text(
        "time,rotation\n" + "".join(f"{a:.3f},{b:.6f}\n" for a, b in rows)
    )
    tests.append(
        f'[[test]]\nid = "free-{i}"\nkind = "free"\ndata = "free-{i}.csv"\ninitial_rotation = {lean}\n'
    )
_ = (folder / "campaign.toml").write_text(head + "\n".join(tests))

# %%
# One command, here from Python:

close_the_loop([str(folder), "--out", str(folder / "loop"), "--quiet"])
finding = json.loads((folder / "loop" / "loop.json").read_text())
print(
    finding["verdict"],
    finding["effects"],
    "cannot be told apart:",
    finding["indistinguishable"],
)
for name, value in finding["parameters"].items():
    print(
        f"{name} = {value['value']:.4g} [{value['low']:.4g}, {value['high']:.4g}] {value['units']}"
    )

# %%
# Free tests alone know the block only through its balance, its frequency parameter and its restitution, so worn
# edges have rivals that fit as well; the finding lists them. What is left over before and after, in one test:

tree = xr.open_datatree(folder / "loop" / "loop.nc")
test = tree["tests/free-1"]
figure, (top, below) = plt.subplots(2, 1, figsize=(7, 5), sharex=True)
top.plot(test.time, np.degrees(test.rotation), color="k", lw=0.8)
top.set(ylabel="rotation [deg]", title="free-1: measured")
for when, colour in (("before", "#c0392b"), ("after", "#1f5f99")):
    below.plot(
        test.time,
        np.degrees(test[f"rotation_residual_{when}"]),
        color=colour,
        lw=0.9,
        label=when,
    )
below.set(xlabel="time [s]", ylabel="residual [deg]")
below.legend()
plt.show()
