"""Readers against small files in each format that are written here, by other code than the package's."""

import numpy as np
import pytest

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
    rows,
    smc_text,
)

G = 9.80665
N = 123


@pytest.fixture(scope="module")
def samples():
    """Acceleration [m/s^2] with a peak below 1 g."""
    t = np.arange(N) / N
    return np.round(5.0 * np.sin(2 * np.pi * 7 * t) * np.sin(np.pi * t) + 0.3 * np.cos(40 * t), 6)


def one(tmp_path, text, name="record.txt", **arguments):
    path = tmp_path / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    (record,) = ex.read(path, **arguments)
    return record


@pytest.mark.parametrize("old", [False, True])
def test_peer_record_is_in_g(tmp_path, samples, old):
    record = one(tmp_path, peer_text(samples, 0.005, old))
    # Seven digits of the largest value.
    assert record.acceleration == pytest.approx(samples, abs=1e-6)
    assert (record.time_step, record.azimuth_deg, record.component) == (0.005, 67.0, "67")
    assert record.event == "Somewhere, 1/2/2003, A Place"


def test_knet_counts_become_gal_and_the_start_is_in_utc_without_the_delay(tmp_path, samples):
    record = one(tmp_path, knet_text(samples))
    count = 7845.0 / 8223790 / 100
    # Counts are whole: half of one; the offset of 1000 counts stays in.
    assert record.acceleration == pytest.approx(samples + 1000 * count, abs=0.51 * count)
    # 23:50:00 in Japan is 14:50:00 UTC; NIED's Record Time lags the first sample by 15 s.
    assert record.start_time == "2014-12-31T14:49:45"
    assert (record.time_step, record.azimuth_deg, record.vertical, record.station) == (0.01, 0.0, False, "XYZ002")


@pytest.mark.parametrize(
    ("code", "component", "place"),
    [("1", "N-S", "borehole"), ("5", "E-W", "surface"), ("6", "U-D", "surface"), ("E-W", "E-W", "surface")],
)
def test_kiknet_directions_say_component_and_depth(tmp_path, samples, code, component, place):
    record = one(tmp_path, knet_text(samples, direction=code))
    assert (record.component, record.metadata["sensor at"]) == (component, place)
    assert record.vertical == (component == "U-D")


def test_knet_agrees_with_obspy(tmp_path, samples):
    obspy = pytest.importorskip("obspy")
    path = tmp_path / "ABC.NS"
    path.write_text(knet_text(samples))
    (record,) = ex.read(path)
    trace = obspy.read(path, format="KNET", apply_calib=True)[0]
    assert record.acceleration == pytest.approx(trace.data, rel=1e-12)
    assert record.start_time == trace.stats.starttime.datetime.isoformat()


@pytest.mark.parametrize("first", ["20190728_160919.870", "28/07/2019 16:09:19.870"])
def test_dyna_of_esm_and_of_afad(tmp_path, samples, first):
    record = one(tmp_path, dyna_text(samples, 0.005, first=first))
    assert record.acceleration == pytest.approx(samples, abs=1e-8)
    assert (record.time_step, record.station, record.azimuth_deg) == (0.005, "XX.ABC", 90.0)
    assert record.start_time == "2019-07-28T16:09:19.870000"


@pytest.mark.parametrize("per_line", [8, 5])
def test_smc_columns_touch_each_other(tmp_path, samples, per_line):
    record = one(tmp_path, smc_text(samples, 0.005, per_line=per_line))
    # Five or eight digits of up to 500 cm/s^2.
    assert record.acceleration == pytest.approx(samples, abs=6e-4 if per_line == 8 else 6e-7)
    assert (record.azimuth_deg, record.time_step, record.vertical) == (0.0, 0.005, False)
    assert record.station == "A Place, F"


def test_smc_vertical_points_up(tmp_path, samples):
    up = one(tmp_path, smc_text(samples, 0.005, azimuth=-32768, vertical=0))
    down = one(tmp_path, smc_text(samples, 0.005, azimuth=-32768, vertical=180))
    assert up.vertical and down.vertical
    assert down.acceleration == pytest.approx(-up.acceleration)


