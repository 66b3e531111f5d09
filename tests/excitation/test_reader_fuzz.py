"""Every reader against damaged files: a right answer or a RecordFileError, never anything else.

A damaged file that is read nevertheless must be consistent: finite samples, as many as some number in its own text.
"""

import random
import sys
import tracemalloc

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import excitation as ex

from .synthetic_files import (
    cosmos_channel,
    csmip1_channel,
    csmip1_even_channel,
    csmip2_channel,
    dyna_text,
    knet_text,
    nsmn_text,
    peer_text,
    smc_text,
)

A = np.round(3.0 * np.sin(0.7 * np.arange(61)) * np.hanning(61), 6)
FILES = {
    "peer": peer_text(A, 0.005),
    "knet": knet_text(A),
    "dyna": dyna_text(A, 0.005),
    "smc": smc_text(A, 0.005),
    "csmip 1": "\n".join(csmip1_channel(A, 0.02 * np.arange(61))),
    "csmip 1, even": "\n".join(csmip1_even_channel(A, 200)),
    "nsmn": nsmn_text([A, 0.5 * A[::-1], 0.1 * A], 0.005),
    "csmip 2": "\n".join(csmip2_channel(A, 0.02)),
    "cosmos": "\n".join(cosmos_channel(A, 0.005)),
    "columns": "\n".join(["time [s],a_x [g]", *(f"{0.01 * i:.2f},{v}" for i, v in enumerate(A))]),
}
WHOLE = {"size": 61, "peak": float(np.max(np.abs(A)))}
several = settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])


def outcome(folder, data):
    """Records, or None where the file was refused with a sentence that names it."""
    path = folder / "damaged.dat"
    path.write_bytes(data)
    try:
        records = ex.read(path)
    except ex.RecordFileError as error:
        message = str(error)
        assert message.startswith("damaged.dat") and "\n" not in message and len(message) < 400
        return None
    for record in records:
        assert record.acceleration.size >= 2 and np.all(np.isfinite(record.acceleration))
        assert np.isfinite(record.time_step) and record.time_step > 0.0
    return records


@pytest.fixture(scope="module", autouse=True)
def _without_obspy():
    """obspy has its own readers of its own formats; what is tried here are ours."""
    from excitation.formats import seismology

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(seismology, "available", lambda: False)
        yield


@pytest.mark.parametrize("name", FILES)
def test_the_whole_file_is_read(tmp_path, name):
    record = outcome(tmp_path, FILES[name].encode())[0]
    assert record.acceleration.size == WHOLE["size"]


@pytest.mark.parametrize("name", FILES)
def test_a_file_cut_anywhere_is_refused(tmp_path, name):
    """Cutting loses samples, and every format but plain columns says how many there should be."""
    data = FILES[name].encode()
    for cut in range(0, len(data), 13):
        records = outcome(tmp_path, data[:cut])
        if records is None:
            continue
        if name == "columns":
            assert records[0].acceleration.size <= WHOLE["size"]
        else:
            # Only blanks, the end of the last number or the closing line can be missing.
            assert records[0].acceleration.size == WHOLE["size"] and len(data) - cut < 80


@pytest.mark.parametrize("name", FILES)
@several
@given(seed=st.integers(0, 2**32), share=st.sampled_from([0.0005, 0.003, 0.05, 0.5]))
def test_bytes_changed_at_random_never_surprise(tmp_path, name, seed, share):
    rng = random.Random(seed)
    data = bytearray(FILES[name].encode())
    for i in range(len(data)):
        if rng.random() < share:
            data[i] = rng.randrange(256)
    outcome(tmp_path, bytes(data))


@pytest.mark.parametrize("name", FILES)
@several
@given(seed=st.integers(0, 2**32), count=st.integers(1, 12))
def test_characters_changed_to_likely_ones_never_surprise(tmp_path, name, seed, count):
    """Digits, signs and points where others stood: what a scanner or a hand does to a file."""
    rng = random.Random(seed)
    text = list(FILES[name])
    for _ in range(count):
        text[rng.randrange(len(text))] = rng.choice("0123456789.-+eEdD |:,=()\n_\u00a0é")
    outcome(tmp_path, "".join(text).encode())


@pytest.mark.parametrize("name", FILES)
def test_lines_lost_doubled_or_swapped_never_surprise(tmp_path, name):
    lines = FILES[name].split("\n")
    for i in range(len(lines)):
        outcome(tmp_path, "\n".join(lines[:i] + lines[i + 1 :]).encode())
        outcome(tmp_path, "\n".join([*lines[:i], lines[i], *lines[i:]]).encode())
        outcome(tmp_path, "\n".join([*lines[:i], lines[-1 - i], *lines[i + 1 :]]).encode())


