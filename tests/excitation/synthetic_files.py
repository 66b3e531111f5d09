"""Small files in each format, written by other code than the package's."""

import numpy as np

G = 9.80665


def rows(texts, per_line):
    return ["".join(texts[i : i + per_line]) for i in range(0, len(texts), per_line)]


def peer_text(a, dt, old=False):
    sizes = f"{len(a)}    {dt:.4f}    NPTS, DT" if old else f"NPTS=   {len(a)}, DT=   {dt:.4f} SEC,   "
    head = ["PEER NGA STRONG MOTION DATABASE RECORD", "Somewhere, 1/2/2003, A Place, 67"]
    return "\n".join([*head, "ACCELERATION TIME SERIES IN UNITS OF G", sizes, *rows([f"{v / G:15.7E}" for v in a], 5)])


def knet_text(a, rate=100, direction="N-S", scale=(7845.0, 8223790), offset=1000):
    counts = [round(v * 100.0 / scale[0] * scale[1]) + offset for v in a]
    peak = np.max(np.abs(np.array(counts) - np.mean(counts))) * scale[0] / scale[1]
    head = {
        "Origin Time       ": "2014/12/31 23:49:00", "Lat.              ": "35.785", "Long.             ": "139.887",
        "Depth. (km)       ": "84", "Mag.              ": "4.2", "Station Code      ": "XYZ002",
        "Station Lat.      ": "35.7868", "Station Long.     ": "139.9031", "Station Height(m) ": "14",
        "Record Time       ": "2014/12/31 23:50:00", "Sampling Freq(Hz) ": f"{rate}Hz",
        "Duration Time(s)  ": f"{len(a) / rate:g}", "Dir.              ": direction,
        "Scale Factor      ": f"{scale[0]:.0f}(gal)/{scale[1]}", "Max. Acc. (gal)   ": f"{peak:.3f}",
        "Last Correction   ": "2014/12/31 23:49:59", "Memo.             ": "",
    }  # fmt: skip
    return "\n".join([k + v for k, v in head.items()] + [r + " " for r in rows([f"{c:8d} " for c in counts], 8)]) + "\n"


def dyna_text(a, dt, stream="HNE", first="20190728_160919.870"):
    head = {
        "EVENT_NAME": "SOMEWHERE", "EVENT_DATE_YYYYMMDD": "20190728", "EVENT_TIME_HHMMSS": "160908", "NETWORK": "XX",
        "STATION_CODE": "ABC", "MAGNITUDE_W": "", "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": first,
        "SAMPLING_INTERVAL_S": f"{dt:.6f}", "NDATA": f"{len(a)}", "STREAM": stream, "UNITS": "cm/s^2",
        "PGA_CM/S^2": f"{100 * np.max(np.abs(a)):.6f}", "DATA_TYPE": "ACCELERATION", "USER5": "",
    }  # fmt: skip
    return "\n".join([f"{k}: {v}" for k, v in head.items()] + [f"{100 * v:.6f}" for v in a]) + "\n"


def smc_text(a, dt, comments=2, azimuth=360, vertical=-32768, per_line=8):
    integers = [-32768] * 48
    integers[12], integers[13], integers[15], integers[16] = vertical, azimuth, comments, len(a)
    reals = [1.7e38] * 50
    reals[1], reals[29], reals[31] = 1.0 / dt, 100 * max(a), 100 * min(a)
    digits, width = (4, 10) if per_line == 8 else (7, 14)

    def sample(v):
        mantissa, exponent = f"{v:.{digits}E}".split("E")
        return f"{mantissa}E{int(exponent):+d}".rjust(width)

    lines = ["2 CORRECTED ACCELEROGRAM", "*", "ABC", "     1989  10  18    0004 Somewhere", "Moment Mag=      7.1"]
    lines += ["station = A Place, F          component=    360", "epicentral dist = 89.0", "inst", "*", "*", "*"]
    lines += rows([f"{v:10d}" for v in integers], 8) + rows([f"{v:15.7E}" for v in reals], 5)
    lines += ["| a comment"] * comments + rows([sample(100 * v) for v in a], per_line)
    return "\r\n".join(lines) + "\r\n"


def csmip2_channel(a, dt, number=1, direction="90 DEG"):
    integers, reals = [0] * 100, [0.0] * 100
    integers[52] = integers[63] = integers[65] = len(a)
    reals[60] = dt
    text = [f"CORRECTED ACCELEROGRAM   36456-S4384-83123.01       CHAN  {number}:  {direction}     FROM", "second"]
    text += ["SOMEWHERE EARTHQUAKE", "MAY 2, 1983", "trigger", "STATION NO. 36456   35.908N, 120.458W", "A PLACE"]
    text += [f"CHAN  {number}:  {direction}"] + ["x"] * 9
    text += [f"PEAK ACCELERATION = {100 * max(a, key=abs):10.3f}    CM/SEC/SEC  AT   10.940   SEC."]
    text += ["x"] * (25 - len(text))
    lines = text + rows([f"{v:5d}" for v in integers], 16) + rows([f"{v:10.3f}" for v in reals], 8)
    for kind, unit in (("ACCEL", "CM/SEC/SEC"), ("VELOC", "CM/SEC"), ("DISPL", "CM")):
        lines += [f" {len(a)} POINTS OF {kind} DATA EQUALLY SPACED AT  {dt:.3f} SEC.  (UNITS: {unit})"]
        lines += rows([f"{100 * v:10.3f}" for v in a], 8)
    return [*lines, f"/&  ----------  END OF DATA FOR CHANNEL  {number}  ----------"]


