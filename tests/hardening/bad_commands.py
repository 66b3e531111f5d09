"""Cases for command lines: (command, arguments, words of the sentence); {names} are the places of `Places`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import files

from studies.running.command_line import run


class Places:
    """A folder with whole and broken inputs, an empty one to work in, and names that are free."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.empty = folder, folder / "empty"
        for name in ("empty", "campaign", "datasets"):
            (folder / name).mkdir()
        for name, data in files.campaign().items():
            (folder / "campaign" / name).write_bytes(data)
        given = {
            "sweep.toml": files.SWEEP.encode(), "model.toml": files.MODEL.encode(), "whole.nc": files.netcdf(),
            "cut.nc": files.netcdf()[:-50], "text.nc": b"nothing of the kind", "record.AT2": files.records()["peer"],
            "columns.csv": b"0 1\n0.01 2\n0.02 1\n", "bad.toml": b"[axes\n", "datasets/fig18.nc": files.netcdf(),
        }  # fmt: skip
        for name, data in given.items():
            (folder / name).write_bytes(data)

    def filled(self, argument: str) -> str:
        """An argument with the names of places in it."""
        return argument.replace("{}", str(self.folder))

    def everything(self) -> dict[str, tuple[int, int]]:
        """Size and time of every file, and every folder."""
        found = {}
        for path in self.folder.rglob("*"):
            status = path.stat()
            found[str(path)] = (status.st_size if path.is_file() else 0, status.st_mtime_ns if path.is_file() else 0)
        return found


def _by_run(main: Callable[[list[str]], object]) -> Callable[[list[str], Any], tuple[Any, str]]:
    """A command whose main is given to `studies.running.command_line.run`."""

    def go(argv: list[str], capsys: Any) -> tuple[Any, str]:
        given, sys.argv = sys.argv, ["command", *argv]
        try:
            run(main)
        except SystemExit as left:
            return left.code, capsys.readouterr().err
        finally:
            sys.argv = given
        return 0, capsys.readouterr().err

    return go


def _by_return(main: Callable[[list[str]], int]) -> Callable[[list[str], Any], tuple[Any, str]]:
    """A command whose main gives the exit status."""

    def go(argv: list[str], capsys: Any) -> tuple[Any, str]:
        try:
            status: Any = main(argv)
        except SystemExit as left:
            status = left.code
        return status, capsys.readouterr().err

    return go


def _mains() -> dict[str, Callable[[list[str], Any], tuple[Any, str]]]:
    import importlib

    from studies.running.registry import studies
    from studies.running.study import make

    def main(module: str) -> Any:
        return importlib.import_module(module).main

    made = {name: _by_run(lambda argv, s=study: make(s, argv)) for name, study in studies().items()}
    ways = {
        "rocking": _by_return(main("rocking.__main__")), "excitation": _by_return(main("excitation.__main__")),
        "loop": _by_return(main("studies.loop.__main__")), "trials": _by_return(main("studies.loop_trials")),
        "studies": _by_run(main("studies.__main__")), "sweep": _by_run(main("studies.sweep.__main__")),
        "campaigns": _by_run(main("studies.campaigns.__main__")), "claims": _by_run(main("studies.claims.__main__")),
        "compare": _by_run(main("studies.compare")), "animation": _by_run(main("studies.animation.__main__")),
        "falls": _by_run(main("studies.will_it_fall")),
    }  # fmt: skip
    return made | ways


MAINS = _mains()

_NEW = "{}/new/folder"

