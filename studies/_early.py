"""Ctrl-C while `python -m studies...` still loads its libraries, which takes a second or two: one line, no traceback.

Source   none; `sys.argv[0]` is "-m" as long as the module that is to be run is looked for, hence in no other process
Status   interrupted while loading (tests); the exit status is that of SIGINT, 130 in a shell
"""

from __future__ import annotations

import sys
from types import TracebackType


def said(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """An exception that nobody caught."""
    if issubclass(kind, KeyboardInterrupt):
        print("interrupted: nothing was written", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


if sys.argv[:1] == ["-m"]:
    sys.excepthook = said
