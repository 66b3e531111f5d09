"""The question of a newcomer on the command line: will it rock, will it fall, with what margin?"""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import excitation as ex
from excitation import PiecewiseLinear
from rocking import Block, Method1, solve
from rocking.closed_forms import full_sine_pulse
from rocking.pulse_overturning import one_impact_band
from studies import will_it_fall as command
from studies.running.files import BadInputError

BLOCK = Block(b=0.2, h=0.8)

# First overturning amplitude [m/s^2] of one cycle of a sine at 1, 2, 3 Hz for the block of 0.2 x 0.8 m, g = 9.81,
# nonlinear, Housner's restitution: located events; MuJoCo and pymunk agree within 1 %.
FIRST = {1.0: 2.869, 2.0: 3.419, 3.0: 5.243}


@pytest.mark.parametrize(("frequency", "published"), FIRST.items())
def test_the_margin_under_one_cycle_is_the_published_amplitude(frequency, published):
    pulse = command.one_cycle(1.0, 1.0 / frequency)
    # Standard gravity in place of 9.81 is 0.03 %, straight lines through 200 samples of a cycle 0.01 %.
    factors = published * np.array([0.995, 1.005])
    fell, _ = command._fell([Method1(BLOCK)], pulse, factors, 1.0 / frequency + 8.0)
    assert fell.tolist() == [[False, True]]
    # Factors are tried in steps of 1 %, and restitutions within 5 % of Housner's: the first and the last of the runs
    # lie about the published one.
    found = command.answer(BLOCK, pulse)
    assert found.falls_first_at <= published * 1.01
    assert found.falls_last_at >= published * 0.99


def test_a_restitution_that_is_given_takes_the_place_of_housners():
    given = command.restitutions(BLOCK, 0.8)
    assert given == pytest.approx((0.76, 0.8, 0.84))
    assert command.restitutions(BLOCK, 1.0) == (0.95, 1.0)  # never above 1, and none twice


def test_rocking_starts_at_wests_acceleration():
    # b/h g = 0.25 g.  A slow sine passes it, or not, by a thousandth.
    for peak, rocks in ((0.999, False), (1.001, True)):
        found = command.answer(BLOCK, command.one_cycle(peak * 0.25 * 9.80665, 2.0))
        assert found.rocks is rocks
        assert found.falls == "no"


def test_the_felling_period_is_where_the_closed_amplitude_falls_below_the_peak():
    # A slender block, for which the linear closed forms hold: at the period that fells, the least amplitude (after one
    # impact, or without) is the peak.  Restitutions within 5 % and a grid of 2.5 % leave 4 %.
    slender, peak = Block(b=0.1, h=1.0), 2.0
    period = command.felling_period(slender, peak)
    ratio = 2.0 * math.pi / period / slender.p()
    e = min(1.0, 1.05 * slender.housner_restitution)
    band = one_impact_band(ratio, e)
    least = full_sine_pulse(ratio) if band is None else band.low
    assert least * 9.80665 * slender.alpha == pytest.approx(peak, rel=0.04)


# Between what fells it after an impact and what fells it without one a block may stand (Zhang & Makris 2001).
def test_a_longer_push_that_the_block_stands_is_named_and_a_tilt_beyond_the_balance_is_told(capsys):
    stocky, peak, alpha = Block(b=0.5, h=1.0), 2.0 * 9.80665, math.atan(0.5)
    runs = {}
    for period in (0.43, 0.5, 0.55):
        pulse = command.one_cycle(peak, period)
        motion = PiecewiseLinear(pulse.time_step, pulse.acceleration)
        runs[period] = [
            solve(Method1(stocky, restitution=e), motion, t_end=8.0, solver="numba", save_at=())
            for e in command.restitutions(stocky, None)
        ]
    assert [any(run.overturned for run in some) for some in runs.values()] == [True, False, True]
    command.main(["0.5", "1.0", "--pga", "2g", "--json"])
    facts = json.loads(capsys.readouterr().out)
    [(first, last)] = facts["stands_again"]
    assert 0.42 < facts["felling_period"] < 0.43 < first < 0.5 < last < 0.55
    command.main(["0.5", "1.0", "--pga", "2g"])
    said = capsys.readouterr().out
    assert "the shortest cycle of a sine of this peak that fells it takes 0.43 s\n" in said
    assert "but it stands some longer ones: 0.46 to 0.54 s" in said
    found = command.answer(stocky, command.one_cycle(peak, 0.5))
    assert found.falls == "no"
    assert found.largest_tilt == pytest.approx(max(run.peak_rotation for run in runs[0.5]) / alpha, rel=1e-5)
    assert found.largest_tilt > 1.2