def test_csmip_volume_2_has_every_channel(tmp_path, samples):
    path = tmp_path / "record.V2"
    lines = csmip2_channel(samples, 0.02) + csmip2_channel(0.5 * samples[:-1], 0.02, 2, "UP")
    path.write_text("\r\n".join([*lines, "", ""]))
    first, second = ex.read(path)
    # Three decimals of cm/s^2.
    assert first.acceleration == pytest.approx(samples, abs=5.1e-6)
    assert second.acceleration == pytest.approx(0.5 * samples[:-1], abs=5.1e-6)
    assert (first.azimuth_deg, first.vertical, second.vertical) == (90.0, False, True)
    assert (first.time_step, first.station, first.event) == (0.02, "36456", "SOMEWHERE EARTHQUAKE")


def test_csmip_volume_2_states_one_step_twice(tmp_path, samples):
    """The real is printed to a thousandth of a second: it may be off by half of that, and by no more."""
    text = "\n".join(csmip2_channel(samples, 0.005))
    assert one(tmp_path, text.replace("AT  0.005 SEC", "AT  .00488 SEC")).time_step == 0.00488
    for step in (".006", ".004", ".0056", ".0044"):
        with pytest.raises(ex.RecordFileError, match=f"line 40: .* want 0{step} as real 61, the step of line 46"):
            one(tmp_path, text.replace("AT  0.005 SEC", f"AT  {step} SEC"))


def test_csmip_volume_1_is_pairs_in_tenths_of_g(tmp_path, samples):
    path = tmp_path / "record.V1"
    t = 0.02 * np.arange(N)
    path.write_text("\n".join(csmip1_channel(samples, t) + csmip1_channel(samples, t, 2, "180 DEG")))
    first, second = ex.read(path)
    # Three decimals of g/10, which is 0.98 m/s^2.
    assert first.acceleration == pytest.approx(samples, abs=0.00051 * G / 10)
    assert (first.time_step, first.vertical, second.azimuth_deg) == (pytest.approx(0.02), True, 180.0)
    assert "processing" not in first.metadata


def test_csmip_volume_1_unequal_steps_are_laid_on_equal_ones_and_said(tmp_path, samples):
    t = np.round(np.cumsum(np.random.default_rng(1).uniform(0.01, 0.03, N)), 3)
    record = one(tmp_path, "\n".join(csmip1_channel(samples, t)))
    even = np.linspace(t[0], t[-1], N)
    assert record.acceleration == pytest.approx(np.interp(even, t, samples), abs=0.00051 * G / 10)
    assert "unequally spaced" in record.metadata["processing"]


def test_csmip_volume_1_with_equally_spaced_samples(tmp_path, samples):
    lines = csmip1_channel(samples, 0.02 * np.arange(N))
    data = [f" {N} POINTS OF ACCEL DATA EQUALLY SPACED AT  .010 SEC, IN G. (8F9.5)"]
    data += rows([f"{v / G:9.5f}" for v in samples], 8)
    record = one(tmp_path, "\n".join([*lines[:27], *data, lines[-1]]))
    assert record.acceleration == pytest.approx(samples, abs=5.1e-6 * G)
    assert record.time_step == 0.01


def test_csmip_volume_1_of_a_digital_recorder(tmp_path, samples):
    path = tmp_path / "record.V1"
    path.write_text("\n".join(csmip1_even_channel(samples, 200) + csmip1_even_channel(samples, 200, 2, "Up")))
    first, second = ex.read(path)
    # Six decimals of g.
    assert first.acceleration == pytest.approx(samples, abs=5.1e-7 * G)
    assert (first.time_step, first.azimuth_deg, first.station) == (0.005, 0.0, "ABC")
    assert (first.start_time, first.event) == ("2012-02-13T21:06:05", "Mon Feb 13, 2012 13:06:45.0 PST")
    assert second.vertical


@pytest.mark.parametrize("between", ["   : ", "\t:\t"])
@pytest.mark.parametrize("columns", [("N-S", "E-W", "U-D"), ("U-D", "N-S", "E-W")])
def test_nsmn_has_three_components_in_the_order_of_its_columns(tmp_path, samples, columns, between):
    components = [samples, -0.5 * samples, 0.1 * samples]
    path = tmp_path / "record.txt"
    path.write_bytes(nsmn_text(components, 0.01, columns, between).replace("A PLACE", "KüTAHYA").encode("latin-1"))
    records = ex.read(path)
    azimuths = {"N-S": 0.0, "E-W": 90.0, "U-D": None}
    for record, name, expected in zip(records, columns, components, strict=True):
        # Six decimals of a gal.
        assert record.acceleration == pytest.approx(expected, abs=5.1e-9)
        assert (record.component, record.azimuth_deg, record.vertical) == (name, azimuths[name], name == "U-D")
        assert (record.time_step, record.start_time) == (0.01, "2017-07-20T22:31:14")
        assert (record.station, record.event, record.file_units) == ("4304", "2017/07/20 22:31:09 (GMT)", "gal")
        assert record.metadata["PLACE"] == "KüTAHYA"


