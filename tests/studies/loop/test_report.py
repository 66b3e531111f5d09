"""report.html: all sections, strangers' texts as text, nothing from elsewhere, the numbers of loop.json."""

import dataclasses
import math
import re
from html.parser import HTMLParser
from types import SimpleNamespace

import found
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking.effects import available, load
from studies.loop.dataset import dataset
from studies.loop.finding_file import as_json
from studies.loop.models.names import page, readable
from studies.loop.report.figures import Points, binned
from studies.loop.report.page import _nearest, report, write_report
from studies.loop.report.text import concluded, evidence, number, reason, verdict, with_interval
from studies.loop.whole.rivals import Rival

SECTIONS = (
    "verdict", "error", "measured", "histories", "residual", "found", "sure", "ruled-out", "twins", "notes", "next",
    "concluded", "provenance",
)  # fmt: skip
VOID = {"meta", "img", "source", "br"}


class Page(HTMLParser):
    """Elements, text and the numbers (`data`) below each element that has an id."""

    def __init__(self, html):
        super().__init__()
        self.tags, self.attributes, self.text, self.ids, self.open = [], [], {}, [], []
        self.numbers = {}
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.tags.append(tag)
        self.attributes.append((tag, attrs))
        if "id" in attrs:
            self.ids.append(attrs["id"])
        if tag == "data":
            for _, id in self.open:
                self.numbers.setdefault(id, []).append(float(attrs["value"]))
        if tag not in VOID:
            self.open.append((tag, attrs.get("id")))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag, f"{tag} closed out of order"

    def handle_data(self, data):
        for _, id in self.open:
            self.text[id] = self.text.get(id, "") + data


@pytest.fixture(scope="module", params=["tilted", "plain"])
def made(request):
    """(finding, content of loop.json, page) with an effect and without one."""
    finding = getattr(found, request.param)()
    content = as_json(finding, "Turn the block round & release it again.")
    html = report(finding, content, dataset(finding))
    return finding, content, html


def test_verdicts_of_the_two_campaigns():
    assert (found.tilted().verdict, found.plain().verdict) == ("effect", "none")


def test_every_section_is_there_in_order(made):
    _, content, html = made
    seen = Page(html)
    assert not seen.open
    assert [id for id in seen.ids if id in SECTIONS] == list(SECTIONS)
    assert content["next_test"] in seen.text["next"]
    for test in made[0].setup.campaign.tests:
        assert test.id in seen.text["measured"]
    words = {"effect": "What the ideal block lacks is base tilt", "none": "Nothing is missing"}
    assert words[content["verdict"]] in seen.text["verdict"]


def test_strangers_texts_are_text(made):
    finding, _, html = made
    seen = Page(html)
    assert "script" not in seen.tags
    assert "<script" not in html.lower()
    assert not [a for _, attrs in seen.attributes for a in attrs if a.startswith("on")]
    assert finding.setup.campaign.title in seen.text[None]
    assert 'src="x"' not in html


def test_nothing_comes_from_elsewhere(made):
    html = made[2]
    assert not re.search(r"https?://|//[a-z]+\.|@import|url\(", html, re.IGNORECASE)
    for tag, attrs in Page(html).attributes:
        assert tag not in ("script", "link", "iframe", "object", "embed")
        for name in ("src", "srcset", "href"):
            assert attrs.get(name, "data:").startswith("data:image/svg+xml;base64,") or name not in attrs


def test_numbers_are_those_of_loop_json(made):
    _, content, html = made
    seen = Page(html)
    for stage in ("declared", "before", "after"):
        expected = [content["error"][stage][key] for key in ("fit", "holdout")]
        assert seen.numbers[f"error-{stage}"] == expected
    assert seen.numbers["error-floor"] == [content["error"]["noise_floor"]]
    for parameter in content["parameters"].values():
        assert {parameter["value"], parameter["low"], parameter["high"]} <= set(seen.numbers["found"])
    tried = {row["evidence"] for row in content["candidates"]} - {None}
    assert tried <= set(seen.numbers["ruled-out"])


