"""Commands under one name: all are offered, run as `python -m` runs them, explain every option, and are completed."""

import argparse
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import studies
from studies.running import commands

PACKAGE = Path(studies.__file__).parent
ROOT = PACKAGE.parent
KNOWN = commands.commands()


def run(*words, entry="main", **environment):
    """The command as its script starts it."""
    code = f"import sys; from studies.running.commands import {entry} as main; sys.argv[0] = 'it'; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, env=os.environ | environment
    )


def test_every_module_that_can_be_run_is_a_command_with_a_sentence():
    lines = {p: p.read_text().splitlines() for p in [*PACKAGE.glob("*.py"), *PACKAGE.glob("*/__main__.py")]}
    runs = {p for p, text in lines.items() if 'if __name__ == "__main__":' in text} - {PACKAGE / "__main__.py"}
    names = {p.parent.name if p.stem == "__main__" else p.stem for p in runs}
    assert set(KNOWN) == names | {"excitation"}
    assert {"fig16", "sweep", "loop", "will_it_fall"} <= names
    assert all(text.endswith((".", "?")) for text in KNOWN.values())


def test_the_scripts_are_declared():
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    for place in scripts.values():
        module, _, name = place.partition(":")
        assert module == "studies.running.commands" and callable(getattr(commands, name))
    assert set(scripts) == {"will-it-fall", "rocking-studies"}


class AskedError(Exception):
    """Raised in place of reading a command line."""


@pytest.mark.parametrize("words", [[name] for name in KNOWN] + [["all"], ["loop", "predict"]], ids=" ".join)
def test_every_command_explains_itself_and_each_of_its_options(words, monkeypatch):
    asked = []

    def ask(parser, args=None, namespace=None):
        asked.append(parser)
        raise AskedError

    for name in [name for name in sys.modules if name.startswith(("studies.", "excitation.__main__"))]:
        # As in a process of its own, where nothing but `studies.running.commands` is loaded.
        if name == f"studies.{words[0]}" or name.endswith("__main__"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", ask)
    monkeypatch.setattr(sys, "argv", ["rocking-studies", *words])
    with pytest.raises(AskedError):
        commands.main()
    (parser,) = asked
    assert parser.description and len(parser.format_help()) > 200
    assert [action.dest for action in parser._actions if not action.help] == []


def test_a_command_runs_as_python_m_runs_it():
    done = run("fig02", "--workers", "0")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "error: --workers 0: want 1 or more\n"
    answers = [
        run("0.30", "1.80", "--pga", "0.1g", entry="will_it_fall"),
        run("will_it_fall", "0.30", "1.80", "--pga", "0.1g"),
        subprocess.run(
            [sys.executable, "-m", "studies.will_it_fall", "0.30", "1.80", "--pga", "0.1g"],
            capture_output=True,
            text=True,
        ),
    ]
    assert len({(done.returncode, done.stdout, done.stderr) for done in answers}) == 1
    assert answers[0].stdout.startswith("block    0.3 x 1.8 m")


def test_without_a_command_they_are_listed_and_another_is_refused():
    listed = run()
    assert listed.returncode == 0
    assert all(f"  {name} " in listed.stdout for name in KNOWN)
    refused = run("fig99")
    assert refused.returncode == 2
    assert "'fig99'" in refused.stderr.splitlines()[-1]


# What a shell does on TAB: its function for the command is called with the words and leaves the answers.
SHELL = """
eval "$({python} -m argcomplete.scripts.register_python_argcomplete rocking-studies will-it-fall)"
COMP_LINE=$1
COMP_POINT=${{#1}}
COMP_TYPE=9
read -ra COMP_WORDS <<< "$1"
[[ $1 == *" " ]] && COMP_WORDS+=("")
COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_python_argcomplete "${{COMP_WORDS[0]}}" "${{COMP_WORDS[COMP_CWORD]}}" "${{COMP_WORDS[COMP_CWORD - 1]}}"
printf "%s\\n" "${{COMPREPLY[@]}}"
"""


@pytest.mark.parametrize(
    ("line", "answers"),
    [
        ("rocking-studies fig1", {"fig10", "fig11", "fig12", "fig14", "fig15", "fig16", "fig17", "fig18", "fig19"}),
        ("rocking-studies fig16 --r", {"--restitution", "--ramp"}),
        ("rocking-studies loop predict --q", {"--quiet"}),
        ("rocking-studies excitation --format c", {"columns", "cosmos", "csmip"}),
        ("rocking-studies all --o", {"--only", "--out"}),
        ("will-it-fall --p", {"--pga", "--period", "--pgv"}),
        ("will-it-fall 0.3 1.8 --record here/", {"here/a.AT2", "here/b.AT2"}),
    ],
)
def test_a_shell_completes_commands_options_choices_and_files(line, answers, tmp_path):
    pytest.importorskip("argcomplete")
    bash = shutil.which("bash") or pytest.skip("no bash")
    (tmp_path / "here").mkdir()
    for name in ("a.AT2", "b.AT2"):
        (tmp_path / "here" / name).touch()
    for script, entry in (("rocking-studies", "main"), ("will-it-fall", "will_it_fall")):
        path = tmp_path / script
        path.write_text(f"#!{sys.executable}\nfrom studies.running.commands import {entry}\n{entry}()\n")
        path.chmod(0o755)
    done = subprocess.run(
        [bash, "-c", SHELL.format(python=sys.executable), "bash", line],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
    )
    assert {answer.strip() for answer in done.stdout.split("\n") if answer.strip()} == answers, done.stderr