@pytest.mark.parametrize("name", [n for n in FILES if n != "columns"])
def test_a_lost_line_of_samples_is_noticed(tmp_path, name):
    lines = FILES[name].split("\n")
    last = len(lines) - (12 if name == "csmip 2" else 5)
    assert outcome(tmp_path, "\n".join(lines[:last] + lines[last + 1 :]).encode()) is None


@pytest.mark.parametrize("encoding", ["utf-16", "utf-32", "cp500"])
@pytest.mark.parametrize("name", FILES)
def test_a_wrong_encoding_is_refused(tmp_path, name, encoding):
    assert outcome(tmp_path, FILES[name].encode(encoding)) is None


@pytest.mark.parametrize(
    "data", [b"", b"\n", b" " * 1000, b"\x00" * 1000, b"\xff\xfe", b"\x1a", b"1 2\n", b"nan nan\nnan nan"]
)
def test_nothing_much_is_refused(tmp_path, data):
    assert outcome(tmp_path, data) is None


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.one_of(st.binary(max_size=400), st.text(max_size=400).map(str.encode)))
def test_anything_else_is_refused_or_read(tmp_path, data):
    outcome(tmp_path, data)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("peer", "=   61", "=   999999999999"),
        ("knet", "Duration Time(s)  0.61", "Duration Time(s)  99999999999"),
        ("dyna", "NDATA: 61", "NDATA: 999999999999"),
        ("smc", "        61", "2000000000"),
        ("csmip 2", "61 POINTS OF ACCEL", "999999999999 POINTS OF ACCEL"),
        ("csmip 1", "   61", "99999"),
        ("csmip 1, even", "61 Accel", "999999999999 Accel"),
        ("nsmn", "NUMBER OF DATA   : 61", "NUMBER OF DATA   : 999999999999"),
        ("cosmos", "61 acceleration pts", "999999999999 acceleration pts"),
        ("cosmos", " 100 Real-header", " 999999 Real-header"),
        ("cosmos", "   2 Comment", " 999999 Comment"),
    ],
)
def test_absurd_counts_take_no_memory(tmp_path, name, old, new):
    assert old in FILES[name]
    tracemalloc.start()
    try:
        assert outcome(tmp_path, FILES[name].replace(old, new, 1).encode()) is None
        assert tracemalloc.get_traced_memory()[1] < 5e6
    finally:
        tracemalloc.stop()


def test_a_file_larger_than_any_record_is_refused_unread(tmp_path):
    path = tmp_path / "huge.AT2"
    with path.open("wb") as file:
        file.truncate(2**40)  # takes no room on disk
    with pytest.raises(ex.RecordFileError, match=r"huge\.AT2: has 1099511627776 bytes, want at most"):
        ex.read(path)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("peer", "0.0050", "1e-300"),
        ("peer", "0.0050", "1e300"),
        ("dyna", "L_S: 0.005000", "L_S: 1e9"),
        ("knet", "100Hz", "0.000001Hz"),
        ("columns", "0.01,", "1e300,"),
        ("columns", "0.60,", "1.7e308,"),
        ("knet", "100Hz", f"0.{'0' * 320}1Hz"),
        ("knet", "(gal)/8223790", f"(gal)/0.{'0' * 320}1"),
        ("smc", "  2.0000000E+02", " 2.0000000E-310"),
        ("cosmos", "-999.00", "-999..0"),
        ("cosmos", "Format=(8F10.5)", f"Format=({'9' * 5000}F10.5)"),
    ],
)
def test_a_number_that_no_header_holds_is_refused(tmp_path, name, old, new):
    assert old in FILES[name]
    assert outcome(tmp_path, FILES[name].replace(old, new, 1).encode()) is None


def test_a_zero_with_any_exponent_is_zero(tmp_path):
    (record,) = outcome(tmp_path, FILES["columns"].replace("0.00,", "0e400,", 1).encode())
    assert record.time_step == pytest.approx(0.01)


@pytest.mark.parametrize("name", [n for n in FILES if n != "knet"])
def test_a_sample_of_no_motion_is_refused(tmp_path, name):
    """A number that overflows once it is squared, where some sample stood: found by the fuzz."""
    lines = FILES[name].split("\n")
    last = next(i for i, line in enumerate(lines) if "OF ACCEL" in line) + 2 if name == "csmip 2" else len(lines) - 5
    width = max(10, len(lines[last]) - len(lines[last].lstrip()))
    lines[last] = "1e300".rjust(width) + lines[last][width:]
    assert outcome(tmp_path, "\n".join(lines).encode()) is None


