"""The README: its two commands and its Python."""

import re
import subprocess
import sys
from pathlib import Path

README = (Path(__file__).parent.parent / "README.md").read_text()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


def test_there_are_two_shell_commands_one_for_fig16_and_one_for_the_tests():
    first, second = blocks("sh")
    assert first.strip().endswith("-m studies.fig16")
    assert second.strip().endswith("-m pytest")


def test_five_lines_of_python_run_as_printed(tmp_path):
    code = blocks("python")[0]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.fullmatch(r"rocks from \d+\.\d\d s, overturned at \d+\.\d\d s\n", done.stdout)


def test_analysis_of_the_saved_criteria_runs_as_printed(tmp_path):
    from studies import fig16

    out = tmp_path / "build" / "studies"
    fig16.main(["--quick", "--no-sensitivity", "--out", str(out)])
    done = subprocess.run([sys.executable, "-c", blocks("python")[1]], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "overturning_amplitude" in done.stdout