def test_errors_by_test_are_those_of_the_finding(made):
    finding, _, html = made
    numbers = set(Page(html).numbers["error"])
    for stage in ("before", "after"):
        for value in finding.errors[stage].by_test.values():
            assert any(value == pytest.approx(n, rel=1e-9) for n in numbers)


def test_errors_have_the_unit_of_what_was_measured(made):
    """Of accelerometers alone they are accelerations, in captions as in tables."""
    finding, content, html = made
    other = report(finding, content | {"error": content["error"] | {"units": "m/s^2"}}, dataset(finding))
    for shown, unit, alt in ((html, "rad", "Rotation of test"), (other, "m/s^2", "Acceleration on the block of test")):
        assert f"Test by test [{unit}]" in shown
        captions = re.findall(r"rms error .*?</figcaption>", shown)
        assert captions and all(caption.endswith(f"&nbsp;{unit}</figcaption>") for caption in captions)
        assert f'alt="{alt} ' in shown


def test_pictures_have_a_text_instead(made):
    pictures = [attrs for tag, attrs in Page(made[2]).attributes if tag == "img"]
    assert len(pictures) >= 5
    assert all(attrs["alt"] for attrs in pictures)


def test_a_restitution_that_drifts_is_among_the_parameters():
    finding = found.tilted()
    own = {"restitution_drift": (-0.004, -0.005, -0.003), "restitution_drift_fading": (0.3, 0.2, 0.5)}
    told = dataclasses.replace(finding, verdict="unexplained")
    told.__dict__["intervals"] = finding.intervals | own
    kept = as_json(told, "")["parameters"]
    assert kept["restitution_drift"] == {"value": -0.004, "low": -0.005, "high": -0.003, "units": "1", "level": 0.95}
    assert kept["restitution_drift_fading"]["value"] == 0.3
    assert "restitution" not in kept


# The finding is a tilt's, retold as one that had to be learned: a torque in the rotation and its band.
def test_unexplained_with_a_learned_term(tmp_path):
    finding = found.tilted()
    settled = dataclasses.replace(
        finding.settled, names=("learned_term.spring",), covariance=np.array([[0.04]]),
        whole=dataclasses.replace(
            finding.settled.whole, model=finding.after.changed({"learned_term.spring": 0.8})
        ),
    )  # fmt: skip
    finding = dataclasses.replace(finding, verdict="unexplained", settled=settled)
    [curve] = finding.learned
    np.testing.assert_allclose(curve.y, 0.8 * curve.x)
    np.testing.assert_allclose(curve.high - curve.low, 2.0 * 1.96 * 0.2 * np.abs(curve.x), atol=1e-12)
    content = as_json(finding, "")
    write_report(finding, content, dataset(finding), tmp_path / "report.html")
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]
    seen = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "learned" in seen.ids
    assert "Torque against rotation" in seen.text["found"]
    assert "no effect known to this program explains" in seen.text["verdict"]
    assert "None is proposed" in seen.text["next"]


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        (["learned_term"], "explains; with what was learned of it in the model, the error on"),
        (["base_tilt"], "explains, and of which nothing could be learned; with base tilt"),
        ([], "explains, and of which nothing could be learned; with the calibrated block alone, "),
    ],
)
def test_the_verdict_says_whether_anything_was_learned(effects, said):
    stages = {stage: {"fit": 0.02, "holdout": 0.02} for stage in ("before", "after")}
    error = {"units": "rad", "noise_floor": 0.001, **stages}
    content = {"verdict": "unexplained", "effects": effects, "parameters": {}, "error": error}
    assert said in verdict(content)


# Of twenty candidates of two parameters chance lets the best one reach -2 ln(1 - 0.99^(1/20)) = 15.2 once in a hundred.
@pytest.mark.parametrize(("fell", "hinted"), [(22.0, True), (15.1, False), (None, False)])
def test_what_was_not_named_but_is_more_than_chance_is_said_to_be_hinted_at(fell, hinted):
    """A base recorded 9 ms late, behind one accelerometer, fell short of what is asked with 22."""
    stages = {stage: {"fit": 1.0, "holdout": 1.6} for stage in ("before", "after")}
    error = {"units": "m/s^2", "noise_floor": 2.2, **stages}
    rows = [
        {"effect": form, "form": form, "beside": [], "evidence": value}
        for form, value in (("base_motion_gain", 4.5), ("base_motion_lag", fell))
    ]
    content = {
        "verdict": "none", "effects": [], "parameters": {}, "error": error, "candidates": rows, "indistinguishable": [],
    }  # fmt: skip
    said = "Base motion lag is hinted at: it lowers chi-square by 22, more than chance would, but less than the 60"
    assert (said in verdict(content)) is hinted
    assert any(said in text for text in concluded(content)) is hinted
    assert any("by more than chance would." in text for text in concluded(content)) is not hinted
    words = "hinted at, too little to be named" if hinted else "explains too little to be more than chance"
    assert reason(rows[1], content, ()) == (words if fell else "explains nothing")


