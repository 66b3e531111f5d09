"""Sweeps: criteria of rocking and overturning over any axes, as one labelled dataset that says how to make it again.

    from studies import sweep
    plan = sweep.Sweep(axes={"method": ["method1", "dem"], "frequency": [1.0, 3.0], "slenderness": [0.2, 0.3]})
    ds = sweep.run(plan, "criteria.nc")

From the command line: `python -m studies.sweep FILE.toml --out criteria.nc`; see `studies.sweep.declared` for the file.
"""

from studies.sweep.declared import Sweep, from_mapping, read
from studies.sweep.running import run

__all__ = ["Sweep", "from_mapping", "read", "run"]
