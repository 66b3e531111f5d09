"""A clone of the project in which a break can be made, and pytest run in it with an empty cache of compiled code."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from breaks import Break

PACKAGES = ("rocking", "dem", "excitation", "studies")
OF_PYTEST = ("-x", "-v", "-n", "0", "-p", "no:cacheprovider", "--no-header", "--tb", "line")
# Names may have blanks and dashes; what cannot be collected is named in the summary alone.
FAILED = re.compile(r"^(tests/.+?) (?:FAILED|ERROR)(?: +\[.*)?$|^ERROR (tests/\S+)", re.MULTILINE)
STARTED = re.compile(r"^(tests/\S+::.*?)(?: (?:PASSED|SKIPPED|XFAIL).*)?$", re.MULTILINE)


@dataclass(frozen=True)
class Verdict:
    """What became of a break: "caught", "crash" (the interpreter died), "timeout" or "survived", and in which test."""

    outcome: str
    test: str
    seconds: float


class Clone:
    """A clone of one commit, whose packages are those that its tests import.

    Args:
        root: the project.
        folder: where to put the clone and its cache.
        commit: what is cloned.

    Raises:
        RuntimeError: the packages that its tests would import are not those of the clone.
    """

    def __init__(self, root: Path, folder: Path, commit: str) -> None:
        self.tree, self.cache, self.log = folder / "tree", folder / "cache", folder / "log.txt"
        if not self.tree.is_dir():
            self.tree.parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(["git", "clone", "-q", "--shared", str(root), str(self.tree)], check=True)
        subprocess.run(["git", "checkout", "-q", "--force", "--detach", commit], cwd=self.tree, check=True)
        self.environment = {
            **os.environ,
            "PYTHONPATH": str(self.tree),
            "NUMBA_CACHE_DIR": str(self.cache),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONUNBUFFERED": "1",
        }
        code = f"import {', '.join(PACKAGES)}\nprint(*(p.__file__ for p in ({', '.join(PACKAGES)})))"
        found = subprocess.run(
            [sys.executable, "-c", code],
            cwd=self.tree,
            env=self.environment,
            capture_output=True,
            text=True,
            check=True,
        )
        strangers = [path for path in found.stdout.split() if not Path(path).is_relative_to(self.tree)]
        if strangers:
            raise RuntimeError(f"{strangers}: the tests of the clone would import these; want those in {self.tree}")

    def make_cold(self) -> None:
        """Empty the cache of compiled code, and what Python keeps beside its sources."""
        shutil.rmtree(self.cache, ignore_errors=True)
        for folder in self.tree.rglob("__pycache__"):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.rmtree(self.tree / ".hypothesis", ignore_errors=True)

    def judge(self, broken: Break, groups: list[list[str]], stuck: float) -> Verdict:
        """Make the break, run the groups of tests until one sees it, and take the break back.

        stuck: time [s] after which a test that does not end counts as one that saw the break.
        """
        path = self.tree / broken.file
        source = path.read_bytes()
        begin = time.monotonic()
        self.make_cold()
        try:
            path.write_bytes(broken.apply(source))
            outcome, test = "survived", ""
            for tests in groups:
                outcome, test = self.run(tests, stuck)
                if outcome != "survived":
                    break
        finally:
            path.write_bytes(source)
        return Verdict(outcome, test, round(time.monotonic() - begin, 1))

    def run(self, tests: list[str], stuck: float) -> tuple[str, str]:
        """(outcome, test) of one call of pytest."""
        command = [sys.executable, "-m", "pytest", *OF_PYTEST, *tests]
        with self.log.open("w") as log:
            code = self._watched(command, log, stuck)
        text = self.log.read_text(errors="replace")
        last = [name.strip() for name in STARTED.findall(text)]  # one that did not end has a blank after it
        if code is None:
            return "timeout", last[-1] if last else tests[0]
        if code in (0, 5):  # 5: of the tests named none was left after -k and the marks
            return "survived", ""
        failed = FAILED.search(text)
        if failed:
            return "caught", failed[1] or failed[2]
        if code < 0:
            return "crash", last[-1] if last else tests[0]
        raise RuntimeError(f"pytest ended with {code} and named no test:\n{text[-3000:]}")

    def _watched(self, command: list[str], log: IO[str], stuck: float) -> int | None:
        """Exit status of a command that writes to a log; None if the log stood still for too long."""
        process = subprocess.Popen(
            command, cwd=self.tree, env=self.environment, stdout=log, stderr=subprocess.STDOUT, start_new_session=True
        )
        size, since = 0, time.monotonic()
        try:
            while process.poll() is None:
                time.sleep(0.2)
                now = self.log.stat().st_size
                if now != size:
                    size, since = now, time.monotonic()
                elif time.monotonic() - since > stuck:
                    return None
            return process.returncode
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