def retold(values, covariance):
    """The tilt's finding with other parameters in its model, of which the covariance is given."""
    finding = found.tilted()
    names = tuple(name for name in values if not name.endswith(("reach", "intervals", ".interval", ".low", ".high")))
    whole = dataclasses.replace(finding.settled.whole, model=finding.after.changed(values))
    return dataclasses.replace(
        finding, settled=dataclasses.replace(finding.settled, names=names, covariance=covariance, whole=whole)
    )


def test_a_learned_curve_is_drawn_on_both_sides():
    # Two intervals with all coefficients alike: constant, but for the side.
    values = {"learned_curve.odd_reach": 0.1, "learned_curve.odd_intervals": 2.0}
    values |= {f"learned_curve.odd_{j}": 0.3 for j in range(3)}
    [curve] = retold(values, 0.01 * np.eye(3)).learned
    np.testing.assert_allclose(curve.y, 0.3 * np.sign(curve.x), rtol=1e-12)
    ends = np.abs(curve.x) >= 0.1
    assert ends.any()
    np.testing.assert_allclose(curve.high[ends] - curve.low[ends], 2.0 * 1.96 * 0.1, rtol=1e-12)


def test_a_learned_memory_is_drawn_with_a_band_of_both_its_parameters():
    values = {"learned_memory.recent": -0.05, "learned_memory.recent_time": 0.2}
    covariance = np.array([[1e-6, 2e-6], [2e-6, 1e-4]])
    [curve] = retold(values, covariance).learned
    np.testing.assert_allclose(curve.y, -0.05 * np.exp(-curve.x / 0.2), rtol=1e-12)
    draws = np.random.default_rng(0).multivariate_normal((-0.05, 0.2), covariance, 20000)
    drawn = draws[:, :1] * np.exp(-curve.x / draws[:, 1:])
    np.testing.assert_allclose((curve.high - curve.low) / (2.0 * 1.96), drawn.std(axis=0), rtol=0.05, atol=1e-6)


@pytest.mark.parametrize(("exponent", "label"), [(0.0, "all impacts before"), (2.0, "squares of the speeds")])
def test_wear_is_drawn_over_the_use_of_the_campaign(exponent, label):
    values = {"learned_memory.worn": -0.05, "learned_memory.worn_use": 8.0}
    covariance = np.array([[1e-6, 2e-5], [2e-5, 1e-2]])
    finding = retold(values, covariance)
    model = finding.settled.whole.model.changed({"learned_memory.worn_exponent": exponent})
    whole = dataclasses.replace(finding.settled.whole, model=model)
    finding = dataclasses.replace(finding, settled=dataclasses.replace(finding.settled, whole=whole))
    [curve] = finding.learned
    np.testing.assert_allclose(curve.y, -0.05 * (1.0 - np.exp(-curve.x / 8.0)), rtol=1e-12)
    # Each impact as it was seen counts, of the test before the last too.
    records = finding.setup.records
    swings = sum(len(r.found.swings) for r in records)
    used = float(swings) if exponent == 0.0 else sum(sum(r.squares) for r in records)
    assert curve.x[-1] == pytest.approx(used, rel=0.02) and label in curve.x_label and used > 20.0
    draws = np.random.default_rng(0).multivariate_normal((-0.05, 8.0), covariance, 20000)
    drawn = draws[:, :1] * (1.0 - np.exp(-curve.x / draws[:, 1:]))
    np.testing.assert_allclose((curve.high - curve.low) / (2.0 * 1.96), drawn.std(axis=0), rtol=0.05, atol=1e-6)
    later = finding.later(model)
    assert later.number == len(finding.setup.campaign.tests)
    assert later.effects["learned_memory"]["used"] == curve.x[-1]
    assert finding.later(finding.before).effects == finding.before.effects
    # A form of which only what it fits is given, as after a short pause, keeps count as well.
    recent = finding.before.changed({"learned_memory.recent": -0.02, "learned_memory.recent_time": 0.2})
    squares = sum(sum(r.squares) for r in records)
    assert finding.later(recent).effects["learned_memory"]["used"] == pytest.approx(squares, rel=0.02)


