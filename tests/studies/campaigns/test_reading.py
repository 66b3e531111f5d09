"""What is read: everything, exactly; and oddities of text that mean the same."""

import gzip
import shutil
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from rocking import Block
from studies.campaigns import CampaignError, DeclaredBlock, motion_groups, read, write

from .conftest import STEP, read_only


@pytest.mark.parametrize("compressed", [False, True])
def test_reading_what_was_written_gives_the_same(campaign, tmp_path, compressed):
    path = write(campaign, tmp_path, compressed=compressed)
    again = read(path)
    assert again == campaign
    assert read(tmp_path) == campaign
    assert again.path == path
    for test, its in zip(campaign.tests, again.tests, strict=True):
        for name, values in test.data.items():
            assert np.array_equal(values, its.data[name], equal_nan=True)
            assert not its.data[name].flags.writeable


def test_equality_sees_every_sample(campaign):
    first = campaign.tests[0]
    values = first.data["rotation"].copy()
    values[77] += 1e-15
    other = replace(first, data={"rotation": read_only(values)})
    assert other != first and replace(campaign, tests=(other, *campaign.tests[1:])) != campaign


def test_same_bytes_for_the_same_campaign(campaign, tmp_path):
    for name in ("a", "b"):
        write(campaign, tmp_path / name, compressed=True)
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


def test_roles_of_the_tests(campaign, folder):
    again = read(folder)
    assert [t.id for t in again.to_predict] == ["ahead", "free-p"]
    assert [t.id for t in again.measured] == ["free-01", "ramp-3Hz", "ramp-4Hz", "named é"]
    assert not again.holds_outcomes_alone
    assert again.test("ramp-3Hz").time_step == pytest.approx(STEP, rel=1e-12)
    assert again.test("free-p").rotation is None and again.test("free-p").base_x is None
    with pytest.raises(KeyError, match="want one of"):
        again.test("nobody")


def test_block_constants_are_those_of_a_uniform_block():
    """Against `rocking.Block`, whose constants have tests of their own."""
    uniform = Block(b=0.15, h=0.5, d=0.25, density=600.0)
    declared = DeclaredBlock(0.15, 0.5, 0.25, uniform.mass)
    assert declared.alpha == pytest.approx(uniform.alpha, rel=1e-14)
    assert declared.p() == pytest.approx(uniform.p(), rel=1e-14)
    assert declared.density == pytest.approx(600.0, rel=1e-14)
    # A declared centre of mass and inertia that say "uniform" change nothing.
    spelt = replace(declared, centre_of_mass_height=0.25, inertia=uniform.I_c)
    assert (spelt.alpha, spelt.p()) == pytest.approx((uniform.alpha, uniform.p()), rel=1e-14)


def edited(folder, name, change):
    path = folder / name
    path.write_bytes(change(path.read_bytes()))


@pytest.mark.parametrize(
    "change",
    [
        lambda b: b.replace(b"\n", b"\r\n"),
        lambda b: b.replace(b"\n", b"\r"),
        lambda b: b"\xef\xbb\xbf" + b,
        lambda b: b + b"\n \n\n",
        lambda b: b.rstrip(b"\n"),
        lambda b: b.replace(b",", b" ,\t"),
        lambda b: b"\n".join(b",".join(b'"' + f + b'"' for f in line.split(b",")) for line in b.split(b"\n") if line),
        gzip.compress,
        lambda b: gzip.compress(b[:5000]) + gzip.compress(b[5000:]),
    ],
    ids=["CRLF", "CR", "BOM", "blank end", "no end", "blanks", "quotes", "gzip without .gz", "two gzip members"],
)
def test_the_same_numbers_in_other_clothes(campaign, folder, change):
    for name in ("named é.csv", "ramp-4Hz.csv", "free-p.csv"):
        edited(folder, name, change)
    edited(folder, "campaign.toml", lambda b: b"\xef\xbb\xbf" + b.replace(b"\n", b"\r\n"))
    assert read(folder) == campaign


def test_nan_is_a_missing_sample_too(campaign, folder):
    edited(folder, "named é.csv", lambda b: b.replace(b",,", b",NaN,"))
    assert read(folder) == campaign