def test_a_push_as_short_as_is_tried_is_no_least_one(capsys):
    # The next shorter ones fell it as well.
    assert command.answer(Block(0.01, 0.1), command.one_cycle(5.0 * 9.80665, 0.03)).runs_that_fall > 0
    command.main(["0.01", "0.1", "--pga", "5g"])
    assert "that fells it takes 0.05 s or less\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "tried"),
    [
        (["2", "1", "--pga", "3g", "--period", "2"], "2 of 2 runs: as it is and mirrored, one restitution)"),
        (
            ["0.3", "1.8", "--pga", "1g", "--period", "1", "--restitution", "1"],
            "4 of 4 runs: as it is and mirrored, two",
        ),
        (["0.3", "1.8", "--pga", "1g", "--period", "1"], "6 of 6 runs: as it is and mirrored, three"),
    ],
)
def test_as_many_restitutions_are_said_as_were_tried(arguments, tried, capsys):
    command.main(arguments)
    assert tried in capsys.readouterr().out


def test_a_block_of_a_few_millimetres_is_watched_to_the_end_of_the_longest_push(monkeypatch):
    # A push that takes hundreds of 1/p fells what it tips, and passes West's acceleration after an eighth of it:
    # 20/p, 0.5 s here, is over by then.
    small = Block(b=0.002, h=0.01)
    monkeypatch.setattr(command, "PERIODS", np.array([0.01, 8.0]))
    assert command.felling_period(small, math.sqrt(2.0) * 0.2 * 9.80665) == 8.0


def test_the_peak_velocity_of_one_cycle_is_peak_times_period_over_pi():
    record = command.one_cycle(3.0, 0.7)
    # v = a T / pi at half of the cycle; a spline through 200 samples.
    assert float(np.max(record.velocity)) == pytest.approx(3.0 * 0.7 / math.pi, rel=1e-5)


@pytest.fixture(scope="module")
def record_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("records") / "made.AT2"
    ex.write(path, ex.KanaiTajimi(rms=1.0, duration=20.0).record(time_step=0.01, seed=1), "peer")
    return path


def test_a_record_scaled_by_its_own_margin_is_at_the_margin(record_file):
    (record,) = ex.read(record_file)
    found = command.answer(BLOCK, record)
    stronger = command.answer(BLOCK, ex.scaled(record, found.falls_first_at * 1.0001))
    weaker = command.answer(BLOCK, ex.scaled(record, found.falls_first_at / 1.02))
    assert stronger.runs_that_fall > 0
    assert stronger.falls_first_at == pytest.approx(1.0, abs=0.001)
    assert weaker.falls == "no" and weaker.largest_tilt < 1.0


def test_the_largest_tilt_is_that_of_another_solver_over_the_angle_of_balance():
    weak = command.one_cycle(0.93 * FIRST[1.0], 1.0)
    found = command.answer(BLOCK, weak)
    tilts = [
        np.max(np.abs(solve(
            Method1(BLOCK, restitution=e), PiecewiseLinear(weak.time_step, sign * weak.acceleration), t_end=5.0,
            solver="scipy", save_at=np.linspace(0.0, 5.0, 5001),
        ).theta))
        for e in command.restitutions(BLOCK, None) for sign in (1.0, -1.0)
    ]  # fmt: skip
    assert 0.05 < found.largest_tilt < 0.95  # it rocks, and does not fall
    # The angle of balance is alpha; a sample each millisecond misses a peak by 1e-5 of it at the most.
    assert found.largest_tilt == pytest.approx(max(tilts) / math.atan(0.25), rel=1e-4)


def test_the_answer_in_words_and_as_json_says_the_same(record_file, capsys):
    command.main(["0.2", "0.8", "--record", str(record_file)])
    words = capsys.readouterr().out
    command.main(["0.2", "0.8", "--record", str(record_file), "--json"])
    facts = json.loads(capsys.readouterr().out)
    assert [line.split()[0] for line in words.splitlines()] == ["block", "motion", "rocks", "falls", "margin"]
    assert f"first falls at {facts['falls_first_at']:.2f} times" in words
    assert f"falls    {facts['falls']} ({facts['runs_that_fall']} of {facts['runs']} runs" in words