def test_a_plate_is_drawn_by_what_it_makes_of_sinusoids():
    """At its own frequency f it answers sqrt(1 + 1 / (2 z)^2) times, at sqrt(2) f once, whatever its damping z."""
    values = {"learned_base.frequency": 10.0, "learned_base.damping_ratio": 0.1}
    [curve] = retold(values, np.diag([0.0, 1e-6])).learned
    assert curve.x[0] == 0.0 and curve.y[0] == 1.0 and curve.x[-1] == 20.0
    at = np.interp([10.0, 10.0 * math.sqrt(2.0)], curve.x, curve.y)
    np.testing.assert_allclose(at, [math.sqrt(1.0 + 25.0), 1.0], rtol=2e-3)
    k = np.argmin(np.abs(curve.x - 10.0))
    # d/dz sqrt(1 + 1 / (2 z)^2) = -1 / (4 z^3 sqrt(1 + 1 / (2 z)^2)).
    assert curve.high[k] - curve.y[k] == pytest.approx(1.96 * 1e-3 * 250.0 / math.sqrt(26.0), rel=1e-3)


def test_a_coupled_sensor_is_drawn_by_what_it_passes():
    """A first-order high-pass has 1/sqrt(2) at its corner f, 3/sqrt(10) at 3 f; d/df of that is -1/(f 2^1.5) at f."""
    [curve] = retold({"learned_coupling.corner_frequency": 0.2}, np.diag([1e-6])).learned
    assert curve.x[0] == 0.0 and curve.y[0] == 0.0 and curve.x[-1] == 2.0
    at = np.interp([0.2, 0.6], curve.x, curve.y)
    np.testing.assert_allclose(at, [1.0 / math.sqrt(2.0), 3.0 / math.sqrt(10.0)], rtol=1e-3)
    k = np.argmin(np.abs(curve.x - 0.2))
    assert curve.high[k] - curve.y[k] == pytest.approx(1.96 * 1e-3 / (0.2 * 2.0**1.5), rel=1e-3)
    # One that loses nothing has no slow motion to draw.
    assert retold({"learned_coupling.corner_frequency": 0.0}, np.diag([1e-6])).learned == ()


def test_a_push_is_drawn_over_the_longest_test():
    """Of one B-spline 2/3 in its middle and 1/6 an interval from there; its band goes with it."""
    [curve] = retold({"learned_push.interval": 0.5, "learned_push.push_3": 0.3}, np.diag([1e-4])).learned
    longest = max(float(record.time[-1] - record.time[0]) for record in found.tilted().setup.records)
    assert curve.x[0] == 0.0 and curve.x[-1] == longest and curve.x_label == "time since the test began [s]"
    np.testing.assert_allclose(np.interp([0.5, 1.0, 1.5], curve.x, curve.y), [0.05, 0.2, 0.05], rtol=1e-2)
    np.testing.assert_allclose(curve.high - curve.y, 1.96 * 1e-2 / 0.3 * np.abs(curve.y), rtol=1e-9, atol=1e-15)


def test_damping_with_a_shape_of_its_own_on_either_side_is_drawn_from_end_to_end():
    values = {"learned_damping.low": -0.1, "learned_damping.reach": 0.2, "learned_damping.intervals": 1.0}
    values |= {"learned_damping.damping_0": -0.3, "learned_damping.damping_1": 0.3}
    [curve] = retold(values, 1e-4 * np.eye(2)).learned
    np.testing.assert_allclose(curve.y, np.interp(curve.x, (-0.1, 0.2), (-0.3, 0.3)), rtol=0.0, atol=1e-12)
    assert curve.label == "Damping against rotation"


