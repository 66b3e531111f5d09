"""Cases for everything that is read: damaged, foreign, hostile and absurd files.

A case is (reader, what makes the file in a folder, words of the sentence).  Campaigns have further ones in
tests/studies/campaigns/test_bad_campaigns.py, records in tests/excitation/test_readers.py.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import files
import netCDF4
import numpy as np
import xarray as xr

import excitation as ex
import studies
from studies.animation import film_of
from studies.campaigns import read as read_campaign
from studies.loop.models.model_file import read_model
from studies.loop.outcomes.prediction import read_noise
from studies.running.files import load_dataset
from studies.sweep import read as read_sweep

Make = Callable[[Path], Path]

READERS: dict[str, Callable[[Path], Any]] = {
    "record": ex.read,
    "campaign": read_campaign,
    "sweep": read_sweep,
    "model": read_model,
    "noise": read_noise,
    "open": studies.open,
    "dataset": load_dataset,
    "film": film_of,
    "motion": lambda path: ex.from_xarray(xr.load_dataset(path)),
}


def written(name: str, data: bytes | str) -> Make:
    """A file with these bytes."""

    def make(folder: Path) -> Path:
        (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
        return folder / name

    return make


def changed(name: str, text: str, old: str, new: str) -> Make:
    """A text with one place changed."""
    assert old in text, old
    return written(name, text.replace(old, new, 1))


def campaign(name: str, old: str, new: str) -> Make:
    """The campaign with one place changed in one of its files."""

    def make(folder: Path) -> Path:
        for file, data in files.campaign().items():
            (folder / file).write_bytes(data)
        text = (folder / name).read_text()
        assert old in text, old
        (folder / name).write_text(text.replace(old, new, 1))
        return folder / "campaign.toml"

    return make


def linked(folder: Path) -> Path:
    """A campaign whose record is a link to a file elsewhere."""
    inside = folder / "all" / "made"
    inside.mkdir(parents=True)
    for file, data in files.campaign().items():
        (inside / file).write_bytes(data)
    (folder / "secret.csv").write_bytes((inside / "free.csv").read_bytes())
    (inside / "free.csv").unlink()
    (inside / "free.csv").symlink_to(folder / "secret.csv")
    return inside / "campaign.toml"


def netcdf(change: Callable[[bytes], bytes]) -> Make:
    """A dataset with its bytes changed."""
    return lambda folder: written("a.nc", change(files.netcdf()))(folder)


def declaring(dims: dict[str, int], kind: str) -> Make:
    """A file of some kilobytes that declares a variable of these sizes."""

    def make(folder: Path) -> Path:
        with netCDF4.Dataset(folder / "a.nc", "w") as file:
            for name, size in dims.items():
                file.createDimension(name, size)
            chunks = tuple(min(size, 1000) for size in dims.values())
            file.createVariable("v", str if kind == "str" else kind, tuple(dims), chunksizes=chunks)
        assert (folder / "a.nc").stat().st_size < 1e6
        return folder / "a.nc"

    return make


def dataset(ds: xr.Dataset) -> Make:
    """A dataset of something else."""

    def make(folder: Path) -> Path:
        ds.to_netcdf(folder / "a.nc", engine="netcdf4")
        return folder / "a.nc"

    return make


def run_dataset(**changes: Any) -> xr.Dataset:
    """The dataset of a run of one body, with something changed."""
    time, outline = np.array([0.0, 0.1]), [-0.1, 0.1, 0.1, -0.1]
    data: dict[str, Any] = {n: (("time", "body"), np.zeros((2, 1))) for n in ("x", "z", "theta")}
    data |= {"outline_x": ("corner", outline), "outline_z": ("corner", [-0.4, -0.4, 0.4, 0.4])}
    data |= {"outline_of": ("corner", [0, 0, 0, 0])}
    return xr.Dataset(data | changes, {"time": time, "body": ["block"]})


def motion_dataset(**attributes: Any) -> xr.Dataset:
    """The dataset of a motion, with attributes changed."""
    return ex.OneSinePulse(1.0, 1.0).to_xarray(np.linspace(0.0, 1.0, 11)).assign_attrs(**attributes)


def text_units(**units: Any) -> xr.Dataset:
    """Samples whose units are something else."""
    ds = xr.Dataset({"a_x": ("time", [0.0, 1.0, 0.0], {"units": "m s-2"})}, {"time": ("time", [0.0, 0.1, 0.2])})
    ds.time.attrs["units"] = "s"
    for name, unit in units.items():
        ds[name].attrs["units"] = unit
    return ds


def folder_itself(folder: Path) -> Path:
    """A folder where a file is wanted."""
    return folder


def nothing(folder: Path) -> Path:
    """A file that is not there."""
    return folder / "nothing.nc"


SWEEP, MODEL, PEER = files.SWEEP, files.MODEL, files.records()["peer"].decode()


def sweep(old: str, new: str) -> Make:
    """The declaration of a sweep with one place changed."""
    return changed("s.toml", SWEEP, old, new)


def model(old: str, new: str) -> Make:
    """A model with one place changed."""
    return changed("model.toml", MODEL, old, new)


FILES: dict[str, tuple[Any, ...]] = {
    # sweeps
    "sweep: absurd count": ("sweep", sweep("count = 2", "count = 1000000000000"), "slenderness=", "at most 1000000"),
    "sweep: negative count": ("sweep", sweep("count = 2", "count = -2"), "slenderness=", "whole count above 0"),
    "sweep: count is true": ("sweep", sweep("count = 2", "count = true"), "slenderness=", "whole count"),
    "sweep: start is text": ("sweep", sweep("start = 0.2", 'start = "0.2"'), "slenderness=", "start and stop as num"),
    "sweep: stop is nan": ("sweep", sweep("stop = 0.3", "stop = nan"), "slenderness=", "start and stop as numbers"),
    "sweep: stop is a list": ("sweep", sweep("stop = 0.3", "stop = [1]"), "slenderness=", "start and stop"),
    "sweep: log is text": ("sweep", sweep("log = true", 'log = "yes"'), "slenderness=", "log = true or false"),
    "sweep: log of zero": ("sweep", sweep("start = 0.2", "start = 0.0"), "above 0 with log"),
    "sweep: descending": ("sweep", sweep("start = 0.2", "start = 0.4"), "slenderness: want ascending"),
    "sweep: a number of 5000 digits": ("sweep", sweep("friction = 0.6", "friction = " + "9" * 5000), "want TOML"),
    "sweep: a number beyond floats": ("sweep", sweep("friction = 0.6", "friction = 1" + "0" * 400), "friction=1000"),
    "sweep: title is a number": ("sweep", sweep('title = "two"', "title = 2"), "title=2: want text"),
    "sweep: title drives the terminal": ("sweep", sweep('"two"', '"\\u001b[2J"'), r"title='\\x1b\[2J': want text"),
    "sweep: method is a number": ("sweep", sweep('["method1"]', "[1]"), "method=1: want a name"),
    "sweep: axis is a table": ("sweep", sweep("[1.0, 2.0]", "{ a = 1 }"), "frequency=", "start, stop and count"),
    "sweep: axis of nothing": ("sweep", sweep("[1.0, 2.0]", "[]"), "frequency=.*one or more"),
    "sweep: axis with a line break": ("sweep", sweep("frequency = [1", '"fre\\nq" = [1'), r"'fre\\nq': want one of"),
    "sweep: excitation is a number": (
        "sweep",
        changed("s.toml", SWEEP[: SWEEP.index("[excitations")], "[fixed]", "[excitations]\nramp = 3\n[fixed]"),
        "excitations.ramp=3: want a table",
    ),
    "sweep: kind is a list": ("sweep", sweep('"ramped_sinusoid"', "[1]"), r"excitations.ramp.kind=\[1\]"),
    "sweep: duration is true": ("sweep", sweep("duration = 10.0", "duration = true"), "duration=True: want a number"),
    "sweep: duration is infinite": ("sweep", sweep("duration = 10.0", "duration = inf"), "duration=inf: want a number"),
    "sweep: solver is a list": ("sweep", sweep('"numba"', '["numba"]'), r"run.solver=\['numba'\]: want one of"),
    "sweep: rtol is true": ("sweep", sweep("rtol = 1e-8", "rtol = true"), "run.rtol=True: want a number"),
    "sweep: rtol is text": ("sweep", sweep("rtol = 1e-8", 'rtol = "x"'), "run.rtol='x': want a number"),
    "sweep: too many points": (
        "sweep",
        written(
            "s.toml",
            "[axes]\n" + "".join(f"{n} = {{start = 0.1, stop = 0.9, count = 100000}}\n" for n in ("h", "frequency")),
        ),
        "100000 x 100000 points, want at most",
    ),
    "sweep: nested a thousandfold": ("sweep", written("s.toml", "a = " + "[" * 50_000), "nested too deeply"),
    "sweep: longer than any": ("sweep", written("s.toml", b"#" * 3_000_000), "more than 2097152 bytes"),
    "sweep: UTF-16": ("sweep", written("s.toml", SWEEP.encode("utf-16")), "s.toml: want TOML"),
    "sweep: a folder": ("sweep", folder_itself, "is no file"),
    "sweep: not there": ("sweep", nothing, "nothing.nc: want a file that can be read"),
    # models of the loop
    "model: empty": ("model", written("model.toml", ""), r"has no table \[block\]"),
    "model: no TOML": ("model", written("model.toml", "a = \n"), "want TOML", "model.toml that the loop wrote"),
    "model: Latin-1": ("model", written("model.toml", MODEL.encode() + b"# \xe9"), "want TOML"),
    "model: a folder": ("model", folder_itself, "is no file"),
    "model: restitution above one": ("model", model("restitution = 0.92", "restitution = 5.0"), "restitution=5.0"),
    "model: restitution is nan": ("model", model("restitution = 0.92", "restitution = nan"), "restitution=nan: want"),
    "model: restitution is true": ("model", model("restitution = 0.92", "restitution = true"), "restitution=True"),
    "model: gravity of nothing": ("model", model("gravity = 9.81", "gravity = 0.0"), "g=0.0"),
    "model: negative breadth": ("model", model("breadth = 0.15", "breadth = -0.15"), "breadth.*above 0"),
    "model: infinite mass": ("model", model("mass = 11.2", "mass = inf"), "block.mass=inf: want a number"),
    "model: mass beyond floats": ("model", model("mass = 11.2", "mass = 1" + "0" * 400), "block.mass=1000"),
    "model: infinite number": ("model", model("number = 3", "number = inf"), "model.number=inf: want a number"),
    "model: effects are a list": ("model", written("model.toml", "effects = []\n" + MODEL[:99]), "want"),
    "model: a slip in a key": ("model", model("number = 3", "nunber = 3"), "model has no 'nunber', want restitution"),
    "model: a table too many": ("model", model("[outcomes]", "[outcome]"), "file has no 'outcome'"),
    "model: unknown effect": ("model", model("rounded_edges", "gremlin"), "effect 'gremlin' is unknown"),
    "model: effect drives the terminal": ("model", model("effects.rounded_edges", 'effects."\\u001b[2J"'), r"x1b\[2J"),
    "model: unknown parameter": ("model", model("radius = 0.003", "colour = 1.0"), "has no 'colour'"),
    "model: parameter is text": ("model", model("radius = 0.003", 'radius = "3 mm"'), "radius='3 mm': want"),
    "model: parameter out of range": ("model", model("radius = 0.003", "radius = -1.0"), "radius=-1.0"),
    "model: mountings is a list": ("model", model("[mountings]\ntop = 0.01", "[[mountings]]"), "mountings"),
    "noise: of nothing": ("noise", model("spread = 0.2", "spread = 0.0"), "outcomes.spread=0.0: want a number between"),
    "noise: error rate above a half": ("noise", model("error_rate = 0.01", "error_rate = 0.7"), "error_rate=0.7"),
    "noise: spread is text": ("noise", model("spread = 0.2", 'spread = "x"'), "outcomes.spread='x'"),
    "noise: is a number": ("noise", model("[outcomes]", "[other]\n[[outcomes]]"), "outcomes.spread=None"),
    # campaigns: paths and ids
    "campaign: absolute path": ("campaign", campaign("campaign.toml", '"free.csv"', '"/etc/passwd"'), "relative path"),
    "campaign: up and up": ("campaign", campaign("campaign.toml", '"free.csv"', '"../../x.csv"'), "relative path"),
    "campaign: up within": ("campaign", campaign("campaign.toml", '"free.csv"', '"a/../x.csv"'), "relative path"),
    "campaign: a link out": ("campaign", linked, "leads out through a link"),
    "campaign: a share": ("campaign", campaign("campaign.toml", '"free.csv"', "'\\\\host\\x.csv'"), "forward slashes"),
    "campaign: a device": ("campaign", campaign("campaign.toml", '"free.csv"', '"../../../dev/zero"'), "relative path"),
    "campaign: an address": ("campaign", campaign("campaign.toml", '"free.csv"', '"http://a/b.csv"'), "cannot be read"),
    "campaign: id a path": ("campaign", campaign("campaign.toml", 'id = "free"', 'id = "../../x"'), "can be a file's"),
    "campaign: id is absolute": ("campaign", campaign("campaign.toml", 'id = "free"', 'id = "/x"'), "can be a file's"),
    "campaign: id with a null": ("campaign", campaign("campaign.toml", 'id = "free"', 'id = "a\\u0000"'), "file's"),
    # datasets
    "dataset: not there": ("dataset", nothing, "nothing.nc: is not there"),
    "dataset: a folder": ("dataset", folder_itself, "is not there or no file"),
    "dataset: empty": ("dataset", netcdf(lambda data: b""), "a.nc: want a NetCDF dataset"),
    "dataset: cut in half": ("dataset", netcdf(lambda data: data[: len(data) // 2]), "a.nc: want a NetCDF dataset"),
    "dataset: the last byte lost": ("dataset", netcdf(lambda data: data[:-1]), "a.nc: want a NetCDF dataset"),
    "dataset: a text": ("dataset", written("a.nc", "time,rotation\n"), "a.nc: want a NetCDF dataset"),
    "dataset: a zip": ("dataset", written("a.nc", b"PK\x03\x04" + bytes(99)), "a.nc: want a NetCDF dataset"),
    "dataset: a pickle": ("dataset", written("a.nc", b"\x80\x04\x95" + bytes(99)), "a.nc: want a NetCDF dataset"),
    "dataset: numbers without end": ("dataset", declaring({"x": 10**9, "y": 10**9}, "f8"), "declares 8000000000000000"),
    "dataset: texts without end": ("dataset", declaring({"x": 10**9}, "str"), "declares 64000000000 bytes"),
    "open: numbers without end": ("open", declaring({"x": 10**6, "y": 10**6}, "f4"), "declares 4000000000000 bytes"),
    "open: damaged": ("open", netcdf(lambda data: data[:900]), "a.nc: want a NetCDF dataset"),
    "film: damaged": ("film", netcdf(lambda data: data[:900]), "a.nc: want a NetCDF dataset"),
    "film: of something else": ("film", netcdf(lambda data: data), "dataset without x, z, theta"),
    "film: no samples": ("film", dataset(run_dataset().isel(time=slice(0, 0))), "without samples"),
    "film: a body that is nowhere": (
        "film", dataset(run_dataset(x=(("time", "body"), np.full((2, 1), np.nan)))), "x of body 0 is nan",
    ),
    "film: outlines of no body": (
        "film", dataset(run_dataset(outline_of=("corner", [5, 5, 5, 5]))), "outline_of.*want",
    ),
    "film: outlines without end": (
        "film", dataset(run_dataset(outline_of=("corner", [0, 0, 0, 2**40]))), "outline_of.*want",
    ),
    "film: an outline that is nowhere": (
        "film", dataset(run_dataset(outline_x=("corner", [np.nan] * 4))), "outline_x.*want finite",
    ),
    "film: times that go back": ("film", dataset(run_dataset().assign_coords(time=[0.1, 0.0])), "time.*ascend"),
    "film: times that are no numbers": (
        "film", dataset(run_dataset().assign_coords(time=[np.nan, 0.1])), "time.*ascend",
    ),
    "film: places that are texts": ("film", dataset(run_dataset(z=(("time", "body"), [["a"], ["b"]]))), "z.*want num"),
    "film: places of two": ("film", dataset(run_dataset(theta=(("time", "t"), np.zeros((2, 2))))), "theta.*want"),
    # motions
    "motion: of something else": ("motion", netcdf(lambda data: data), "want time"),
    "motion: a class of another module": ("motion", dataset(motion_dataset(motion_class="os.system")), "os.system"),
    "motion: arguments that are no JSON": ("motion", dataset(motion_dataset(motion_arguments="{")), "motion_arguments"),
    "motion: arguments of another": ("motion", dataset(motion_dataset(motion_arguments='{"x": 1}')), "want|argument"),
    "motion: arguments that are a list": ("motion", dataset(motion_dataset(motion_arguments="[1]")), "arguments"),
    "motion: arguments nested without end": (
        "motion", dataset(motion_dataset(motion_arguments="[" * 100_000)), "motion_arguments",
    ),
    "motion: a time step in words": ("motion", dataset(text_units().assign_attrs(time_step="x")), "time_step='x'"),
    "motion: units of something else": ("motion", dataset(text_units(a_x="kg")), "a_x|kg"),
    # records
    "record: absurd count": ("record", changed("r.AT2", PEER, "=   61", "=   1000000000000"), "1000000000000"),
    "record: count of nothing": ("record", changed("r.AT2", PEER, "=   61", "=   0"), "r.AT2, line 4: .*want NPTS"),
    "record: negative count": ("record", changed("r.AT2", PEER, "=   61", "=   -61"), "r.AT2, line 4: .*want NPTS"),
    "record: a folder": ("record", written("r.txt", b"\x00" * 100), "r.txt: is in no format read here|holds"),
    "record: a NetCDF": ("record", netcdf(lambda data: data), "a.nc: is in no format read here"),
    "record: one sample": ("record", written("r.csv", "time [s],a [g]\n0,1\n"), "r.csv.*want two samples or more"),
    "record: digits without end": ("record", written("r.csv", "time [s],a [g]\n0,1\n" + "1" * 10**6), "line 3: found"),
}  # fmt: skip