def test_a_peak_alone_is_answered_with_the_period_that_fells(capsys):
    command.main(["0.30", "1.80", "--pga", "0.3g", "--json"])
    facts = json.loads(capsys.readouterr().out)
    assert facts["peak"] == pytest.approx(0.3 * 9.80665)
    assert facts["felling_period"] == command.felling_period(Block(0.30, 1.80), 0.3 * 9.80665)
    command.main(["0.30", "1.80", "--pga", "1.0"])
    assert "rocks    no: 1 m/s^2 is 0.61 times" in capsys.readouterr().out


def test_period_and_velocity_say_the_same(capsys):
    answers = []
    for given in (["--period", "0.9"], ["--pgv", str(2.5 * 0.9 / math.pi)]):
        command.main(["0.2", "0.8", "--pga", "2.5", *given, "--json"])
        answers.append(json.loads(capsys.readouterr().out)["falls_first_at"])
    assert answers[0] == pytest.approx(answers[1], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["0", "1", "--pga", "3"], "b=0.0 m: want a positive number"),
        (["0.2", "0.8", "--pga", "3", "--period", "-1"], "--period -1.0: want a positive number"),
        (["0.2", "0.8", "--pga", "3", "--period", "1", "--pgv", "1"], "want one of them"),
        (["0.2", "0.8", "--pga", "3", "--component", "H1"], "--component H1: want it with --record, not with --pga"),
        (["0.2", "0.8", "--pga", "3", "--units", "g"], "--units g: want it with --record, not with --pga"),
        (["0.2", "0.8", "--record", "nothing.AT2"], "nothing.AT2: want a file that can be read"),
        (["0.2", "0.8", "--record", "x", "--pgv", "1"], "want it with --pga"),
        (["0.2", "0.8", "--pga", "3", "--restitution", "1.5"], "restitution=1.5"),
    ],
)
def test_bad_input_is_one_sentence(arguments, sentence):
    with pytest.raises(BadInputError, match=sentence):
        command.main(arguments)


@pytest.mark.parametrize("more", [[], ["--period", "1"]])
def test_a_run_that_fails_is_no_block_that_stands(more, monkeypatch, capsys):
    real = command.solve_batch

    def failing(*args, **kwargs):
        result = real(*args, **kwargs)
        return replace(result, outcome=np.where(np.arange(len(result)) == 0, 3, 1))

    monkeypatch.setattr(command, "solve_batch", failing)
    with pytest.raises(
        BadInputError, match=r"^1 of \d+ runs failed before they told whether the block falls; want none"
    ):
        command.main(["0.2", "0.8", "--pga", "3", *more])
    assert not capsys.readouterr().out


def test_a_block_that_lands_on_both_corners_is_answered(capsys):
    # b/h = 2 is above sqrt(2), where Housner's restitution is below zero: the block stops at its first impact.
    command.main(["2", "1", "--pga", "30", "--period", "1", "--json"])
    assert json.loads(capsys.readouterr().out)["falls_first_at"] > 1.0


def test_an_unknown_component_is_answered_with_those_there_are(record_file):
    with pytest.raises(BadInputError, match="want component 'Z9'"):
        command.main(["0.2", "0.8", "--record", str(record_file), "--component", "Z9"])


def test_the_command_exits_with_2_and_a_sentence_and_its_help_names_every_option():
    bad = subprocess.run(
        [sys.executable, "-m", "studies.will_it_fall", "0.2", "0.8", "--pga", "fast"], capture_output=True
    )
    assert bad.returncode == 2
    assert b"'fast': want a number [m/s^2], or one with g as in 0.3g" in bad.stderr
    assert b"Traceback" not in bad.stderr
    help_text = subprocess.run([sys.executable, "-m", "studies.will_it_fall", "--help"], capture_output=True, text=True)
    for option in ("--pga", "--record", "--period", "--pgv", "--component", "--units", "--restitution", "--json"):
        assert option in help_text.stdout


def test_python_m_rocking_names_the_commands():
    done = subprocess.run([sys.executable, "-m", "rocking"], capture_output=True, text=True)
    assert done.returncode == 0
    assert "python -m studies.will_it_fall" in done.stdout
    asked = subprocess.run([sys.executable, "-m", "rocking", "0.3"], capture_output=True, text=True)
    assert asked.returncode == 2
    assert "want no argument here" in asked.stderr


def test_a_restitution_that_cannot_be_is_refused_below_what_starts_rocking_too():
    with pytest.raises(BadInputError, match=r"restitution=7.0: want 0 to 1"):
        command.main(["0.3", "1.8", "--pga", "0.1g", "--restitution", "7"])