def test_friction_is_drawn_from_the_end_on_one_side_to_that_on_the_other():
    ends = {"low": -0.1, "high": 0.2, "intervals": 1.0}
    values = {f"learned_friction.{name}": value for name, value in ends.items()}
    values |= {"learned_friction.friction_0": -0.3, "learned_friction.friction_1": 0.3}
    [curve] = retold(values, 1e-4 * np.eye(2)).learned
    np.testing.assert_allclose(curve.y, np.interp(curve.x, (-0.1, 0.2), (-0.3, 0.3)), rtol=0.0, atol=1e-12)
    share = np.interp(curve.x, (-0.1, 0.2), (0.0, 1.0))
    np.testing.assert_allclose(curve.high - curve.y, 1.96 * 0.01 * np.hypot(share, 1.0 - share), rtol=1e-9)
    assert curve.label == "Friction against rotation"


def test_a_curve_with_each_side_its_own_is_drawn_as_one():
    """0.3 rad/s^2 toward +x from the left alone: half of it alike on both sides, half with one sign."""
    values = {f"learned_curve.{kind}_{name}": value for kind in ("odd", "even")
              for name, value in (("reach", 0.2), ("intervals", 1.0))}  # fmt: skip
    for kind, half in (("odd", -0.15), ("even", 0.15)):
        values |= {f"learned_curve.{kind}_{k}": half for k in range(2)}
    # What one of them has too much the other has too little: their sum is certain on the right, and twice as uncertain
    # on the left.
    one = 0.01**2 * np.eye(2)
    [curve] = retold(values, np.block([[one, -one], [-one, one]])).learned
    assert curve.label == "Torque against rotation, each side its own"
    aside = curve.x != 0.0
    np.testing.assert_allclose(curve.y[aside], np.where(curve.x < 0.0, 0.3, 0.0)[aside], rtol=0.0, atol=1e-12)
    share = np.abs(np.minimum(np.abs(curve.x), 0.2) / 0.2)
    wide = 1.96 * 0.02 * np.hypot(share, 1.0 - share)
    expected = np.where(curve.x < 0.0, wide, 0.0)
    np.testing.assert_allclose((curve.high - curve.y)[aside], expected[aside], rtol=1e-9, atol=1e-9)


def test_a_mass_that_hangs_is_drawn_as_one_of_the_same_frequency_on_a_spring():
    """Of small swings the two are the same: the weight of one acts at its hinge, and its arm is g / w^2."""
    values = {"learned_mode.mass_ratio": 0.02, "learned_mode.height_ratio": 1.2, "learned_mode.frequency": 2.0,
              "learned_mode.damping_ratio": 0.1}  # fmt: skip
    both = [
        retold({**values, "learned_mode.hanging": h}, 1e-6 * np.eye(5)).learned[0] for h in (0.0, 1.0)
    ]  # fmt: skip
    np.testing.assert_allclose(both[1].y, both[0].y, rtol=0.0, atol=1e-5 * np.abs(both[0].y).max())
    assert [curve.label.partition(":")[0] for curve in both] == ["A mass inside", "A mass that hangs inside"]


def test_a_learned_mode_is_drawn_as_a_mass_that_swings():
    """The block stops from 1 rad/s: the mass goes on with its height in m/s; drawn by an integrator in the test."""
    values = {"learned_mode.mass_ratio": 0.02, "learned_mode.height_ratio": 1.2, "learned_mode.frequency": 2.0,
              "learned_mode.damping_ratio": 0.1}  # fmt: skip
    finding = retold(values, np.diag([1e-6, 0.0, 0.0, 0.0]))
    [curve] = finding.learned
    block = finding.setup.campaign.block
    w, height = 2.0 * math.pi * 2.0, 1.2 * block.centre_height
    there = solve_ivp(lambda t, y: (y[1], -(w**2) * y[0] - 0.2 * w * y[1]), (0.0, curve.x[-1]), (0.0, height),
                      t_eval=curve.x, rtol=1e-9, atol=1e-12).y  # fmt: skip
    pull = 0.02 * block.mass * (finding.after.g * there[0] + height * (w**2 * there[0] + 0.2 * w * there[1]))
    np.testing.assert_allclose(curve.y, pull / block.I_O, rtol=0.0, atol=1e-6 * np.abs(curve.y).max())
    # The torque is proportional to the mass, which alone is uncertain here: 1.96 times 1e-3 of 0.02.
    np.testing.assert_allclose(curve.high - curve.y, 1.96 * 0.05 * np.abs(curve.y), rtol=1e-6, atol=1e-12)


