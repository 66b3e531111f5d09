"""Strangers' files: whatever stands in them, a campaign or a CampaignError comes out, never another exception."""

import gzip
import random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studies.campaigns import Campaign, CampaignError, read

T = 0.01 * np.arange(60)
RECORD = "\n".join(
    ["time,rotation,base_x", *(f"{t:.2f},{0.05 * np.sin(9 * t):.5f},{2.0 * np.sin(30 * t):.4f}" for t in T), ""]
)
RECORD = RECORD.replace("0.05,0.02175,", "0.05,,")
TOML = """title = "Block"
[block]
breadth = 0.15
height = 0.50
depth = 0.25
mass = 11.2
[conditions]
friction = 0.7
[[channel]]
name = "rotation"
kind = "rotation"
noise = 2.0e-4
[[channel]]
name = "base_x"
kind = "base_acceleration_x"
[[channel]]
name = "acc"
kind = "block_acceleration"
position = [0.0, 0.48]
direction = [1.0, 0.0]
[[test]]
id = "ramp"
kind = "forced"
data = "ramp.csv"
motion = "El Centro"
overturned = false
[[test]]
id = "free"
kind = "free"
data = "free.csv"
initial_rotation = 0.1
"""
FREE = "\n".join(["time", *(f"{t:.2f}" for t in T)])
several = settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "campaign.toml").write_text(TOML)
    (tmp_path / "ramp.csv").write_text(RECORD)
    (tmp_path / "free.csv").write_text(FREE)
    return tmp_path


def outcome(folder, name, data):
    """The campaign with one file changed, or None where it was refused with a sentence."""
    (folder / name).write_bytes(data)
    try:
        campaign = read(folder)
    except CampaignError as error:
        sentence = str(error)
        assert sentence and sentence.isprintable() and len(sentence) < 500
        return None
    finally:
        (folder / "campaign.toml").write_text(TOML)
        (folder / "ramp.csv").write_text(RECORD)
    assert isinstance(campaign, Campaign)
    for test in campaign.tests:
        assert test.time.size >= 16 and np.isfinite(test.time).all() and np.all(np.diff(test.time) > 0.0)
        for values in test.data.values():
            assert values.shape == test.time.shape and not np.isinf(values).any()
    return campaign


def test_the_files_themselves_are_read(folder):
    campaign = outcome(folder, "ramp.csv", RECORD.encode())
    assert len(campaign.tests) == 2 and np.isnan(campaign.tests[0].rotation).sum() == 1


FILES = {"campaign.toml": TOML, "ramp.csv": RECORD}


@pytest.mark.parametrize("name", FILES)
@several
@given(text=st.text(max_size=200))
def test_any_text(folder, name, text):
    outcome(folder, name, text.encode("utf-8", "surrogatepass"))


@pytest.mark.parametrize("name", FILES)
@several
@given(data=st.binary(max_size=200), packed=st.booleans())
def test_any_bytes(folder, name, data, packed):
    outcome(folder, name, gzip.compress(data) if packed else data)


@several
@given(
    rows=st.lists(
        st.lists(st.one_of(st.floats().map(repr), st.integers().map(str), st.text(max_size=6)), max_size=4), max_size=40
    )
)
def test_any_table(folder, rows):
    body = "\n".join(",".join(row) for row in rows)
    outcome(folder, "ramp.csv", f"time,rotation,base_x\n{body}".encode("utf-8", "replace"))


@pytest.mark.parametrize("name", FILES)
@several
@given(seed=st.integers(0, 2**32), count=st.integers(1, 12))
def test_characters_changed_to_likely_ones(folder, name, seed, count):
    rng = random.Random(seed)
    text = list(FILES[name])
    for _ in range(count):
        text[rng.randrange(len(text))] = rng.choice("0123456789.-+eE |:,=()[]{}\"'#\n\r\t_\\nanif\u00a0é\u0663")
    outcome(folder, name, "".join(text).encode())


@pytest.mark.parametrize("name", FILES)
@several
@given(seed=st.integers(0, 2**32), share=st.sampled_from([0.0005, 0.003, 0.05, 0.5]))
def test_bytes_changed_at_random(folder, name, seed, share):
    rng = random.Random(seed)
    data = bytearray(FILES[name].encode())
    for i in range(len(data)):
        if rng.random() < share:
            data[i] = rng.randrange(256)
    outcome(folder, name, bytes(data))


@pytest.mark.parametrize("name", FILES)
def test_lines_lost_doubled_or_swapped(folder, name):
    lines = FILES[name].split("\n")
    for i in range(len(lines)):
        outcome(folder, name, "\n".join(lines[:i] + lines[i + 1 :]).encode())
        outcome(folder, name, "\n".join([*lines[:i], lines[i], *lines[i:]]).encode())
        outcome(folder, name, "\n".join([*lines[:i], lines[-1 - i], *lines[i + 1 :]]).encode())


def values():
    """What TOML can put in place of a value."""
    return st.sampled_from(
        ["1", "-1", "0", "0.0", "-0.0", "1e300", "1e-300", "inf", "nan", "true", '""', '"a"', "[]", "[1, 2]", "[[1]]",
         "{}", "{a = 1}", "1979-05-27T07:32:00Z", "07:32:00", "0xff", "'''\n'''", '"\\u0000"', "9223372036854775808",
         "[nan, 0.0]", "[1e308, 1e308]", "[true, false]", "[1e-320, 0.0]"]
    )  # fmt: skip


@several
@given(value=values(), line=st.integers(0, TOML.count("\n") - 1))
def test_any_value_for_any_key(folder, value, line):
    lines = TOML.split("\n")
    if "=" in lines[line]:
        lines[line] = lines[line].split("=")[0] + "= " + value
    outcome(folder, "campaign.toml", "\n".join(lines).encode())


@pytest.mark.parametrize("value", [0.0, 1e-300, 1e300, -1e300, 5e-324, 3.1, 1e-9])
@pytest.mark.parametrize("column", [1, 2])
def test_constant_and_extreme_columns(folder, value, column):
    rows = [line.split(",") for line in RECORD.strip().split("\n")]
    for row in rows[1:]:
        row[column] = repr(value)
    outcome(folder, "ramp.csv", "\n".join(",".join(row) for row in rows).encode())


def test_one_spike_in_silence(folder):
    """Records whose quietest stretches are exactly constant."""
    for size in (1e-12, 1e-3, 1.0):
        rows = [f"{t:.2f},{size if k == 30 else 0.0},{1.0 + size * (k == 31)}" for k, t in enumerate(T)]
        outcome(folder, "ramp.csv", "\n".join(["time,rotation,base_x", *rows]).encode())