@pytest.mark.parametrize("name", FILES)
def test_padding_of_old_systems_is_no_damage(tmp_path, name):
    """The character 26 to the end of the block, before or after the last line end; in the middle it is damage, said in
    a short line: found by the fuzz."""
    data = FILES[name].encode()
    for padding in (b"\x1a", b"\x1a" * 100, b"\n" + b"\x1a" * 3, b"\x1a\r\n\r\n\x1a"):
        assert outcome(tmp_path, data + padding)[0].acceleration.size == WHOLE["size"]
    lines = data.split(b"\n")
    middle = b"\n".join([*lines[: len(lines) // 2], b"\x1a" * 200, *lines[len(lines) // 2 :]])
    assert outcome(tmp_path, middle) is None


@pytest.mark.parametrize("name", FILES)
def test_long_lines_take_no_time(tmp_path, name):
    """Fifty thousand characters where a header line stood, or behind one: a pattern that goes back over them takes 5 to
    15 s for one such line (one number or blanks and a word), minutes for each of these files.  Found by the fuzz, with
    so many digits."""
    lines = FILES[name].split("\n")
    fillings = ("9", " ", "(", "a ", "EARTHQUAKE ", "time series units of", '" [', "1:")
    for k, filling in enumerate(fillings):
        monster = (filling * 50_000)[:50_000]
        for i in range(k % 4, min(len(lines), 50), 4):
            outcome(tmp_path, "\n".join([*lines[:i], monster, *lines[i + 1 :]]).encode())
            outcome(tmp_path, "\n".join([*lines[:i], lines[i] + monster, *lines[i + 1 :]]).encode())


def test_what_does_not_show_is_cut_short_in_messages(tmp_path):
    """A long unit of characters that are shown as escapes: found by a coverage-guided fuzz."""
    assert outcome(tmp_path, b"time [s],a [" + b"\x9a" * 120 + b"g]\n0.00,0.0\n0.03,0.0\n") is None
    assert outcome(tmp_path, b"\x9b" * 200 + b"\n1 2\n") is None


def test_one_line_of_a_million_characters_is_refused(tmp_path):
    assert outcome(tmp_path, b"Origin Time" + b"9" * 1_000_000) is None
    assert outcome(tmp_path, b"1" * 1_000_000 + b" 2\n1 2") is None


@pytest.mark.parametrize("format", ["MSEED", "SAC", "GSE2"])
def test_damaged_files_of_obspy_end_in_a_sentence_too(tmp_path, format, monkeypatch):
    obspy = pytest.importorskip("obspy")
    from excitation.formats import seismology

    monkeypatch.setattr(seismology, "available", lambda: True)
    values = (1000 * A).astype(np.int32 if format == "GSE2" else np.float32)
    obspy.Trace(values, {"delta": 0.01, "station": "ABC", "channel": "HNZ"}).write(
        str(tmp_path / "whole"), format=format
    )
    data = (tmp_path / "whole").read_bytes()
    (record,) = ex.read(tmp_path / "whole", units="mm/s^2")
    assert record.acceleration == pytest.approx(np.asarray(values) / 1000, rel=1e-6)
    rng = random.Random(1)
    changed = bytes(rng.randrange(256) if rng.random() < 0.05 else byte for byte in data)
    for damaged in (data[: len(data) // 2], changed):
        (tmp_path / "damaged").write_bytes(damaged)
        try:
            records = ex.read(tmp_path / "damaged", units="mm/s^2")
        except ex.RecordFileError as error:
            assert str(error).startswith("damaged")
        else:
            assert all(np.all(np.isfinite(r.acceleration)) for r in records)


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "made obspy's reader crash"),
        ("import time; time.sleep(60)", "obspy was not done with it after 0.5 s"),
        ("raise MemoryError", "nor in one that obspy reads"),
    ],
)
def test_a_crash_of_obspys_compiled_readers_does_not_crash_us(tmp_path, code, message, monkeypatch):
    from excitation.formats import seismology

    monkeypatch.setattr(seismology, "available", lambda: True)
    monkeypatch.setattr(seismology, "COMMAND", (sys.executable, "-c", code))
    monkeypatch.setattr(seismology, "TIME_LIMIT", 0.5 if "sleep" in code else 60.0)
    (tmp_path / "x.bin").write_bytes(b"\x00\x01")
    with pytest.raises(ex.RecordFileError, match=rf"x\.bin: .*{message}"):
        ex.read(tmp_path / "x.bin", units="g")