@pytest.mark.parametrize(
    ("name", "azimuth", "vertical", "sign"),
    [
        ("N65E", 65.0, False, 1.0), ("S65E", 115.0, False, 1.0), ("S65W", 245.0, False, 1.0),
        ("N65W", 295.0, False, 1.0), ("S00E", 180.0, False, 1.0), ("N95E", None, False, 1.0), ("090", 90.0, False, 1.0),
        ("360", 0.0, False, 1.0), ("361", None, False, 1.0), ("W", 270.0, False, 1.0), ("DWN", None, True, -1.0),
        ("Down", None, True, -1.0), ("UP", None, True, 1.0), ("a_z", None, True, 1.0), ("L", None, False, 1.0),
    ],
)  # fmt: skip
def test_names_of_directions(name, azimuth, vertical, sign):
    """Quadrants by their definition: from the first letter's axis so many degrees toward the last's."""
    from excitation.formats.directions import direction_of

    assert direction_of(name)[1:] == (azimuth, vertical, sign)


@pytest.mark.parametrize("name", ["DWN", "DOWN"])
def test_what_points_down_is_turned_over(tmp_path, samples, name):
    peer = change(peer_text(samples, 0.005), "A Place, 67", f"A Place, {name}")
    csmip = "\n".join(csmip1_even_channel(samples, 200, 1, name))
    columns = "\n".join([f"t [s],{name} [m/s^2]", *(f"{0.01 * i:.2f},{v}" for i, v in enumerate(samples))])
    for text in (peer, csmip, columns):
        record = one(tmp_path, text)
        assert record.acceleration == pytest.approx(-samples, abs=1e-5)
        assert record.vertical and record.component == "UP"


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("Start time:  2/13/12, 21:06:45.0 UTC (GPS)", "2012-02-13T21:06:45"),
        ("TRIGGER TIME: 01/17/94, 12:31:04.1 UTC", "1994-01-17T12:31:04.100000"),
        ("TRIGGER TIME: 05/02/83, 16:42:48.2 PDT", ""),
        ("Rcrd start time: 8/29/2018, 02:33:  .0 UTC (Q=5) RcrdId:", "2018-08-29T02:33:00"),
        ("Rcrd start time:06/16/2005, 20:53:04.400 UTC (Q=2)", "2005-06-16T20:53:04.400000"),
        ("Rcrd start time: 2018/11/30 17:29:60.0 UTC", "2018-11-30T17:30:00"),
        ("Start time:  7/06/19, 03:16: 8.0 UTC", "2019-07-06T03:16:08"),
    ],
)
def test_start_times_as_headers_have_them(written, expected):
    from excitation.formats.clock import start_time
    from excitation.formats.text import text_file

    assert start_time(text_file("x", f"a line\n{written}\n".encode()), 0, 9) == expected


def test_cosmos_volume_1_as_california_writes_it(tmp_path, samples):
    """Unit `g.` with blanks before its code, `Rcrd` for `Record`, other words at the end, blanks behind the rows."""
    lines = cosmos_channel(samples / G / 100, 0.005, azimuth=360)
    at = next(i for i, line in enumerate(lines) if " pts, approx" in line)
    lines[at] = f"   {N} acceleration pts, approx   0 secs, units=g.     (02)Format=(8f10.5)   "
    text = "\n".join(line.ljust(80) for line in lines).replace("Record of", "Rcrd of")
    text = text.replace("End-of-data for Chan", "/& --- End of data for channel").replace("cm/sec2 at", "g       at")
    record = one(tmp_path, text.replace("2018/11/30 17:29:39.137", "8/29/2018, 02:33:  .0"))
    # Five decimals of g.
    assert record.acceleration == pytest.approx(samples, abs=5.1e-6 * G)
    assert (record.azimuth_deg, record.event) == (0.0, "Somewhere Earthquake of 2018")
    assert record.start_time == "2018-08-29T02:33:00"


