"""The solver of docs/examples/third_party_solver, installed as a user would and run in a process of its own."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "examples" / "third_party_solver"
GUIDE = ROOT / "docs" / "extending_solver.md"

OWN = 'fixed-step = "fixed_step:FixedStep"\n'
BROKEN = 'broken = "module_that_is_not_there:Solver"\n'

# What a user does with it; every answer is printed as one JSON object.
SCRIPT = """
import json
import numpy as np
from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, solve
from rocking.solvers import available, load

said = {"available": available()}
block = Block(b=0.2, h=0.8)
shaking = RampedSinusoid(frequency=2.0, duration=10.0, final_amplitude=20.0)
runs = [
    solve(Method1(block), shaking, t_end=3.0, solver=name, rtol=1e-11, atol=1e-14)
    for name in ("fixed-step", "scipy")
]
said["solver"] = [run.solver for run in runs]
said["outcome"] = [run.outcome.value for run in runs]
said["impacts"] = [run.impact_times.tolist() for run in runs]
said["onset"] = [run.onset_time for run in runs]
said["peak"] = [run.peak_rotation for run in runs]
said["difference"] = float(np.abs(runs[0].y - runs[1].y).max())
freely = [
    solve(Method1(block, form="linear", restitution=0.5), theta=0.12, t_end=3.0, solver=name, rtol=1e-11, atol=1e-14)
    for name in ("fixed-step", "scipy")
]
said["rests"] = [run.outcome.value for run in freely]
said["codes"] = [run.events.guard.tolist() for run in freely]
said["errors"] = {}
for name, system in (("fixed-step", Method2(block, friction=0.5)), ("broken", Method1(block))):
    try:
        solve(system, t_end=1.0, solver=name)
    except Exception as error:
        said["errors"][name] = [type(error).__name__, str(error)]
said["fifth"] = [
    float(solve(Method1(block), theta=0.12, t_end=2.0, solver="fixed-step", rtol=rtol).impact_times[4])
    for rtol in (1e-4, 1e-6, 1e-12)
]
print(json.dumps(said))
"""


def write_metadata(source: Path, target: Path) -> None:
    """What an installer leaves: the module, and its entry points in a .dist-info folder."""
    about = tomllib.loads((source / "pyproject.toml").read_text())
    name, number = about["project"]["name"], about["project"]["version"]
    info = target / f"{name.replace('-', '_')}-{number}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {number}\n")
    lines = []
    for group, points in about["project"]["entry-points"].items():
        lines += [f"[{group}]", *(f"{key} = {value}" for key, value in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    for module in about["tool"]["setuptools"]["py-modules"]:
        shutil.copy(source / f"{module}.py", target)


def install_with_pip(source: Path, target: Path) -> None:
    """pip, without the network: with the setuptools that is here."""
    if tuple(map(int, version("setuptools").split(".")[:2])) < (70, 1):
        pytest.skip(f"setuptools {version('setuptools')} here builds no wheel by itself, 70.1 and later do")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index"]
    told = subprocess.run([*command, "--target", target, source], capture_output=True, text=True)
    assert told.returncode == 0, told.stderr


@pytest.fixture(scope="module", params=[write_metadata, install_with_pip])
def said(request, tmp_path_factory) -> dict:
    """What the script prints with the example installed in a folder of its own, beside a plugin that is broken."""
    folder = tmp_path_factory.mktemp("third_party")
    source, target = folder / "source", folder / "site"
    shutil.copytree(EXAMPLE, source, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
    text = (source / "pyproject.toml").read_text()
    assert text.count(OWN) == 1
    (source / "pyproject.toml").write_text(text.replace(OWN, OWN + BROKEN))
    request.param(source, target)
    path = os.pathsep.join([str(target), *filter(None, [os.environ.get("PYTHONPATH")])])
    told = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path},
    )
    assert told.returncode == 0, told.stderr
    return json.loads(told.stdout)


def test_it_is_listed_beside_the_built_in_ones(said):
    assert {"fixed-step", "broken", "numba", "scipy"} <= set(said["available"])


def test_it_runs_and_agrees_with_scipy(said):
    assert said["solver"] == ["fixed-step", "scipy"]
    assert said["outcome"][0] == said["outcome"][1]
    assert len(said["impacts"][0]) >= 5
    # Both carry errors of some 1e-11 of a step through seven impacts.
    assert said["impacts"][0] == pytest.approx(said["impacts"][1], abs=1e-8)
    assert said["onset"][0] == pytest.approx(said["onset"][1], abs=1e-12)
    assert said["peak"][0] == pytest.approx(said["peak"][1], abs=1e-8)
    assert said["difference"] < 1e-7
    assert said["rests"] == ["at rest", "at rest"]
    assert said["codes"][0] == said["codes"][1]


def test_its_error_falls_with_the_tolerance_it_is_given(said):
    coarse, fine, truth = said["fifth"]
    # Order four, and a step that goes as rtol^(1/4): a hundred times less tolerance, about a hundred times less error.
    assert 30.0 < abs(coarse - truth) / abs(fine - truth) < 300.0


def test_what_it_declines_reaches_the_user_as_its_own_sentence(said):
    assert said["errors"]["fixed-step"] == [
        "ValueError",
        "solver='fixed-step' declines: it carries Method 1 as it is, not Method2",
    ]


def test_a_broken_neighbour_is_named_when_it_is_asked_for_and_harms_no_other(said):
    kind, text = said["errors"]["broken"]
    assert kind == "ImportError"
    assert re.search(r"'broken' \(module_that_is_not_there:Solver\) does not load: No module named", text)


def test_the_guide_shows_what_the_example_holds():
    held = (EXAMPLE / "fixed_step.py").read_text() + (EXAMPLE / "pyproject.toml").read_text()
    shown = re.findall(r"```(?:python|toml)\n(.*?)```", GUIDE.read_text(), re.DOTALL)
    assert len(shown) == 3
    for excerpt in shown:
        assert excerpt in held
