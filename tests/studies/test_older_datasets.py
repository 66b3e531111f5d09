"""A dataset that version 0.1.0 wrote is opened, drawn, checked and compared by this one."""

from pathlib import Path

import studies
from studies.compare import compared
from studies.running.registry import studies as registered

OLD = Path(__file__).parent / "data" / "fig18_0.1.0.nc"


def test_a_dataset_of_an_earlier_version_is_of_use():
    ds = studies.open(OLD, cf_units=True)
    study = registered()[ds.attrs["study"]]
    assert study.figures["fig18"](ds) is not None
    assert study.check(ds).sizes["statement"] == 0
    rows, notes = compared(ds, ds)
    assert rows and not notes and all(row.moved == 0 for row in rows)
    curve = ds.overturning_amplitude.isel(column=0, tiny=0)
    assert float(studies.interpolated(curve, frequency=2.0)[0]) > 0.0