def test_an_uncertain_frequency_widens_the_band_with_time():
    """Undamped the torque is A sin(w t), A = mu m h (g / w + h w) / I_O: its derivative by w at a given time."""
    values = {"learned_mode.mass_ratio": 0.02, "learned_mode.height_ratio": 1.2, "learned_mode.frequency": 2.0,
              "learned_mode.damping_ratio": 0.0}  # fmt: skip
    finding = retold(values, np.diag([0.0, 0.0, 1e-4, 0.0]))
    [curve] = finding.learned
    block, w, g = finding.setup.campaign.block, 2.0 * math.pi * 2.0, finding.after.g
    height = 1.2 * block.centre_height
    size = 0.02 * block.mass * height * (g / w + height * w) / block.I_O
    by_w = 0.02 * block.mass * height * (height - g / w**2) / block.I_O
    np.testing.assert_allclose(curve.y, size * np.sin(w * curve.x), rtol=0.0, atol=1e-6 * size)
    slope = 2.0 * math.pi * (by_w * np.sin(w * curve.x) + size * curve.x * np.cos(w * curve.x))
    expected = 1.96 * 0.01 * np.abs(slope)
    np.testing.assert_allclose(curve.high - curve.y, expected, rtol=0.0, atol=1e-4 * expected.max())


def test_a_learned_hysteresis_is_drawn_as_a_loop():
    """Dahl's curve from upright to the reach; the spring alone, whose size is uncertain, for the band."""
    values = {"learned_hysteresis.stiffness": 40.0, "learned_hysteresis.width": 0.03}
    finding = retold(values, np.diag([16.0, 0.0]))
    [curve] = finding.learned
    first = slice(0, int(np.argmax(curve.x)) + 1)
    expected = -40.0 / finding.setup.campaign.block.I_O * 0.03 * (1.0 - np.exp(-curve.x[first] / 0.03))
    np.testing.assert_allclose(curve.y[first], expected, rtol=0.0, atol=1e-4 * np.abs(expected).max())
    assert curve.y[-1] == pytest.approx(curve.y[first][-1], rel=1e-2)  # the loop closes
    np.testing.assert_allclose(curve.high - curve.y, 1.96 * 0.1 * np.abs(curve.y), rtol=1e-6, atol=1e-12)
    # Nothing is known of how far it was strained at a release, which has no say in the loop.
    values |= {"learned_hysteresis.strained": 0.5}
    [same] = retold(values, np.diag([16.0, 0.0, math.inf])).learned
    np.testing.assert_allclose(same.high, curve.high, rtol=1e-12)
    # With an exponent of two it goes as tanh.
    values = {
        "learned_hysteresis.stiffness": 40.0,
        "learned_hysteresis.width": 0.03,
        "learned_hysteresis.exponent": 2.0,
    }
    [curve] = retold(values, np.diag([16.0, 0.0, 0.0])).learned
    expected = -40.0 / finding.setup.campaign.block.I_O * 0.03 * np.tanh(curve.x[first] / 0.03)
    np.testing.assert_allclose(curve.y[first], expected, rtol=0.0, atol=1e-4 * np.abs(expected).max())


def test_what_a_sensor_adds_is_drawn_over_the_rotation():
    [curve] = retold({"learned_reading.cubic": -0.5}, np.array([[0.04]])).learned
    np.testing.assert_allclose(curve.y, -0.5 * curve.x**3, rtol=1e-12)
    np.testing.assert_allclose(curve.high - curve.low, 2.0 * 1.96 * 0.2 * np.abs(curve.x) ** 3, rtol=1e-12, atol=1e-18)
    assert (curve.label, curve.y_label) == ("Reading against rotation", "added to the reading [rad]")