@pytest.mark.parametrize("layout", ["(8F10.5)", "(1E15.6)"])
def test_cosmos_layouts(tmp_path, samples, layout):
    record = one(tmp_path, "\n".join(cosmos_channel(samples, 0.005, layout=layout)))
    # Five decimals, or seven digits, of cm/s^2.
    assert record.acceleration == pytest.approx(samples, abs=5.1e-7)
    assert (record.azimuth_deg, record.time_step, record.station) == (90.0, 0.005, "AK-ABC")
    assert record.start_time == "2018-11-30T17:29:39.137000"


def test_cosmos_keeps_acceleration_and_leaves_velocity(tmp_path, samples):
    lines = cosmos_channel(samples, 0.005) + cosmos_channel(samples, 0.005, kind="velocity", unit="cm/sec(05)")
    lines += cosmos_channel(0.5 * samples, 0.005, azimuth=401)
    path = tmp_path / "record.V2c"
    path.write_text("\n".join(lines))
    first, second = ex.read(path)
    assert (first.vertical, second.vertical) == (False, True)
    assert second.acceleration == pytest.approx(-0.5 * samples, abs=5.1e-7)


def test_cosmos_direction_from_the_channel_code_where_the_azimuth_is_unknown(tmp_path, samples):
    record = one(tmp_path, "\n".join(cosmos_channel(samples, 0.005, azimuth=0, scnl="ABC.BNZ.AK.-- <AUTH> 2019")))
    assert (record.component, record.vertical, record.azimuth_deg) == ("BNZ", True, None)


@pytest.mark.parametrize("separator", [",", ";", "\t", "  ", " , "])
def test_columns_with_units_in_the_heading(tmp_path, samples, separator):
    body = [separator.join([f"{0.01 * i:.3f}", f"{v / G:.9f}", f"{100 * v:.7f}"]) for i, v in enumerate(samples)]
    heading = separator.join(["time [s]", "E-W [g]", "up (cm/s^2)"])
    path = tmp_path / "record.csv"
    path.write_text("\n".join(["# made here", heading, *body]))
    east, up = ex.read(path)
    assert east.acceleration == pytest.approx(samples, abs=1e-8)
    assert up.acceleration == pytest.approx(samples, abs=1e-8)
    assert (east.azimuth_deg, up.vertical, east.component) == (90.0, True, "E-W")
    assert east.time_step == pytest.approx(0.01)


def test_columns_without_heading_take_stated_units_and_nothing_is_guessed(tmp_path, samples):
    text = "\n".join(f"{10 * i} {v / G:.9f}" for i, v in enumerate(samples))
    record = one(tmp_path, text, units="g", time_units="ms")
    assert record.acceleration == pytest.approx(samples, abs=1e-8)
    assert record.time_step == pytest.approx(0.01)
    with pytest.raises(ex.RecordFileError, match=r"record\.txt, line 1: .* want the unit of column 1"):
        one(tmp_path, text)


def test_times_printed_with_few_digits_are_equally_spaced(tmp_path, samples):
    """128 samples a second, printed to a millisecond: 0.5 ms of 7.8 ms off."""
    text = "\n".join(["time [s],a_x [m/s^2]", *(f"{i / 128:.3f},{v}" for i, v in enumerate(samples))])
    # The last time is off by half a millisecond in 122 steps.
    assert one(tmp_path, text).time_step == pytest.approx(1 / 128, abs=0.0005 / 122)


def test_obspy_formats_need_a_stated_unit(tmp_path, samples):
    obspy = pytest.importorskip("obspy")
    trace = obspy.Trace(samples.copy(), {"delta": 0.01, "network": "XX", "station": "ABC", "channel": "HNZ"})
    path = tmp_path / "record.mseed"
    trace.write(str(path), format="MSEED")
    (record,) = ex.read(path, units="m/s^2")
    assert record.acceleration == pytest.approx(samples)
    assert (record.vertical, record.station, record.format) == (True, "XX.ABC", "obspy: MSEED")
    with pytest.raises(ex.RecordFileError, match="states no unit"):
        ex.read(path)


