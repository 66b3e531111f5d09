"""The tables of bad input at every public entry: each case ends in one sentence with thing, value and what was wanted.

Functions   `bad_arguments`: every argument of every entry, by its kind
Commands    `bad_commands`: in this process; besides, exit status 2, nothing on the disk
Files       `bad_files`: TOML, CSV, records and NetCDF, damaged or foreign
Legal, odd  what looks wrong and is not has its right answer here
"""

import contextlib
import math
import re

import numpy as np
import pytest
from bad_arguments import cases
from bad_commands import COMMANDS, MAINS, Places
from bad_files import FILES, READERS
from entries import BLOCK, ENTRIES

import dem
import excitation as ex
from excitation.formats import seismology
from rocking import Block, Method1, solve
from rocking.closed_forms import west_acceleration

LONGEST = 700  # characters of a sentence

ARGUMENTS = list(cases())


def shown(value):
    """How a case is called."""
    text = repr(value)
    return text if len(text) < 30 else f"{text[:20]}...{len(text)}"


def check_sentence(sentence, *words):
    """It is one, can be printed, and has the words."""
    assert sentence and "\n" not in sentence and len(sentence) < LONGEST and sentence.isprintable(), sentence
    for word in words:
        assert re.search(word, sentence), (word, sentence)


def test_there_are_many_cases():
    """In all, without those of other folders (tests/rocking/test_bad_input.py, tests/studies/campaigns ...)."""
    assert len(ARGUMENTS) >= 1500 and len(COMMANDS) >= 60 and len(FILES) >= 60
    assert {entry for entry, _, _ in ARGUMENTS} == set(ENTRIES)


@pytest.fixture(autouse=True)
def _without_obspy(monkeypatch):
    """Its readers take a process and seconds for each file that nobody else knows, and are not ours."""
    monkeypatch.setattr(seismology, "available", lambda: False)


@pytest.mark.parametrize("entry", sorted(set(ENTRIES) - {"dem.simulate_assembly"}))
def test_good_arguments_are_taken(entry):
    """But of assemblies, whose loop takes a minute to compile and which tests/dem has run."""
    make, good = ENTRIES[entry]
    assert make(**good) is not None


@pytest.mark.parametrize("entry", ENTRIES)
def test_a_bad_argument_is_one_sentence_with_its_name_and_what_was_wanted(entry):
    make, good = ENTRIES[entry]
    for name, argument, value in ARGUMENTS:
        if name != entry:
            continue
        with pytest.raises(ValueError) as caught:
            make(**{**good, argument: value})
        check_sentence(str(caught.value), argument, "want|in one dimension|not on the equal|is missed")


@pytest.mark.parametrize("case", FILES)
def test_a_damaged_or_foreign_file_is_one_sentence_that_names_it(case, tmp_path):
    reader, make, *words = FILES[case]
    path = make(tmp_path)
    with pytest.raises(ValueError) as caught:
        READERS[reader](path)
    check_sentence(str(caught.value), *words)


@pytest.mark.parametrize("case", COMMANDS)
def test_a_command_that_cannot_do_it_says_so_and_writes_nothing(case, tmp_path, capsys, monkeypatch):
    command, arguments, *words = COMMANDS[case]
    places = Places(tmp_path)
    monkeypatch.chdir(places.empty)
    before = places.everything()
    argv = [places.filled(argument) for argument in arguments]
    status, said = MAINS[command](argv, capsys)
    assert status == 2, said
    assert "Traceback" not in said
    check_sentence(said.strip().splitlines()[-1], *words)
    assert places.everything() == before


# What is odd and legal.


def test_a_slab_and_a_needle_rock_where_theory_says():
    """West's formula holds for any breadth over height; b/h of 1e6 and 1e-6."""
    for b, h in ((1e3, 1e-3), (1e-3, 1e3)):
        assert west_acceleration(b, h) == pytest.approx(b / h * 9.80665, rel=1e-15)
        block = Block(b, h)
        assert block.alpha == pytest.approx(math.atan2(b, h), rel=1e-15)
        assert block.mass == pytest.approx(597.0 * b * h, rel=1e-15)


def test_a_block_as_large_as_the_moon_falls_no_faster_than_its_size_allows():
    """p = sqrt(3 g / (4 R)): a release from 0.1 rad takes acosh(1/(1 - 0.1/alpha))/p to the first impact, about."""
    block = Block(1e5, 4e5)
    run = solve(Method1(block, form="linear"), theta=0.1, t_end=2000.0)
    expected = math.acosh(1.0 / (1.0 - 0.1 / block.alpha)) / block.p()
    assert run.events.t[0] == pytest.approx(expected, rel=1e-6)


def test_whole_numbers_of_numpy_and_booleans_count_as_numbers():
    assert Block(np.float32(0.5), np.int64(1)).alpha == pytest.approx(math.atan2(0.5, 1.0))
    assert dem.rectangle(1, np.float64(2.0)).area == pytest.approx(2.0)
    assert ex.SteadySinusoid(np.float32(2.0), 1, 5).frequency == 2.0


def test_friction_without_limit_is_a_friction():
    assert dem.Contact(math.inf, damping=0.0).mu == math.inf


def test_an_acceleration_of_zero_mean_is_no_reason_to_refuse_a_record():
    record = ex.Record(1e4, np.array([0.0, 1e-300]))
    assert record.duration == 1e4


def test_the_same_file_twice_has_not_moved(tmp_path, capsys):
    from files import dataset

    from studies.compare import main

    dataset().to_netcdf(tmp_path / "a.nc")
    with contextlib.suppress(SystemExit):
        main([str(tmp_path / "a.nc")] * 2)
    assert "none moved" in capsys.readouterr().out


def test_the_block_of_the_tables_is_a_good_one():
    assert Method1(BLOCK).e == pytest.approx(1.0 - 1.5 * math.sin(BLOCK.alpha) ** 2)