def test_a_record_may_lie_beside_the_campaign(campaign, folder):
    (folder.parent / "records").mkdir()
    shutil.move(folder / "free-01.csv", folder.parent / "records" / "f.csv")
    edited(folder, "campaign.toml", lambda b: b.replace(b'"free-01.csv"', b'"../records/f.csv"'))
    again = read(folder)
    assert again == campaign and again.tests[0].source == "../records/f.csv"


def test_times_printed_with_few_digits_are_uniform(campaign, folder):
    """300 Hz printed to the millisecond: 0.003, 0.007, 0.010."""
    lines = (folder / "free-01.csv").read_text().splitlines()
    printed = [lines[0]] + [f"{k / 300:.3f},{line.split(',')[1]}" for k, line in enumerate(lines[1:])]
    (folder / "free-01.csv").write_text("\n".join(printed))
    assert read(folder).tests[0].time_step == pytest.approx(1 / 300, rel=1e-3)


def test_unknown_keys_are_named_and_not_used(folder):
    edited(folder, "campaign.toml", lambda b: b'operator = "N. N."\n' + b)
    assert any("'operator'" in text for text in read(folder).warnings)


def test_a_forced_test_starts_upright_whatever_is_declared(folder):
    """Fits start there; a prediction is to start there, too."""
    edited(folder, "campaign.toml", lambda b: b.replace(b'kind = "forced"', b'kind = "forced"\ninitial_rotation = 0.1'))
    again = read(folder)
    forced = [test for test in again.tests if test.kind == "forced"]
    assert forced and all(test.initial_rotation is None for test in forced)
    told = [text for text in again.warnings if "not used: a forced test starts upright" in text]
    assert len(told) == len(forced)


def test_outcomes_alone(campaign, tmp_path):
    bare = tuple(replace(t, overturned=t.id == "a") for t in (campaign.test("ahead"),))
    only = replace(campaign, tests=(replace(bare[0], id="a", overturned=True), replace(bare[0], id="b")))
    again = read(write(only, tmp_path))
    assert again == only and again.holds_outcomes_alone and not again.to_predict


def test_an_accelerometer_alone_makes_a_response(campaign, tmp_path):
    test = campaign.test("ramp-4Hz")
    channels = test.channels[1:]
    alone = replace(test, channels=channels, data={c.name: test.data[c.name] for c in channels})
    again = read(write(replace(campaign, channels=channels, tests=(alone,)), tmp_path))
    assert again.measured and again.tests[0].rotation is None
    assert again.channels[1].axis == (0.0, 1.0)


def test_repeats_of_a_motion_belong_together(campaign):
    """ "ramp-3Hz" and "ahead" have one base; the named one stands apart because it says so; free tests are alone."""
    assert motion_groups(campaign) == (("free-01",), ("ramp-3Hz", "ahead"), ("ramp-4Hz",), ("named é",), ("free-p",))


def test_a_motion_is_known_again_when_scaled_shifted_and_noisy(campaign):
    rng = np.random.default_rng(3)
    first = campaign.test("ramp-3Hz")
    moved = np.concatenate([np.zeros(150), 0.6 * first.data["base_x"]]) + 0.02 * rng.standard_normal(
        first.time.size + 150
    )
    later = replace(
        first, id="later", time=STEP * np.arange(moved.size), data={"base_x": moved}, channels=first.channels[1:]
    )
    groups = motion_groups(replace(campaign, tests=(first, campaign.test("ramp-4Hz"), later)))
    assert groups == (("ramp-3Hz", "later"), ("ramp-4Hz",))


def test_what_is_written_is_plain_toml(campaign, folder):
    text = tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))
    assert text["title"] == campaign.title and text["test"][0]["data"] == "free-01.csv"
    assert "centre_of_mass_height" not in text["block"]


@pytest.mark.parametrize("id", ["../x", "", ".", "a/b", "a\nb", "x" * 300, " a", "a\\b"])
def test_an_id_that_is_no_file_name_is_not_written(campaign, tmp_path, id):
    with pytest.raises(CampaignError, match="want a name"):
        write(replace(campaign, tests=(replace(campaign.tests[0], id=id),)), tmp_path)
    assert not list(tmp_path.iterdir())


def test_one_id_twice_is_not_written(campaign, tmp_path):
    with pytest.raises(CampaignError, match="once"):
        write(replace(campaign, tests=campaign.tests[:1] * 2), tmp_path)