def test_without_obspy_the_error_says_which_extra_reads_more(tmp_path, monkeypatch):
    from excitation.formats import seismology

    monkeypatch.setattr(seismology, "find_spec", lambda name: None)
    (tmp_path / "x.bin").write_bytes(b"\x00\x01\x02")
    with pytest.raises(ex.RecordFileError, match="extra `records`"):
        ex.read(tmp_path / "x.bin")


def change(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


def with_line(text, number, line):
    lines = text.split("\n")
    lines[number - 1] = line
    return "\n".join(lines)


BASE = np.round(2.0 * np.sin(np.arange(N)), 6)
V2, V2C = "\n".join(csmip2_channel(BASE, 0.02)), "\n".join(cosmos_channel(BASE, 0.005))
V1E, NSMN = "\n".join(csmip1_even_channel(BASE, 200)), nsmn_text([BASE, 0.5 * BASE, 0.1 * BASE], 0.01)
PEAK = f"{100 * max(BASE, key=abs):10.3f}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (change(peer_text(BASE, 0.005), "ACCELERATION", "VELOCITY"), "line 3: found .*, want ACCELERATION TIME SERIES"),
        (change(peer_text(BASE, 0.005), "UNITS OF G", "UNITS OF CM"), "line 3: .* want ACCELERATION"),
        (change(peer_text(BASE, 0.005), "NPTS=", "POINTS="), "line 4: .* want NPTS= "),
        (change(peer_text(BASE, 0.005), "0.0050", "0.0000"), "line 4: .* want NPTS= "),
        (change(peer_text(BASE, 0.005), "0.0050", "nan"), "line 4: .* want NPTS= "),
        (change(peer_text(BASE, 0.005), "=   123", "=   124"), "lines 5 to 29: hold 123 values, want 124 as line 4"),
        (change(peer_text(BASE, 0.005), "=   123", "= 999999999999"), "hold 123 values, want 999999999999"),
        (change(peer_text(BASE, 0.005), "=   123", "=   1_3"), "line 4: .* want NPTS"),
        (with_line(peer_text(BASE, 0.005), 9, " 0.1 0.2 ****** 0.4 0.5"), "line 9: found .*, want finite numbers"),
        (with_line(peer_text(BASE, 0.005), 9, " 0.1 0.2 nan 0.4 0.5"), "line 9: .* want finite numbers"),
        (with_line(peer_text(BASE, 0.005), 9, " 0.1 0.2 1_0 0.4 0.5"), "line 9: .* want finite numbers"),
        (with_line(peer_text(BASE, 0.005), 9, " 0.1 0.2 1E999 0.4 0.5"), "line 9: .* want finite numbers"),
        (with_line(peer_text(BASE, 0.005), 9, " 0.1 0.2-0.3 0.4 0.5"), "line 9: .* want finite numbers"),
        (change(knet_text(BASE), "100Hz", "Hz"), r"line 11: .* want Sampling Freq\(Hz\) such as 100Hz"),
        (change(knet_text(BASE), "1.23", "2.5"), "hold 123 values, want 250 as line 12 says"),
        (change(knet_text(BASE), "(gal)/8223790", "(gal)/0"), "line 14: .* want Scale Factor"),
        (change(knet_text(BASE), "7845(gal)", "784(gal)"), "line 15: .* want the largest sample"),
        (change(knet_text(BASE), "N-S", "7"), "line 13: .* want Dir. N-S"),
        (change(knet_text(BASE), "2014/12/31 23:50:00", "yesterday"), "line 10: .* want Record Time"),
        (change(knet_text(BASE), "Mag. ", "Mug. "), "line 5: .* want the header line 'Mag.'"),
        (change(dyna_text(BASE, 0.005), "NDATA: 123", "NDATA: x"), "line 9: .* want NDATA"),
        (change(dyna_text(BASE, 0.005), "NDATA: 123", "NDATA: 122"), "hold 123 values, want 122 as line 9 says"),
        (change(dyna_text(BASE, 0.005), "UNITS: cm/s^2", "UNITS: m"), "line 11: .* want UNITS: a unit of acceleration"),
        (change(dyna_text(BASE, 0.005), "UNITS: cm/s^2", "UNITS: "), "line 11: .* want UNITS: a unit of"),
        (change(dyna_text(BASE, 0.005), "UNITS: cm/s^2\n", ""), "want the header line UNITS"),
        (change(dyna_text(BASE, 0.005), "DATA_TYPE: ACC", "DATA_TYPE: VEL"), "line 13: .* want DATA_TYPE: ACCEL"),
        (change(dyna_text(BASE, 0.005), "L_S: 0.005", "L_S: -0.005"), "line 8: .* want SAMPLING_INTERVAL_S"),
        (change(dyna_text(BASE, 0.005), "PGA_CM/S^2: ", "PGA_CM/S^2: 9"), "line 12: .* want the largest sample"),
        (change(smc_text(BASE, 0.005), "2 CORR", "3 VELOCITY CORR"), "line 1: .* want 1 UNCORRECTED"),
        (change(smc_text(BASE, 0.005), "       123", "       125"), "hold 123 values, want 125 as line 14 says"),
        (change(smc_text(BASE, 0.005), "         2\r\n       123", "     99999\r\n       123"), "line 13: .* comment"),
        (change(smc_text(BASE, 0.005), "  2.0000000E+02", "  0.0000000E+00"), "line 18: .* want the samples a second"),
        (change(smc_text(BASE, 0.005), "| a comment", "  a comment"), "line 28: .* want a comment that begins with"),
        ("\n".join(csmip2_channel(BASE, 0.02)[:-1]), "ends after line .*, want a line END OF DATA"),
        ("\n".join(csmip2_channel(BASE, 0.02)[:70]), "ends after line 70, want 123 values from line .* on"),
        ("\n".join(csmip2_channel(BASE, 0.02)[:40]), "ends after line 40, want 25 lines of text, 100 integers"),
        (change(V2, "123 POINTS OF ACC", "122 POINTS OF ACC"), "hold 123 values, want 122"),
        (change(V2, "    0  123", "    0  124"), "line 29: .* want 123 as integer 53"),
        (change(V2, "AT  0.020", "AT  0.200"), "line 40: .* want 0.2 as real 61"),
        (change(V2, "SEC/SEC)", "SEC)"), "want .*POINTS OF ACCEL"),
        (change(V2, PEAK, "   300.000"), "line 18: .* want the largest sample"),
        (change("\n".join(csmip1_channel(BASE, 0.02 * np.arange(N))), "G/10", "STONE"), "line 12: .* want a line such"),
        ("\n".join(csmip1_channel(BASE, -0.02 * np.arange(N))), "want ascending times"),
        (change(V1E, "123 Accel", "122 Accel"), "hold 123 values, want 122 as line 28 says"),
        (change(V1E, "  123 -999", "  124 -999"), "line 15: .* want 123 as integer 28"),
        (change(V1E, "of g .  ", "of v .  "), r"line 28: .* want \(count\) Accelerogram points"),
        (change(V1E, "200 pts", "0 pts"), r"line 28: .* want \(count\) Accelerogram points"),
        (change(V1E, "Max  = -0.", "Max  = -1."), "line 12: .* want the largest sample"),
        (change(V1E, "time:  2/13/12", "time: 13/13/12"), "line 4: .* want a date and a time of day"),
        (change(NSMN, "OF DATA   : 123", "OF DATA   : 124"), "hold 369 values, want 372 as line 13 says"),
        (change(NSMN, "OF DATA   : 123", "OF DATA   : x"), "line 13: .* want NUMBER OF DATA: the number"),
        (change(NSMN, "(sec)   : 0.01", "(sec)   : 0"), "line 14: .* want SAMPLING INTERVAL"),
        (change(NSMN, "SAMPLING", "SIMPLING"), r"line 18: .* want the header line SAMPLING INTERVAL \(sec\)"),
        (change(NSMN, "VALUES (gal)", "VALUES (V)"), "line 15: .* want RAW PGA VALUES"),
        (change(NSMN, "(U-D)", "(U-P)"), "line 15: .* want the largest values as"),
        (change(NSMN, "(E-W) ", "(E-W) 9"), "line 15: .* want the largest sample"),
        (change(NSMN, "20/07/2017", "20/20/2017"), "line 12: .* want RECORD TIME"),
        (change(NSMN, "U-D\n", "U\n"), "want a line with the columns' names"),
        (with_line(NSMN, 30, "1 2"), "line 30: found '1 2', want three numbers"),
        (change(V2C, "cm/sec2(04)", "counts (50)"), "not counts or volts"),
        (change(V2C, "Format=(8F10.5)", "Format=(x)"), "want a format such as"),
        (change(V2C, "approx  0 ", "approx  99 "), "want approx 0.615 secs"),
        (change(V2C, "       5.000000", "    -999.000000"), "line 25: .* time step"),
        (change(V2C, "100 Integer", "99999 Integer"), "ends after line"),
        ("\n".join(cosmos_channel(BASE, 0.005)[:-1]), "want a line End-of-data"),
        ("\n".join(cosmos_channel(BASE, 0.005, kind="velocity")), "line 1: .* want at least one channel"),
        ("time [s],a [g]\n0,1\n0.01,2\n0.03,3\n0.04,1", "line 3: .* want 0.0133333 as the time: equal"),
        ("time [s],a [g]\n0,1\n0.01,2\n0.02,x\n", "line 4: .* want 2 finite numbers"),
        ("time [s],a [g]\n0,1\n0.01,2\n0.02,\n", "line 4: .* want 2 finite numbers"),
        ("time [s],a [g],b [g]\n0,1,2\n0.1,,1 2\n0.2,3,4\n", "line 3: .* want 3 finite numbers"),
        ("time [s];a [g];b [g]\n0;1;2\n0.1;1 2;\n0.2;3;4\n", "line 3: .* want 3 finite numbers"),
        (
            "time [s],a [g]\n" + "\n".join(f"{0.005 * i:.2f},1" for i in range(9)),
            "want .* as the time: equal steps of 0.005, printed to a fifth of one or finer",
        ),
        ("time [s],a [g]\n0,1\n0.01,2\n0.02\n", "line 4: .* want 2 columns"),
        ("time [s],a [kg]\n0,1\n0.01,2\n", "line 1: .* want a unit of acceleration for column 2"),
        ("time [s],a\n0,1\n0.01,2\n", "line 1: .* want the unit of column 2"),
        ("0,1e999\n0.01,1\n0.02,1\n", "line 1: .* want finite numbers, or a heading"),
        ("time [s],a [g]\n0.02,1\n0.01,2\n", "want times that ascend"),
        ("time [s],a [g]\n0.02,1\n", "want two samples or more"),
        ("", "is empty"),
        ("  \n \n", "holds blanks only"),
        ("hello world\n", "in no format"),
    ],
)  # fmt: skip
def test_damage_is_answered_with_file_line_and_what_was_wanted(tmp_path, text, message):
    with pytest.raises(ex.RecordFileError, match=rf"(?s)record\.txt.*{message}|record\.txt.*{message}"):
        one(tmp_path, text)


