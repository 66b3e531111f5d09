"""Fig. 10 of Winkler, Meguro & Yamazaki (1995): the test of numerical stability, a block dropped on a rigid base.

See          the block falls, is thrown back by its two springs, and comes up to where it began, again and again; energy
             goes from one form to the other and none is lost.
Paper says   an undamped, rebounding rigid block under gravitation is what is compared for different steps.
Run          python -m studies.fig10 [--quick]  ->  build/studies/fig10.nc, then fig10.png and .pdf
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

import dem
from studies.animation.frames import FILLS, GROUND, LINE
from studies.claims.preliminary_bounds import CLAIMS
from studies.families.numerical_stability import INTERVAL, DropPlan, arguments, drop_of, plan_of
from studies.running.parts import Parts, Result
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, table
from studies.running.study import Study

REBOUNDS = 3
"""Rebounds that are shown; the check looks at all within 2 s."""

ENERGIES = ("kinetic", "potential", "elastic")


SHOWN = INTERVAL / 100.0
"""Seconds between two samples of what is drawn."""


def _fall(plan: DropPlan) -> Result:
    """Height and energies of the nominal drop over 2 s at the pivot step."""
    drop = drop_of(plan)
    run = drop.run(plan.pivot, "incremental", SHOWN, round(2.0 / SHOWN) + 1)
    assert isinstance(run, dem.History)
    foot = float(run.scene.shape.corners[:, 1].min())
    energies = {name: getattr(run.energies, name) for name in ENERGIES}
    return {"time": run.time, "height": run.z + foot, "weight_work": run.scene.mass * drop.g * -foot} | energies


def dataset(plan: DropPlan, parts: Parts) -> xr.Dataset:
    """Height and energies of the nominal drop at the pivot step, and the heights it comes back to within 2 s."""
    drop = drop_of(plan)
    (found,) = parts.results([plan], _fall, "fig10")
    time, height = found["time"], found["height"]
    rounds = int(time[-1] / drop.period)
    tops = [
        height[(time > (n + 0.5) * drop.period) & (time < (n + 1.5) * drop.period)].max() for n in range(rounds - 1)
    ]
    few = time <= (REBOUNDS + 0.02) * drop.period
    potential = found["potential"] - found["weight_work"]  # from where the base touches the floor
    values = {"kinetic": found["kinetic"], "potential": potential, "elastic": found["elastic"]}
    ds = xr.Dataset(
        {"height": ("time", height[few], {"units": "m", "long_name": "height of the base of the block"})}
        | {
            f"energy_{name}": ("time", values[name][few], {"units": "J", "long_name": f"{name} energy"})
            for name in ENERGIES
        }
        | {"top": ("rebound", np.array(tops), {"units": "m", "long_name": "height that it comes back to"})},
        coords={
            "time": ("time", time[few], {"units": "s", "long_name": "time"}),
            "rebound": ("rebound", np.arange(1, len(tops) + 1), {"units": "1", "long_name": "number of the rebound"}),
        },
    )
    b, h = 2.0 * drop.scene.shape.corners.max(axis=0)
    return ds.assign_attrs(
        drop_height=plan.height, pivot_step=plan.pivot, b=float(b), h=float(h), stiffness=drop.kn,
        references="Winkler, Meguro & Yamazaki (1995), Fig. 10",
        choices="the height of the drop is not printed; two springs, since both corners land together",
    )  # fmt: skip


def _scene(ax: Any, ds: xr.Dataset) -> None:
    """The block above the base; the drop is drawn larger than it is."""
    b, h = ds.attrs["b"], ds.attrs["h"]
    up = 0.25 * h
    ax.fill_between([-1.5 * b, 1.5 * b], -0.12 * h, 0.0, color=GROUND, lw=0)
    corners = [(-0.5 * b, up), (0.5 * b, up), (0.5 * b, up + h), (-0.5 * b, up + h)]
    ax.add_patch(Polygon(corners, facecolor=FILLS[1], edgecolor=LINE))
    ax.annotate("", (0.0, 0.35 * h), (0.0, 0.85 * h), arrowprops={"arrowstyle": "->", "lw": 1.5})
    ax.text(0.05 * b, 0.6 * h, "g", fontsize=11, style="italic")
    ax.annotate("", (0.8 * b, 0.0), (0.8 * b, up), arrowprops={"arrowstyle": "<->"})
    ax.text(0.86 * b, 0.5 * up, f"{ds.attrs['drop_height'] * 1e3:g} mm", va="center", fontsize=9)
    for x in (-0.5 * b, 0.5 * b):
        spring = np.linspace(0.0, up, 25)
        ax.plot(x + 0.06 * b * np.sin(np.linspace(0.0, 10.0 * np.pi, 25)), spring, color="0.35", lw=0.8)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title("drop not to scale", fontsize=9)


def figure(ds: xr.Dataset) -> Figure:
    """The scene, the height over some rebounds, and the energies."""
    fig = new_figure(9.5, 4.6)
    axes = fig.subplot_mosaic([["scene", "height"], ["scene", "energy"]], width_ratios=[1.0, 2.6])
    _scene(axes["scene"], ds)
    axes["height"].plot(ds.time, ds.height * 1e3, color="k", lw=1.0)
    axes["height"].axhline(0.0, color="0.6", lw=0.8)
    axes["height"].set_ylabel("Height of the base [mm]")
    for name, colour in zip(ENERGIES, ("#D55E00", "#0072B2", "#009E73"), strict=True):
        axes["energy"].plot(ds.time, ds[f"energy_{name}"] * 1e3, color=colour, lw=1.0, label=name)
    total = sum(ds[f"energy_{name}"] for name in ENERGIES) * 1e3
    axes["energy"].plot(ds.time, total, color="k", lw=1.0, ls="--", label="sum")
    axes["energy"].set_ylabel("Energy [mJ]")
    axes["energy"].set_xlabel("Time [s]")
    axes["energy"].legend(fontsize=8, ncols=4, loc="center", framealpha=0.95)
    for name in ("height", "energy"):
        axes[name].grid(alpha=0.3)
    caption(
        fig,
        "After Fig. 10 of Winkler, Meguro & Yamazaki (1995): Block 4, 1.4 kg, dropped on a rigid base without damping, "
        f"step {ds.attrs['pivot_step']:.4g} s. Notice: it comes back to where it fell from; a landing takes less than "
        "a millisecond, in which all energy is in the springs. How exactly a landing is computed is what Figs 11 and "
        "12 compare.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """Is it undamped?"""
    return table([Finding(CLAIMS["fig10.undamped"], float((ds.top / ds.attrs["drop_height"]).min()))])


STUDY = Study(
    name="fig10",
    title="Test of numerical stability: a block that rebounds on a rigid base (Fig. 10)",
    about="A block falls on a rigid base and is thrown back, without damping: what the time step is chosen by.",
    plan=plan_of,
    dataset=dataset,
    figures={"fig10": figure},
    check=check,
    arguments=arguments,
    example='ds.height.plot(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
