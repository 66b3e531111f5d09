"""Statements on the start of rocking (studies.fig14, studies.fig15): a block that did not rock bears none out."""

import numpy as np
import pytest
import xarray as xr

from rocking import G_STANDARD
from studies import fig14, fig15
from studies.criteria.overturning import METHODS
from studies.running.labelled import block_axis, frequency_axis, names_axis
from studies.running.statements import HOLDS, UNDECIDED

FREQUENCIES = (1.0, 3.0, 5.0)


def _ideal(study):
    """By hand: all blocks begin to rock at (b/h) g, a hundredth later where motion follows, by every method."""
    ds = xr.Dataset(
        coords=names_axis("method", METHODS, "method") | block_axis(study.BLOCKS) | frequency_axis(FREQUENCIES)
    )
    ds["west"] = ds.b / ds.h * G_STANDARD
    flat = xr.ones_like(ds.frequency) * xr.DataArray(np.ones(len(METHODS)), {"method": list(METHODS)}, ["method"])
    ds["lift_acceleration"] = (ds.west * flat).transpose("method", "block", "frequency")
    ds["onset_acceleration"] = 1.01 * ds.lift_acceleration
    if study is fig15:
        ds["nonlinear_onset_acceleration"] = ds.onset_acceleration.sel({"method": "method1"}, drop=True)
        # The more a block feels, the more slender it is, but of vertical motion, which the stocky one feels more.
        felt = xr.DataArray(1e-3 * np.ones((5, 2)), {"disturbance": list(fig15.DISTURBANCES), "way": [1.0, -1.0]})
        felt = felt * xr.where(felt.disturbance == "vertical", ds.b / ds.h, ds.h / ds.b) * xr.ones_like(ds.frequency)
        for name in ("lift_acceleration", "onset_acceleration"):
            ds[f"disturbed_{name}"] = ds[name].sel({"method": "method1"}, drop=True) * (1.0 - felt)
    return ds


def _verdicts(study, ds):
    found = study.check(ds)
    return dict(zip(found.statement_key.values, found.statement_holds.values.tolist(), strict=True))


WORDS = {fig14: ("lift", "motion", "size"), fig15: ("motion", "constant", "methods")}


@pytest.mark.parametrize("study", WORDS, ids=lambda study: study.STUDY.name)
def test_what_is_said_of_every_block_is_not_decided_where_one_did_not_rock(study):
    ds, name = _ideal(study), study.STUDY.name
    held = _verdicts(study, ds)
    assert [held[f"{name}.{word}"] for word in WORDS[study]] == [HOLDS] * 3
    for variable in ("lift_acceleration", "onset_acceleration"):
        values = ds[variable].copy()
        values[{"method": METHODS.index("dem" if study is fig14 else "method2"), "block": 1, "frequency": -1}] = np.nan
        ds[variable] = values
    left = _verdicts(study, ds)
    assert [left[f"{name}.{word}"] for word in WORDS[study]] == [UNDECIDED] * 3
    detail = study.check(ds)
    assert "nan" in " ".join(str(text) for text in detail.statement_detail.values)


def test_a_disturbed_block_that_did_not_rock_leaves_unknown_what_is_said_of_the_disturbances():
    ds = _ideal(fig15)
    words = ("envelope", "slender_base", "slender_vertical", "pitch", "worn", "vertical", "inclination")
    of_disturbances = [f"fig15.{word}" for word in words]

    def numbers():
        found = fig15.check(ds)
        return found.statement_number.values[np.isin(found.statement_key.values, of_disturbances)]

    assert np.isfinite(numbers()).tolist() == [True] * len(words)
    for name in ("disturbed_lift_acceleration", "disturbed_onset_acceleration"):
        ds[name] = ds[name].where((ds.frequency < 5.0) | (ds.way > 0.0))
    assert np.isnan(numbers()).tolist() == [True] * len(words)


@pytest.mark.parametrize("study", WORDS, ids=lambda study: study.STUDY.name)
@pytest.mark.parametrize("rocking", ["none", "one point less"])
def test_what_did_not_rock_is_said_below_the_drawing(study, rocking):
    ds = _ideal(study)
    count = ds.onset_acceleration.size if rocking == "none" else 1
    known = ds.onset_acceleration.values.ravel()
    known[:count] = np.nan
    ds["onset_acceleration"] = (ds.onset_acceleration.dims, known.reshape(ds.onset_acceleration.shape))
    drawn = study.figure(ds)
    top = np.fmax.reduce(np.append(known, ds.west.values)) / G_STANDARD
    assert drawn.axes[0].get_ylim() == pytest.approx((0.0, 1.25 * top))
    assert f"At {count} points no corner rose as far" in " ".join(drawn.get_supxlabel().split())
    assert "no corner rose" not in study.figure(_ideal(study)).get_supxlabel()