def csmip1_channel(a, times, number=1, direction="UP"):
    integers, reals = [0] * 100, [0.0] * 50
    integers[27] = len(a)
    text = ["UNCORRECTED ACCELEROGRAM DATA              PROCESSED:  6/06/83", "SOMEWHERE EARTHQUAKE", "MAY 2, 1983"]
    text += [
        "36456-S4384",
        "STATION NO. 36456   35.908N, 120.458W",
        "A PLACE",
        f"CHAN  {number}: {direction}",
        "x",
        "x",
    ]
    peak = max(a, key=abs) / G
    text += ["x", "x", f"UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  = {peak:6.3f} G, AT  11.576 SEC.", "x"]
    lines = text + rows([f"{v:5d}" for v in integers], 16) + rows([f"{v:10.3f}" for v in reals], 8)
    pairs = [f"{t:7.3f}{10 * v / G:7.3f}" for t, v in zip(times, a, strict=True)]
    return [*lines, *rows(pairs, 5), f"/&  ----------  END OF DATA FOR CHANNEL  {number}  ----------"]


def csmip1_even_channel(a, rate, number=1, direction="360 Deg"):
    """A volume 1 of a digital recorder, as files of 2012 have it."""
    integers, reals = [-999] * 100, [-999.0] * 50
    integers[27] = integers[32] = len(a)
    text = ["Uncorrected Accelerogram Data             Processed: 02/13/12, CGS  146be002"]
    text += ["Record of Mon Feb 13, 2012 13:06:45.0 PST             (Avol1 v9.2,12/11 CSMIP)", "x"]
    text += ["38457487.CI.ABC.--.HN                Start time:  2/13/12, 21:06: 5.0 UTC (GPS)"]
    text += ["Station Id. ABC     40.941N, 123.633W      Etna", "A Place", f"Chan  {number}: {direction}"]
    peak = max(a, key=abs) / G
    text += ["x", "x", "x", f"No. of Points = {len(a):6d}"]
    text += [f"Units of uncor data are sec and g .        Max  = {peak:6.3f} g , at  30.590 sec.    ", "RMS"]
    lines = text + rows([f"{v:5d}" for v in integers], 16) + rows([f"{v:10.5f}" for v in reals], 8)
    lines += [f" {len(a)} Accelerogram points at {rate} pts/sec in units of g .      Format: (8f9.6)  "]
    return [*lines, *rows([f"{v / G:9.6f}" for v in a], 8), f"/&  ----------  End of Data for Channel  {number}"]


def nsmn_text(components, dt, columns=("N-S", "E-W", "U-D"), between="   : "):
    """The three-column text of Turkey's older archive."""
    peaks = " ".join(f"({c}) {100 * np.max(np.abs(a)):.6f}" for c, a in zip(columns, components, strict=True))
    head = {
        "PLACE": "A PLACE", "EARTHQUAKE DATE": "2017/07/20 22:31:09 (GMT)",
        "EPICENTER COORDINATES": "36.9N-27.4E", "EARTHQUAKE DEPTH (km)": "19.44", "EARTHQUAKE MAGNITUDE": "6.5 Mw",
        "STATION ID": "4304", "STATION COORDINATES": "38.9N-29.4E", "STATION ALTITUDE (m)": "735",
        "RECORDER TYPE": "x", "RECORDER SERIAL NO": "5B02", "RECORD TIME": "20/07/2017 22:31:14.000000 (GMT)",
        "NUMBER OF DATA": f"{len(components[0])}", "SAMPLING INTERVAL (sec)": f"{dt}", "RAW PGA VALUES (gal)": peaks,
    }  # fmt: skip
    lines = ["STRONG GROUND MOTION RECORDS OF TURKIYE", *(k + between + v for k, v in head.items()), "Copyright", "x"]
    body = ["".join(f"{100 * v:13.6f}" for v in row) for row in zip(*components, strict=True)]
    return "\n".join([*lines, "".join(f"{c:>13}" for c in columns), *body, ""])


def cosmos_channel(a, dt, azimuth=90, kind="acceleration", unit="cm/sec2(04)", layout="(8F10.5)", scnl=None):
    integers, reals = [-999] * 100, [-999.0] * 100
    integers[53] = azimuth
    reals[61] = 1000.0 * dt
    scale = 100.0
    body = {
        "(8F10.5)": lambda: rows([f"{scale * v:10.5f}" for v in a], 8),
        "(1E15.6)": lambda: [f"{scale * v:15.6e}" for v in a],
    }[layout]()
    text = [f"Corrected {kind}    (Format v01.20 with 13 text lines)", "Record of Somewhere Earthquake of 2018"]
    text += ["Hypocenter", "Origin: 2018/11/30 17:29:29    UTC", "Statn No: 37-000011 Code:AK-ABC     UAF  A Place"]
    text += ["Coords", "Recorder", "Rcrd start time: 2018/11/30 17:29:39.137 UTC (Q=5) RcrdId:", "Sta Chan", "Raw"]
    text += [
        f"Processed:2019-03-03 05:46:55 GMT, UNKN, Max = {scale * max(a, key=abs):8.3f} cm/sec2 at 1 sec",
        "filter",
    ]
    text += ["Values used when parameter or data value is unknown/unspecified:   -999, -999.00"]
    comments = ["| one"] + ([f"|<SCNL>{scnl}"] if scnl else ["| two"])
    return [
        *text, " 100 Integer-header values follow on  10 lines, Format= (10I8)",
        *rows([f"{v:8d}" for v in integers], 10),
        " 100 Real-header values follow on  20 lines, Format= (5F15.6)", *rows([f"{v:15.6f}" for v in reals], 5),
        '   2 Comment line(s) follow, each starting with a "|":', *comments,
        f"   {len(a)} {kind} pts, approx  {int(len(a) * dt)} secs, units={unit},Format={layout}", *body,
        f"End-of-data for Chan 1 {kind}",
    ]  # fmt: skip
