"""Strangers' files are data: nothing of them is run, leads elsewhere, takes memory without end or becomes markup."""

import ast
import html
import json
import os
import resource
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import bad_files
import files
import numpy as np
import pytest
import xarray as xr

import rocking
from studies.running import files as running_files

ROOT = Path(rocking.__file__).resolve().parent.parent
PACKAGES = ("rocking", "dem", "excitation", "studies")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

FORBIDDEN_CALLS = {"eval", "exec", "compile", "__import__"}
FORBIDDEN_MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "joblib", "shelve", "marshal"}


@cache
def tree(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def test_nothing_evaluates_text_or_unpickles():
    assert len(SOURCES) > 200
    for path in SOURCES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in FORBIDDEN_CALLS, f"{path}:{node.lineno}"
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                assert name.partition(".")[0] not in FORBIDDEN_MODULES, f"{path}:{node.lineno}"


def test_numpy_files_are_never_unpickled_and_no_shell_is_asked():
    for path in SOURCES:
        for node in ast.walk(tree(path)):
            if not isinstance(node, ast.Call):
                continue
            called = ast.unparse(node.func)
            given = {keyword.arg: keyword.value for keyword in node.keywords}
            if called in ("np.load", "numpy.load"):
                assert ast.unparse(given["allow_pickle"]) == "False", f"{path}:{node.lineno}"
            if called.startswith("subprocess.") or called.endswith("Popen"):
                assert "shell" not in given, f"{path}:{node.lineno}"
            assert called not in ("os.system", "os.popen", "yaml.load"), f"{path}:{node.lineno}"


def test_templates_escape_and_pages_forbid_scripts_from_elsewhere():
    for path in SOURCES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Environment"):
                given = {keyword.arg: ast.unparse(keyword.value) for keyword in node.keywords}
                assert given.get("autoescape") == "True", f"{path}:{node.lineno}"
    for path in (p for package in PACKAGES for p in (ROOT / package).rglob("*.jinja")):
        text = path.read_text(encoding="utf-8")
        assert "|safe" not in text.replace(" ", "") and "default-src 'none'" in text, path


HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&"


class Tags(HTMLParser):
    """Every tag of a page, and every attribute that runs something."""

    def __init__(self):
        super().__init__()
        self.tags, self.handlers = [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.handlers += [name for name, value in attributes if name.startswith("on") or "javascript:" in (value or "")]


def tags_of(page):
    parser = Tags()
    parser.feed(page)
    assert parser.handlers == []
    return parser.tags


def test_the_page_of_an_animation_shows_hostile_names_as_text():
    from studies.animation import film_of
    from studies.animation.page import page

    def made(name, title):
        ds = bad_files.run_dataset().assign_coords(body=[name]).assign_attrs(title=title, reason=title)
        return page(film_of(ds))

    plain, hostile = made("block", "title"), made(HOSTILE, HOSTILE)
    assert tags_of(plain) == tags_of(hostile) and html.escape(HOSTILE, quote=False)[:20] in hostile


def test_the_index_shows_what_a_dataset_says_as_text(tmp_path):
    from studies.running.files import save_dataset
    from studies.running.index_page import write_index
    from studies.running.registry import studies
    from studies.running.statements import Claim, Finding, table

    def made(text):
        folder = tmp_path / str(len(text))
        folder.mkdir()
        rows = table([Finding(Claim("fig18.x", text, text, text), 1.0, text)])
        save_dataset(rows.assign_attrs(study="fig18", command=text, source=text, commit=text), folder / "fig18.nc")
        return write_index(folder, {"fig18": studies()["fig18"]}).read_text(encoding="utf-8")

    assert tags_of(made("plain")) == tags_of(made(HOSTILE))


def test_a_damaged_dataset_is_left_out_of_the_index_with_a_line(tmp_path, capsys):
    from studies.running.index_page import write_index
    from studies.running.registry import studies

    (tmp_path / "fig18.nc").write_bytes(files.netcdf()[:-9])
    text = write_index(tmp_path, {"fig18": studies()["fig18"]}).read_text(encoding="utf-8")
    assert "<section" not in text
    assert "fig18: is left out of index.html, make it again" in capsys.readouterr().err


MEMORY = 6 * 2**30
"""Bytes of address space; the libraries alone take two."""

BOUNDED = """
import resource, sys
sys.path.insert(0, {here!r})
import bad_files
from pathlib import Path
resource.setrlimit(resource.RLIMIT_AS, ({limit}, {limit}))
for name in {names!r}:
    reader, make, *words = bad_files.FILES[name]
    folder = Path(sys.argv[1]) / name.replace(":", "").replace(" ", "-")
    folder.mkdir()
    try:
        bad_files.READERS[reader](make(folder))
    except ValueError as error:
        print(name, "|", error)
# Not ru_maxrss, which a child begins with that of its parent.
status = Path("/proc/self/status").read_text().splitlines()
print(next(line.split()[1] for line in status if line.startswith("VmHWM")))
"""


def test_absurd_sizes_in_headers_take_no_memory(tmp_path):
    names = [n for n in bad_files.FILES if "without end" in n or "absurd" in n or "too many points" in n]
    assert len(names) >= 8
    script = BOUNDED.format(here=str(Path(__file__).parent), limit=MEMORY, names=names)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, timeout=300, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    *said, largest = done.stdout.strip().splitlines()
    assert [line.partition(" | ")[0] for line in said] == names and "MemoryError" not in done.stdout
    assert int(largest) * 1024 < 10**9  # the libraries with all that is imported take half of it
    assert resource.getrlimit(resource.RLIMIT_AS)[0] != MEMORY


def test_ids_and_titles_of_a_campaign_never_become_paths_or_markup(tmp_path):
    """An id with a slash is refused (bad_files); one that only looks odd names a file inside the folder."""
    from studies.campaigns import read
    from studies.campaigns.drawing import figure
    from studies.campaigns.summary import look

    odd = "<script>alert(1)<&'"
    for name, data in files.campaign().items():
        (tmp_path / name).write_bytes(data.replace(b'id = "free"', f'id = "{odd}"'.encode()))
    campaign = read(tmp_path)
    assert [test.id for test in campaign.tests] == ["ramp", odd]
    target = (tmp_path / f"{campaign.tests[1].id}.png").resolve()
    assert target.parent == tmp_path.resolve()
    assert figure(look(campaign.tests[1], campaign), campaign) is not None


def test_attributes_of_a_strangers_motion_make_motions_of_this_package_alone():
    import excitation as ex

    ds = ex.OneSinePulse(1.0, 1.0).to_xarray(np.linspace(0.0, 1.0, 11))
    for name in ("os.system", "builtins.eval", "Record", "Table", "dict", "__class__"):
        with pytest.raises(ValueError, match="motion_class="):
            ex.from_xarray(ds.assign_attrs(motion_class=name, motion_arguments=json.dumps({"command": "true"})))


def test_a_path_of_a_dataset_is_a_file_and_never_an_address(monkeypatch):
    """`http://...` would be asked of the network by the NetCDF library."""
    import socket

    import studies
    from studies.running.files import DatasetError, load_dataset

    def refuse(*arguments, **more):
        raise AssertionError("the network was asked")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    for address in ("http://localhost:1/a.nc", "https://localhost/a.nc#mode=bytes", "file:///etc/passwd"):
        with pytest.raises((DatasetError, FileNotFoundError)):
            load_dataset(Path(address))
        with pytest.raises((DatasetError, FileNotFoundError)):
            studies.open(address)
    assert xr.__version__


def test_a_file_that_sends_the_library_round_for_ever_is_refused(monkeypatch):
    """One byte of a dataset was changed at random; HDF5 does not come back from opening it, and hears no Ctrl-C."""
    monkeypatch.setattr(running_files, "LONGEST_OPENING", 3.0)
    with pytest.raises(running_files.DatasetError, match=r"endless\.nc: want a NetCDF dataset, .* not get through"):
        running_files.load_dataset(Path(__file__).parent / "data" / "endless.nc")
