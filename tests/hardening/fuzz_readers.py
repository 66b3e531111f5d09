"""A coverage-guided fuzzer for everything that reads strangers' files; what it finds becomes a case of the tables.

Run      python -m pip install atheris
         python tests/hardening/fuzz_readers.py TARGET [-max_total_time=120] [FOLDER that keeps what was of use]
         with TARGET one of records, campaign, csv, sweep, model, netcdf; -help=1 lists what libFuzzer takes
Judges   every reader either reads (finite numbers, bounded memory) or refuses with one short sentence that can be
         printed; anything else is a crash, whose input is left as crash-* in the current folder.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import atheris

HERE = Path(__file__).resolve().parent
LONGEST = 600  # characters of a sentence

with atheris.instrument_imports(include=["excitation", "studies", "tomllib"]):
    import tomllib  # noqa: F401

    import numpy as np

    import excitation as ex
    from excitation.formats import seismology
    from studies.campaigns import CampaignError
    from studies.campaigns import read as read_campaign
    from studies.loop.models.model_file import ModelError, read_model
    from studies.running.files import DatasetError, load_dataset
    from studies.sweep import read as read_sweep

FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-"))
PLACES = {"campaign": "campaign.toml", "csv": "ramp.csv", "netcdf": "a.nc", "model": "model.toml", "sweep": "s.toml"}


def said(error: Exception) -> None:
    """The sentence of a refusal is one."""
    sentence = str(error)
    assert sentence and sentence.isprintable() and len(sentence) < LONGEST, repr(sentence)


def write(target: str, data: bytes) -> Path:
    """The file of a target with these bytes."""
    path = FOLDER / PLACES.get(target, "record.dat")
    path.write_bytes(data)
    return path


def records(data: bytes) -> None:
    """Every reader of `excitation`."""
    try:
        found = ex.read(write("records", data))
    except ex.RecordFileError as error:
        said(error)
        return
    for record in found:
        assert record.acceleration.size >= 2 and np.isfinite(record.acceleration).all() and record.time_step > 0.0


def campaign(data: bytes) -> None:
    """campaign.toml; its records are whole."""
    write("campaign", data)
    _campaign()


def csv(data: bytes) -> None:
    """A record of a campaign; campaign.toml is whole."""
    write("csv", data)
    _campaign()


def _campaign() -> None:
    try:
        read_campaign(FOLDER)
    except CampaignError as error:
        said(error)


def sweep(data: bytes) -> None:
    """The declaration of a sweep."""
    try:
        read_sweep(write("sweep", data))
    except ValueError as error:
        said(error)


def model(data: bytes) -> None:
    """A saved model of the loop."""
    try:
        read_model(write("model", data))
    except ModelError as error:
        said(error)


def netcdf(data: bytes) -> None:
    """A dataset; what the NetCDF library itself does with damage is not instrumented."""
    try:
        load_dataset(write("netcdf", data), most=2**24)
    except DatasetError as error:
        said(error)


TARGETS: dict[str, Callable[[bytes], None]] = {f.__name__: f for f in (records, campaign, csv, sweep, model, netcdf)}


ODD = ("nan", "inf", "-1", "1e999", "99999999999999999999", "true", "''", "[", "[[", "{a=1}", "..", "\\u0000", "é")


def seeds(target: str, folder: Path) -> Path:
    """Whole files to begin with; a dictionary of their words."""
    sys.path.insert(0, str(HERE.parent / "excitation"))
    sys.path.insert(0, str(HERE.parent / "studies" / "campaigns"))
    sys.path.insert(0, str(HERE))
    import files

    made = files.of(target)
    for number, data in enumerate(made):
        (folder / f"seed-{number}").write_bytes(data)
    words = {word for data in made if target != "netcdf" for word in re.findall(rb"[A-Za-z_][\w.-]+", data)}
    tokens = sorted({word.decode() for word in words}) + list(ODD)
    lines = ['"' + "".join(f"\\x{byte:02x}" for byte in token.encode()) + '"' for token in tokens]
    dictionary = FOLDER / "words.dict"
    dictionary.write_text("\n".join(lines), encoding="ascii")
    for name, data in files.campaign().items():
        (FOLDER / name).write_bytes(data)
    return dictionary


def main(arguments: list[str]) -> None:
    """Fuzz one target."""
    if len(arguments) < 2 or arguments[1] not in TARGETS:
        sys.exit(f"want a target, one of {', '.join(TARGETS)}")
    target = arguments.pop(1)
    seismology.available = lambda: False  # type: ignore[assignment]  # obspy's readers are not ours
    begin = Path(tempfile.mkdtemp(prefix="seeds-"))
    dictionary = seeds(target, begin)
    kept = [a for a in arguments[1:] if not a.startswith("-")] or [tempfile.mkdtemp(prefix="corpus-")]
    options = [a for a in arguments[1:] if a.startswith("-")]
    try:
        atheris.Setup([arguments[0], f"-dict={dictionary}", *options, *kept, str(begin)], TARGETS[target])
        atheris.Fuzz()
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)


if __name__ == "__main__":
    main(sys.argv)