def test_how_late_a_clock_is_is_drawn_over_a_record():
    """A reading at t is of (1 + pace) t - lag: late by lag - pace t."""
    [curve] = retold({"learned_timing.pace": -0.005, "learned_timing.lag": 0.01}, np.diag([1e-8, 1e-8])).learned
    assert curve.x[0] == 0.0 and curve.x[-1] > 1.0
    np.testing.assert_allclose(curve.y, 0.01 + 0.005 * curve.x, rtol=1e-12)
    assert (curve.label, curve.y_label) == ("Clock of the rotation's recorder", "late by [s]")


def test_what_a_slow_sensor_reads_is_drawn_against_the_frequency():
    """At its own frequency 1 / (2 damping_ratio); far above it nothing."""
    values = {"learned_response.frequency": 12.0, "learned_response.damping_ratio": 0.7}
    [curve] = retold(values, np.diag([0.01, 1e-4])).learned
    assert (curve.x[0], curve.x[-1], curve.y[0]) == (0.0, 36.0, 1.0)
    assert np.interp(12.0, curve.x, curve.y) == pytest.approx(1.0 / 1.4, rel=1e-9)
    assert curve.label == "Sensor of the rotation" and np.all(curve.low[1:] < curve.y[1:])


def test_a_curve_of_a_sensor_is_drawn_over_the_rotation():
    ends = {"low": -0.15, "high": 0.2, "intervals": 2.0}
    values = {f"learned_reading.{name}": value for name, value in ends.items()}
    values |= {f"learned_reading.curve_{j}": size for j, size in enumerate((1e-3, -2e-3, 1e-3))}
    [curve] = retold(values, 1e-8 * np.eye(3)).learned
    own = load("learned_reading")(**ends, curve_0=1e-3, curve_1=-2e-3, curve_2=1e-3)
    np.testing.assert_allclose(curve.y, own.reading(curve.x) - curve.x, rtol=0.0, atol=1e-15)
    assert curve.label == "Reading against rotation, a curve" and (curve.high > curve.low).all()


@pytest.mark.parametrize("name", available())
def test_every_effect_has_a_page(name):
    about = page(name)
    assert about.title and about.sentence
    assert {"Limits", "Source"} <= {key for key, _ in about.sections}
    assert all(value for _, value in about.sections)


def test_numbers_as_they_are_read():
    assert [number(v) for v in (None, 0.000227, -12345.0, 0.5)] == ["–", "0.000227", "−12300", "0.5"]
    assert [evidence(v) for v in (None, 8180.4, 6.61, -2e-7)] == ["–", "8180", "6.6", "0"]
    # Two digits of the half-width 1.4e-5, that is to the sixth decimal; of 2e4, that is to thousands.
    assert with_interval(0.0021881, 0.0021741, 0.0022021) == ("0.002188", "0.002174", "0.002202")
    assert with_interval(-0.0045, -0.005, -0.004) == ("−0.00450", "−0.00500", "−0.00400")
    assert with_interval(513214.0, 493214.0, 533214.0) == ("513000", "493000", "533000")
    assert with_interval(0.5, 0.5, 0.5) == ("0.5", "0.5", "0.5")
    assert readable("table_pitch[acceleration]") == "Table pitch (acceleration)"