COMMANDS: dict[str, tuple[Any, ...]] = {
    "rocking: an argument": ("rocking", ["0.3"], "'0.3': want no argument"),
    "rocking: an option": ("rocking", ["--fast"], "'--fast': want no argument"),
    "excitation: no file": ("excitation", [], "required: file"),
    "excitation: not there": ("excitation", ["{}/nothing.AT2"], "nothing.AT2: want a file that can be read"),
    "excitation: a folder": ("excitation", ["{}/campaign"], "campaign: want a file that can be read"),
    "excitation: another format": ("excitation", ["{}/record.AT2", "--format", "x"], "'x'", "choose from"),
    "excitation: of another format": ("excitation", ["{}/record.AT2", "--format", "knet"], "record.AT2", "want"),
    "excitation: a unit too many": ("excitation", ["{}/record.AT2", "--units", "g"], "units='g': want none"),
    "excitation: an unknown unit": ("excitation", ["{}/columns.csv", "--units", "kg", "--time-units", "s"], "'kg'"),
    "excitation: no unit": ("excitation", ["{}/columns.csv"], "columns.csv", "want"),
    "excitation: a picture nowhere": (
        "excitation", ["{}/record.AT2", "--plot", "{}/nowhere/a.png"], "--plot .*nowhere/a.png: want a file that",
    ),
    "excitation: a NetCDF": ("excitation", ["{}/whole.nc"], "whole.nc: is in no format read here"),
    "falls: no block": ("falls", ["--pga", "3"], "required: breadth, height"),
    "falls: a breadth in words": ("falls", ["wide", "1.8", "--pga", "3"], "breadth: invalid float value: 'wide'"),
    "falls: a breadth of nothing": ("falls", ["0", "1.8", "--pga", "3"], "b=0.0 m: want a positive number"),
    "falls: a height of nan": ("falls", ["0.3", "nan", "--pga", "3"], "h=nan m: want a positive number"),
    "falls: an infinite height": ("falls", ["0.3", "inf", "--pga", "3"], "h=inf m: want a positive number"),
    "falls: no motion": ("falls", ["0.3", "1.8"], "one of the arguments --pga --record is required"),
    "falls: a peak in words": ("falls", ["0.3", "1.8", "--pga", "strong"], "'strong': want a number"),
    "falls: a negative peak": ("falls", ["0.3", "1.8", "--pga=-3"], "'-3': want a positive number"),
    "falls: an infinite peak": ("falls", ["0.3", "1.8", "--pga", "inf"], "'inf': want a positive number"),
    "falls: two motions": ("falls", ["0.3", "1.8", "--pga", "3", "--record", "x"], "not allowed with"),
    "falls: a period of nan": ("falls", ["0.3", "1.8", "--pga", "3", "--period", "nan"], "--period nan: want a pos"),
    "falls: a velocity of nothing": ("falls", ["0.3", "1.8", "--pga", "3", "--pgv", "0"], "--pgv 0.0: want a positive"),
    "falls: restitution above one": (
        "falls", ["0.3", "1.8", "--pga", "5", "--restitution", "1.1"], "restitution=1.1: want 0 to 1",
    ),
    "falls: a record that is none": ("falls", ["0.3", "1.8", "--record", "{}/text.nc"], "text.nc: is in no format"),
    "falls: a component that is none": (
        "falls", ["0.3", "1.8", "--record", "{}/record.AT2", "--component", "Q"], "want component 'Q'",
    ),
    "studies: a word": ("studies", ["make"], "'make'", "want all or list"),
    "studies: a study that is none": ("studies", ["all", "--only", "fig99", "--out", _NEW], "fig99: want one of"),
    "studies: a file for a folder": (
        "studies", ["all", "--only", "fig18", "--out", "{}/whole.nc"], "whole.nc: want a folder that can be written to",
    ),
    "study: a file for a folder": ("fig18", ["--out", "{}/whole.nc"], "whole.nc: want a folder that can be written"),
    "study: a folder below a file": ("fig18", ["--out", "{}/whole.nc/x"], "want a folder that can be written to"),
    "study: an option that is none": ("fig18", ["--fast"], "unrecognized arguments: --fast"),
    "study: workers of nothing": ("fig18", ["--workers", "0", "--out", _NEW], "--workers 0: want 1 or more"),
    "study: workers in words": ("fig18", ["--workers", "all"], "--workers: invalid int value: 'all'"),
    "study: negative friction": ("fig14", ["--friction=-1", "--out", _NEW], "--friction -1: want a number"),
    "study: friction of nan": ("fig14", ["--friction", "nan", "--out", _NEW], "--friction nan: want a number"),
    "sweep: no target": ("sweep", ["{}/sweep.toml"], "required: --out"),
    "sweep: no file": ("sweep", ["{}/nothing.toml", "--out", "{}/s.nc"], "nothing.toml: want a file that can be read"),
    "sweep: no TOML": ("sweep", ["{}/bad.toml", "--out", "{}/s.nc"], "bad.toml: want TOML"),
    "sweep: a NetCDF": ("sweep", ["{}/whole.nc", "--out", "{}/s.nc"], "whole.nc: want TOML"),
    "sweep: workers of nothing": (
        "sweep", ["{}/sweep.toml", "--out", "{}/s.nc", "--workers", "0"], "workers=0: want 1 or more",
    ),
    "sweep: chunks of nothing": (
        "sweep", ["{}/sweep.toml", "--out", "{}/s.nc", "--chunk", "0"], "chunk_points=0: want 1 or more",
    ),
    "sweep: over another dataset": (
        "sweep", ["{}/sweep.toml", "--out", "{}/whole.nc"], "whole.nc: is there and not of this sweep; want another",
    ),
    "sweep: over its own declaration": (
        "sweep", ["{}/sweep.toml", "--out", "{}/sweep.toml"], "sweep.toml: is there and not of this sweep",
    ),
    "sweep: over a folder": ("sweep", ["{}/sweep.toml", "--out", "{}/campaign"], "campaign: is there and not of this"),
    "sweep: below a file": ("sweep", ["{}/sweep.toml", "--out", "{}/whole.nc/s.nc"], "want a folder that can be writ"),
    "claims: nothing there": ("claims", ["--out", "{}/empty"], "no dataset of a study is there"),
    "claims: of another study": ("claims", ["--out", "{}/datasets"], "fig18.nc: is of study 'made', want 'fig18'"),
    "compare: one file": ("compare", ["{}/whole.nc"], "required: B.nc"),
    "compare: not there": ("compare", ["{}/whole.nc", "{}/no.nc"], "no.nc: is not there"),
    "compare: cut": ("compare", ["{}/whole.nc", "{}/cut.nc"], "cut.nc: want a NetCDF dataset"),
    "compare: a text": ("compare", ["{}/text.nc", "{}/whole.nc"], "text.nc: want a NetCDF dataset"),
    "compare: a folder": ("compare", ["{}/campaign", "{}/whole.nc"], "campaign: is not there or no file"),
    "compare: an address": ("compare", ["http://localhost:1/a.nc", "{}/whole.nc"], "a.nc: is not there"),
    "compare: a tolerance of nan": ("compare", ["{}/whole.nc", "{}/whole.nc", "--rtol", "nan"], "--rtol nan: want"),
    "animation: no run": ("animation", [], "required: RUN.nc"),
    "animation: not there": ("animation", ["{}/no.nc"], "no.nc: want the file of a saved run"),
    "animation: cut": ("animation", ["{}/cut.nc"], "cut.nc: want a NetCDF dataset"),
    "animation: of something else": ("animation", ["{}/whole.nc"], "dataset without x, z, theta"),
    "campaigns: no campaign": ("campaigns", ["{}/empty"], "is not there"),
    "campaigns: a NetCDF": ("campaigns", ["{}/whole.nc"], "whole.nc.*is not"),
    "campaigns: pictures in a file": (
        "campaigns", ["{}/campaign", "--plot", "{}/whole.nc"], "whole.nc: want a folder that can be written to",
    ),
    "campaigns: a bad one with pictures": ("campaigns", ["{}/bad.toml", "--plot", _NEW], "bad.toml: is not TOML"),
    "loop: no target": ("loop", ["{}/campaign"], "required: --out"),
    "loop: no campaign": ("loop", ["{}/empty", "--out", _NEW], "is not there"),
    "loop: in a file": ("loop", ["{}/campaign", "--out", "{}/whole.nc"], "whole.nc: want a folder that can be written"),
    "loop: gravity of nothing": (
        "loop", ["{}/campaign", "--out", _NEW, "--gravity", "0"], "--gravity 0.0: want a positive number",
    ),
    "loop: gravity of nan": ("loop", ["{}/campaign", "--out", _NEW, "--gravity", "nan"], "--gravity nan: want a pos"),
    "loop: too little to learn from": ("loop", ["{}/campaign", "--out", "{}/empty"], "want"),
    "predict: no model": ("loop", ["predict", "{}/no.toml", "{}/campaign", "--out", _NEW], "no.toml: want a file"),
    "predict: a dataset for a model": (
        "loop", ["predict", "{}/whole.nc", "{}/campaign", "--out", _NEW], "whole.nc: want TOML",
    ),
    "predict: a campaign for a model": (
        "loop", ["predict", "{}/campaign/campaign.toml", "{}/campaign", "--out", _NEW], r"has no table \[model\]",
    ),
    "predict: no campaign": ("loop", ["predict", "{}/model.toml", "{}/empty", "--out", _NEW], "is not there"),
    "trials: an effect that is none": ("trials", ["--effects", "gremlin", "--out", _NEW], "'gremlin': want some of"),
    "trials: an effect with a slip of the pen": ("trials", ["--effects", "magnt", "--out", _NEW], "near it: magnet"),
    "trials: no seeds": ("trials", ["--quick", "--seeds", "0", "--out", _NEW], "--seeds 0: want 1 or more"),
    "trials: no jobs": ("trials", ["--quick", "--jobs=-1", "--out", _NEW], "--jobs -1: want 1 or more"),
    "trials: a negative seed": ("trials", ["--quick", "--first-seed=-1", "--out", _NEW], "--first-seed -1: want 0"),
    "trials: in a file": ("trials", ["--quick", "--out", "{}/whole.nc"], "whole.nc: want a folder that can be written"),
    "trials: a folder for a table": (
        "trials", ["--quick", "--out", "{}/empty", "--csv", "{}/campaign"], "--csv .*campaign: want a file",
    ),
    "trials: no program": ("trials", ["--quick", "--command", "", "--out", _NEW], "--command '': want a program"),
}  # fmt: skip
