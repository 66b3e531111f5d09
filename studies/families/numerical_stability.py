"""The paper's test of numerical stability: a block dropped on the base, computed with many time steps; for Figs 10-12.

Source   Winkler, Meguro & Yamazaki (1995), "Numerical stability" and eqs (7), (8). Its pivot is the step 1.375e-7 s; it
         used nine more, of which it prints 3.3e-6 and 2.0e-6 s. The other seven, the height of the drop and the number
         of samples are chosen here.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

import dem
from dem.drop import ONSETS, Drop, squared_difference
from studies.criteria.free_vibration import scene_of
from studies.criteria.overturning import PAPER_STEP, STIFFNESS
from studies.running.command_line import positive
from studies.running.files import BadInputError
from studies.running.parts import Parts, Result
from studies.specimens import specimen

BLOCK = 4
"""The lightest, of 1.4 kg."""

PIVOT = 1.375e-7
INTERVAL, SAMPLES = 3.3e-3, 607
"""Of the sum of eq. (8): a sample every 3.3 ms, to 2 s. All steps are whole parts of 3.3 ms, the pivot among them."""

NINE = (5.5e-7, 1.1e-6, 2.0e-6, 3.3e-6, 5.5e-6, 1.1e-5, 3.3e-5, 6.6e-5, 1.1e-4)
"""Steps of the figures [s]; the last is below the critical one of the block on its two corners, 1.9e-4 s."""

MORE = (1.65e-5, 2.2e-5, 2.75e-5, 4.4e-5, 5.5e-5)
"""Further steps [s], to find where a better onset of contact is as good as the paper's."""

SPREAD = (-2e-3, -1e-3, 0.0, 1e-3, 2e-3)
"""Changes of the height of the drop: where within a step a block lands is chance, and these show how much it does."""


@dataclass(frozen=True)
class DropPlan:
    """Everything that decides the dataset."""

    height: float  # of the drop [m]
    spread: tuple[float, ...] = SPREAD
    nine: tuple[float, ...] = NINE
    more: tuple[float, ...] = MORE
    pivot: float = PIVOT
    onsets: tuple[str, ...] = ONSETS

    @property
    def steps(self) -> tuple[float, ...]:
        """All steps in order [s]."""
        return tuple(sorted({*self.nine, *self.more}))


def arguments(parser: argparse.ArgumentParser) -> None:
    """--height."""
    parser.add_argument(
        "--height", type=float, default=10.0, metavar="MM",
        help="of the drop [mm]; the paper does not print it (default: %(default)s)",
    )  # fmt: skip


def plan_of(options: argparse.Namespace) -> DropPlan:
    """The plan that the command line asks for."""
    positive("--height", options.height)
    if options.height > 100.0:
        raise BadInputError(f"--height {options.height:g}: want at most 100 mm")
    if options.quick:
        return DropPlan(options.height * 1e-3, spread=(0.0,), more=(2.2e-5,), pivot=1.1e-6 / 4.0)
    return DropPlan(options.height * 1e-3)


def drop_of(plan: DropPlan, change: float = 0.0) -> Drop:
    """The drop, its height changed by a share."""
    return Drop(scene_of(specimen(BLOCK)), plan.height * (1.0 + change), kn=STIFFNESS)


def _history(job: tuple[float, float, str, float]) -> Result:
    height, change, onset, dt = job
    return {"height": drop_of(DropPlan(height), change).history(dt, onset, INTERVAL, SAMPLES)}


def dataset(plan: DropPlan, parts: Parts, label: str) -> xr.Dataset:
    """Histories of the nominal drop and differences of all drops, over (onset, step)."""
    jobs = [
        (plan.height, change, onset, dt)
        for change in plan.spread
        for onset in plan.onsets
        for dt in (plan.pivot, *plan.steps)
    ]
    found = [result["height"] for result in parts.results(jobs, _history, label)]
    z = np.array(found).reshape(len(plan.spread), len(plan.onsets), 1 + len(plan.steps), SAMPLES)
    time = INTERVAL * np.arange(SAMPLES, dtype=np.float64)
    exact = np.array([drop_of(plan, change).exact(time) for change in plan.spread])
    nominal = plan.spread.index(0.0)
    pivot = z[:, plan.onsets.index("incremental"), 0]  # the paper's

    def differences(reference: Any) -> np.ndarray:
        rows = [
            [[squared_difference(reference[i], z[i, j, k + 1]) for k in range(len(plan.steps))]
             for j in range(len(plan.onsets))]
            for i in range(len(plan.spread))
        ]  # fmt: skip
        return np.array(rows)

    dims = ("trial", "onset", "step")
    reference = {"reference": "Winkler, Meguro & Yamazaki (1995), eq. (8)"}
    ds = xr.Dataset(
        {
            "height": (("onset", "step", "time"), z[nominal, :, 1:], {"units": "m", "long_name": "height of the base"}),
            "pivot_height": ("time", pivot[nominal], {"units": "m", "long_name": "height of the base, pivot step"}),
            "exact_height": ("time", exact[nominal], {"units": "m", "long_name": "height of the base, closed form"}),
            "difference": (
                dims, differences(pivot),
                {"units": "m2", "long_name": "sum of squared differences from the pivot"} | reference,
            ),
            "difference_exact": (
                dims, differences(exact),
                {"units": "m2", "long_name": "sum of squared differences from the closed form"} | reference,
            ),
            "pivot_difference_exact": (
                ("trial", "onset"),
                np.array([[squared_difference(exact[i], z[i, j, 0]) for j in range(len(plan.onsets))]
                          for i in range(len(plan.spread))]),
                {"units": "m2", "long_name": "the same of the pivot step"} | reference,
            ),
        },
        coords={
            "drop_height": ("trial", plan.height * (1.0 + np.array(plan.spread)), {"units": "m", "long_name": "drop"}),
            "onset": ("onset", list(plan.onsets), {"long_name": "how a contact begins"}),
            "step": ("step", list(plan.steps), {"units": "s", "long_name": "time step"}),
            "of_nine": ("step", [s in plan.nine for s in plan.steps], {"long_name": "one of the nine of the figures"}),
            "time": ("time", time, {"units": "s", "long_name": "time"}),
        },
    )  # fmt: skip
    return ds.assign_attrs(_attributes(plan))


def _attributes(plan: DropPlan) -> dict[str, Any]:
    block = specimen(BLOCK)
    scene, contact = scene_of(block), dem.Contact(1.0, damping=0.0)
    columns = [
        dem.assembly_critical_step(dem.column(n, block.b, block.h, block.d, block.density), contact) for n in (1, 2, 3)
    ]
    return {
        "block": BLOCK,
        "mass": block.mass,
        "drop_height": plan.height,
        "pivot_step": plan.pivot,
        "paper_step": PAPER_STEP,
        "eq7_step": dem.eq7_step(block.mass, STIFFNESS),
        "critical_step": dem.critical_step(scene, STIFFNESS, STIFFNESS, 0.0),
        "critical_steps_of_columns": columns,
        "samples": SAMPLES,
        "interval": INTERVAL,
        "choices": (
            "printed: pivot 1.375e-7 s, 3.3e-6 s, 2.0e-6 s, 2 s, kn = 1.98e7 N/m, 1.4 kg; chosen here: height of the "
            "drop, samples in the sum, the other steps"
        ),
    }


def rms(ds: xr.Dataset, sums: xr.DataArray) -> xr.DataArray:
    """Root mean square difference [m] of a sum of eq. (8)."""
    return np.sqrt(sums / ds.attrs["samples"])