def test_reasons():
    rows = [
        {"effect": "base_tilt", "form": "base_tilt", "evidence": 1000.0},
        {"effect": "eccentric_mass", "form": "eccentric_mass", "evidence": 995.0},
        {"effect": "rounded_edges", "form": "rounded_edges", "evidence": 960.0},
        {"effect": "quadratic_drag", "form": "quadratic_drag", "evidence": 80.0},
        {"effect": "sliding", "form": "sliding", "evidence": -3.0},
        {"effect": "tether", "form": "tether[left]", "evidence": None, "not_refitted": "score 1.2"},
        {"effect": "eccentric_mass", "form": "eccentric_mass[other]", "evidence": 700.0},
        {"effect": "base_tilt", "form": "base_tilt[alike]", "evidence": 989.0},
        {"effect": "base_tilt", "form": "base_tilt[worse]", "evidence": 980.0},
    ]
    rows = [{**row, "beside": []} for row in rows]
    # What whole records refused is no measure for the others, however much it explains of swings.
    rows.append({
        "effect": "base_motion_lag", "form": "base_motion_lag", "evidence": 2000.0,
        "refused": "whole records speak against it", "beside": [],
    })  # fmt: skip
    # In the place of another effect it is measured by the best one there.
    rows += [
        {"effect": name, "form": name, "evidence": evidence, "beside": ["base_tilt"]}
        for name, evidence in (("viscous_damping", 50.0), ("quadratic_drag", 20.0))
    ]
    # What may stand in the place of the tilt may not do so in that of the damping.
    rows.append({"effect": "eccentric_mass", "form": "eccentric_mass", "evidence": 10.0, "beside": ["base_tilt"]})
    content = {"verdict": "effect", "candidates": rows, "indistinguishable": [["base_tilt", "eccentric_mass"]]}
    assert [reason(row, content, ("base_tilt", "viscous_damping")) for row in rows] == [
        "in the model after",
        "cannot be told apart from what was chosen",
        "comes near, but leaves 40 more than the best one",
        "explains 8 % of what the best one does",
        "explains nothing",
        "not refitted: its score 1.2 is too small",
        "explains 70 % of what the best one does",
        "cannot be told apart from the form that was chosen",
        "comes near, but leaves 20 more than the best one",
        "whole records speak against it",
        "in the model after",
        "explains 40 % of what the best one does",
        "explains 20 % of what the best one does",
    ]


@pytest.mark.parametrize(
    ("refused", "criterion", "said"),
    [
        (False, 108.8, "The nearest rival, eccentric mass, fits worse by 8.8 in chi-square; its held-out error is"),
        (
            False,
            95.0,
            "The nearest rival, eccentric mass, fits better by 5 in chi-square, less than the 12 that would "
            "tell them apart, and whole records speak against it; its held-out error is",
        ),
        (True, 50.0, "fits worse by 8500 in chi-square over whole records, better by 50 in single swings; its"),
    ],
)
def test_the_nearest_rival_is_named_by_what_it_has_instead(refused, criterion, said):
    swing = SimpleNamespace(chi2=100.0, parameters=(), samples=10)

    def rival(names, criterion, whole, refused=False):
        effects = tuple(name.partition("[")[0] for name in names)
        return Rival(SimpleNamespace(names=names, effects=effects, swing=swing), None, criterion, whole, 5e-4, refused)

    best = rival(("base_tilt", "quadratic_drag"), 100.0, 1000.0)
    finding = SimpleNamespace(rivals=(best, rival(("quadratic_drag", "eccentric_mass"), criterion, 9500.0, refused)))
    assert said in _nearest(finding, "rad")
    forms = SimpleNamespace(rivals=(rival(("sliding[ratio]",), 100.0, 1000.0), rival(("sliding",), 151.0, 1100.0)))
    assert _nearest(forms, "rad").startswith(
        "The nearest rival, sliding as another form of the same effect, fits worse by 51 in chi-square;"
    )


def test_bins_hold_all_points_and_their_errors_are_of_weighted_means():
    rng = np.random.default_rng(0)
    x, sd = rng.uniform(-1.0, 1.0, 400), rng.uniform(0.5, 2.0, 400)
    y = 3.0 * x + sd * rng.standard_normal(400)
    at, mean, error = binned(x, y, sd)
    assert 6 <= at.size <= 9
    assert np.all(np.abs(mean - 3.0 * at) < 4.0 * error)
    at, mean, error = binned(np.repeat([1.0, 2.0], 8), np.arange(16.0), np.ones(16), steps=True)
    assert at.tolist() == [1.0, 2.0]
    assert mean.tolist() == [3.5, 11.5]
    # Scatter of 0..7 about its mean, variance 6, over eight points.
    assert error == pytest.approx(np.sqrt(6.0 / 8.0))
    assert Points(x, y, y, sd).over_noise("before") > 1.0


def test_the_candidate_that_was_kept_has_the_error_of_the_model_after():
    finding = found.tilted()
    [row] = [r for r in as_json(finding, "")["candidates"] if r["form"] == finding.chosen.names[-1] and not r["beside"]]
    assert row["holdout_error"] == finding.errors["after"].holdout
