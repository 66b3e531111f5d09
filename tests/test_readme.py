"""The README: its two commands and its Python."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
FIRST_FIGURE = (ROOT / "docs" / "start" / "first_figure.md").read_text()


def blocks(language, text=README):
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


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
    # The README's, and that of the page on the first figure.
    for code in (blocks("python")[1], blocks("python", FIRST_FIGURE)[0]):
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "overturning_amplitude" in done.stdout


def test_the_first_question_is_answered_as_the_readme_says():
    (question,) = re.findall(r"`\.venv/bin/python (-m studies\.will_it_fall[^`]+)`", README)
    done = subprocess.run([sys.executable, *question.split()], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("block    0.3 x 1.8 m")
