"""Azimuths that are not whole degrees are read back as they were written."""

import numpy as np
import pytest

import excitation


@pytest.mark.parametrize("form", ["peer", "dyna", "columns"])
def test_half_a_degree_is_kept(form: str, tmp_path) -> None:
    turned = [excitation.Record(0.01, np.ones(9), component=c, azimuth_deg=a) for c, a in (("N", 0.0), ("E", 90.0))]
    excitation.write(tmp_path / "q", excitation.turned(*turned, 37.5)[0], form)
    assert excitation.read(tmp_path / "q")[0].azimuth_deg == 37.5
