"""Reading a record of 300 s at 200 Hz in each text format, and a response spectrum, beside other libraries.

Case     60,001 samples of a swept sine (three components where the format has three); files as the tests write them.
Peers    reading: obspy for the one of these formats that it has too, and numpy.loadtxt of the bare samples, one to a
         line, as a yardstick for all; spectrum at 100 periods: eqsig and pyrotd on the same samples.
Measure  CPU time, the least of several, and the ratio of the peer's to it.
Run      python benchmarks/excitation_records.py [--runs N]  ->  a table, and benchmarks/results/excitation_records.csv
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import platform
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from excitation import Record, read, response_spectrum, write
from excitation.spectra import STANDARD_PERIODS

RESULTS = Path(__file__).parent / "results" / "excitation_records.csv"
SYNTHETIC = Path(__file__).parents[1] / "tests" / "excitation" / "synthetic_files.py"
STEP, SIZE = 0.005, 60001
HEAD = ["what", "cpu_ms", "peer", "peer_cpu_ms", "peer_over_this"]


def texts(samples: np.ndarray) -> dict[str, str]:
    """Files by format."""
    spec = importlib.util.spec_from_file_location("synthetic_files", SYNTHETIC)
    made: Any = importlib.util.module_from_spec(spec)  # type: ignore[arg-type]
    spec.loader.exec_module(made)  # type: ignore[union-attr]
    return {
        "peer": made.peer_text(samples, STEP),
        "knet": made.knet_text(samples, 200),
        "dyna": made.dyna_text(samples, STEP),
        "nsmn (three components)": made.nsmn_text([samples] * 3, STEP),
        "smc": made.smc_text(samples, STEP),
        "csmip .V1": "\n".join(made.csmip1_even_channel(samples, 200)),
        "csmip .V2": "\n".join(made.csmip2_channel(samples, STEP)),
        "cosmos": "\n".join(made.cosmos_channel(samples, STEP)),
    }


def cpu(call: Callable[[], Any], runs: int) -> float:
    """Least CPU time [s]."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def row(what: str, own: float, peer: str, others: float) -> list[str]:
    """A line of the table."""
    return [what, f"{1e3 * own:.1f}", peer, f"{1e3 * others:.1f}", f"{others / own:.2f}"]


def readers(samples: np.ndarray, folder: Path, runs: int) -> list[list[str]]:
    """Every format against numpy.loadtxt, K-NET against obspy too."""
    np.savetxt(folder / "bare", samples, fmt="%.7e")
    bare = cpu(lambda: np.loadtxt(folder / "bare"), runs)
    rows = []
    for name, text in texts(samples).items():
        (folder / "file").write_text(text)
        own = cpu(lambda: read(folder / "file"), runs)
        rows.append(row(f"read {name}", own, "numpy.loadtxt, bare samples", bare))
        if name == "knet" and importlib.util.find_spec("obspy"):
            import obspy

            theirs = cpu(lambda: obspy.read(folder / "file", format="KNET", apply_calib=True), runs)
            rows.append(row(f"read {name}", own, "obspy", theirs))
    write(folder / "file", Record(STEP, samples), "columns")
    rows.append(row("read columns", cpu(lambda: read(folder / "file"), runs), "numpy.loadtxt, bare samples", bare))
    return rows


def spectra(samples: np.ndarray, runs: int) -> list[list[str]]:
    """A spectrum at the 100 standard periods."""
    import eqsig

    record = Record(STEP, samples)
    own = cpu(lambda: response_spectrum(record), runs)
    theirs = eqsig.AccSignal(samples, STEP)
    rows = [row("spectrum", own, "eqsig", cpu(lambda: theirs.generate_response_spectrum(STANDARD_PERIODS, 0.05), runs))]
    try:
        import pyrotd
    except ImportError:  # it needs a part of setuptools that newer ones no longer have
        return rows
    pyrotd.processes = 1
    other = cpu(lambda: pyrotd.calc_spec_accels(STEP, samples, 1.0 / STANDARD_PERIODS, 0.05), runs)
    return [*rows, row("spectrum", own, "pyrotd", other)]


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="runs that the least is taken of (default: %(default)s)")
    runs = parser.parse_args().runs
    t = STEP * np.arange(SIZE)
    samples = np.round(np.sin(2.0 * np.pi * (0.2 + 0.01 * t) * t) * np.sin(np.pi * t / t[-1]), 6)
    warnings.simplefilter("ignore")  # the peers' own
    with tempfile.TemporaryDirectory() as folder:
        rows = [*readers(samples, Path(folder), runs), *spectra(samples, max(1, runs // 2))]
    for line in [HEAD, *rows]:
        print("  ".join(f"{cell:28s}" for cell in line).rstrip())
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*line, platform.python_version(), platform.machine()] for line in rows)
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
