"""What the paper says of stiffness and damping in the free vibration of Block 1, as numbers.

Each number is taken at every restitution, and the one that is hardest on the statement decides.

Source   Winkler, Meguro & Yamazaki (1995), section "Material parameters"
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from studies.claims.preliminary_bounds import CLAIMS
from studies.running.statements import Finding, listed, table


def _moved(at: xr.Dataset, varied: str, what: str) -> float:
    """|log change| of a quantity when the parameter is doubled."""
    values = at[f"{varied}_{what}"]
    return abs(float(np.log(values.sel(factor=2.0) / values.sel(factor=1.0))))


def _named(ds: xr.Dataset, values: list[float]) -> dict[str, float]:
    return {f"e {float(e):.3g}": value for e, value in zip(ds.restitution.values, values, strict=True)}


def check(ds: xr.Dataset) -> xr.Dataset:
    """The statements on Fig. 5."""
    each = [ds.sel(restitution=e) for e in ds.restitution.values]
    fit = [float(at.best_misfit.sel(factor=1.0)) for at in each]
    by_stiffness = [_moved(at, "stiffness", "frequency") / _moved(at, "stiffness", "peak") for at in each]
    by_damping = [_moved(at, "dashpot", "peak") / _moved(at, "dashpot", "frequency") for at in each]
    any_stiffness = [float(at.best_misfit.max() / at.best_misfit.sel(factor=1.0)) for at in each]
    matters = [float(at.dashpot_change.sel(factor=2.0) / at.stiffness_change.sel(factor=2.0)) for at in each]
    rows = (
        ("fit", max(fit), fit),
        ("stiffness", min(by_stiffness), by_stiffness),
        ("damping", min(by_damping), by_damping),
        ("any", max(any_stiffness), any_stiffness),
        ("damping_matters", min(matters), matters),
    )
    found = [Finding(CLAIMS[f"fig05.{word}"], number, listed(_named(ds, parts))) for word, number, parts in rows]
    return table([*found, Finding(CLAIMS["fig05.wave"], ds.attrs["wave_speed"])])