def test_utf16_is_refused(tmp_path):
    with pytest.raises(ex.RecordFileError, match="in no format read here"):
        one(tmp_path, peer_text(BASE, 0.005).encode("utf-16"))


def test_latin_1_in_a_name_is_read(tmp_path):
    record = one(tmp_path, change(peer_text(BASE, 0.005), "A Place", "Erdöl").encode("latin-1"))
    assert "Erdöl" in record.event


def test_byte_order_mark_and_crlf_are_read(tmp_path):
    text = peer_text(BASE, 0.005).replace("\n", "\r\n")
    assert one(tmp_path, b"\xef\xbb\xbf" + text.encode()).acceleration == pytest.approx(BASE, abs=1e-6)


def test_arguments_of_read_are_checked(tmp_path):
    path = tmp_path / "record.AT2"
    path.write_text(peer_text(BASE, 0.005))
    with pytest.raises(ValueError, match="format='x': want one of peer, knet"):
        ex.read(path, format="x")
    with pytest.raises(ValueError, match=r"units='g': want none, a PEER NGA \.AT2 file states its own"):
        ex.read(path, units="g")
    with pytest.raises(ex.RecordFileError, match=r"record\.AT2, line 1: .* want the header line 'Origin Time'"):
        ex.read(path, format="knet")
    with pytest.raises(FileNotFoundError):
        ex.read(tmp_path / "nothing.AT2")


def test_digest_is_that_of_the_file(tmp_path):
    import hashlib

    record = one(tmp_path, peer_text(BASE, 0.005))
    assert record.sha256 == hashlib.sha256(peer_text(BASE, 0.005).encode()).hexdigest()
