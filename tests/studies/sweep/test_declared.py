"""Declarations of sweeps: what they mean, and what is refused before anything runs."""

import numpy as np
import pytest

from studies.sweep import Sweep, from_mapping, read

H = {"axes": {"h": [1.0]}}


def test_axes_keep_their_order_and_the_rest_has_defaults():
    sweep = Sweep(axes={"frequency": [1.0, 2.0], "h": [0.5]}, fixed={"friction": 0.6})
    assert list(sweep.axes) == ["frequency", "h"]
    assert sweep.shape == (2, 1)
    assert sweep.all_values("friction") == (0.6,)
    assert sweep.all_values("slenderness") == (0.3,)
    assert sweep.excitations["ramp"]["duration"] == 90.0


def test_spacing_is_linear_or_logarithmic():
    sweep = Sweep(
        axes={
            "h": {"start": 0.1, "stop": 10.0, "count": 3, "log": True},
            "frequency": {"start": 1, "stop": 2, "count": 3},
        }
    )
    assert sweep.axes["h"] == pytest.approx((0.1, 1.0, 10.0))
    assert sweep.axes["frequency"] == (1.0, 1.5, 2.0)


def test_a_sweep_is_made_again_from_its_json():
    import json

    sweep = Sweep(axes={"method": ["method1", "dem"], "frequency": np.array([1.0, 2.0])}, title="a")
    assert from_mapping(json.loads(sweep.as_json())) == sweep


@pytest.mark.parametrize(
    ("declared", "sentence"),
    [
        ({"axes": {}}, "axes: none given, want one or more"),
        ({"axis": {}}, "axis: want one of title, axes, fixed, excitations, run"),
        ({"axes": {"colour": [1]}}, "colour: want one of method, h, slenderness, frequency, friction"),
        ({"axes": {"h": []}}, r"h=\[\]: want a list of one or more values"),
        ({"axes": {"h": 0.5}}, "h=0.5: want a list of one or more values"),
        ({"axes": {"h": [0.5, -1.0]}}, "h=-1.0 m: want a number above 0"),
        ({"axes": {"h": [float("nan")]}}, "h=nan m: want a number above 0"),
        ({"axes": {"h": [True]}}, "h=True m: want a number above 0"),
        ({"axes": {"h": [1.0, 0.5]}}, "h: want ascending values"),
        ({"axes": {"h": [0.5, 0.5]}}, "h: want each value once"),
        ({"axes": {"h": {"start": 1}}}, "want start, stop and count"),
        ({"axes": {"h": {"start": 0, "stop": 1, "count": 3, "log": True}}}, "want start and stop above 0 with log"),
        ({"axes": {"h": {"start": 1, "stop": 2, "count": 2.5}}}, "whole count above 0"),
        ({"axes": {"h": [0.5]}, "fixed": {"h": 1.0}}, "h: is an axis and fixed; want one of the two"),
        ({"axes": {"method": ["method3"]}}, "method='method3': want one of method1, method2, dem"),
        ({"axes": {"method": [1]}}, "method=1: want a name"),
        ({"axes": {"excitation": ["quake"]}}, "excitation='quake': want one of ramp"),
        ({"axes": {"friction": [1.5], "method": ["method2"]}}, "friction: want below 4/3 with method2"),
        (H | {"excitations": {"ramp": {"kind": "nothing"}}}, "excitations.ramp.kind='nothing': want one of"),
        (H | {"excitations": {"ramp": {"kind": "ramped_sinusoid", "steps": 3}}}, "excitations.ramp.steps"),
        (H | {"excitations": {"p": {"kind": "OneSinePulse", "steps": 2.5}}}, "want a whole number above 0"),
        ({"axes": {"h": [1.0]}, "run": {"solver": "euler"}}, "run.solver='euler': want one of"),
        ({"axes": {"h": [1.0]}, "run": {"solver": "scipy"}}, "run.solver='scipy': it has no batch; want one that has"),
        ({"axes": {"h": [1.0]}, "run": {"speed": 1}}, "run.speed: want one of"),
        ({"axes": {"h": [1.0]}, "run": {"rtol": 0}}, "run.rtol=0: want a number above 0"),
        ({"axes": [1]}, r"axes=\[1\]: want a table"),
    ],
)  # fmt: skip
def test_bad_declarations_are_one_sentence(declared, sentence):
    with pytest.raises(ValueError, match=sentence):
        from_mapping(declared)


def test_a_file_that_is_none_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"none.toml: want a file that can be read"):
        read(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("[axes\n")
    with pytest.raises(ValueError, match=r"bad.toml: want TOML"):
        read(tmp_path / "bad.toml")
