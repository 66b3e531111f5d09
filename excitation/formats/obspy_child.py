"""Runs obspy on the bytes from standard input and writes what it found to standard output as .npz.

A process of its own (`excitation.formats.seismology` starts it), because some of obspy's readers are compiled code that
a damaged file can make crash or ask for any amount of memory.
"""

from __future__ import annotations

import io
import json
import sys
import warnings
from importlib import import_module
from typing import Any

import numpy as np

MAX_MEMORY = 4 * 1024**3
"""Bytes of address space, where the system can limit it."""


def limit_memory() -> None:
    """Let absurd counts in a header end in MemoryError."""
    if sys.platform != "win32":
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        limit = MAX_MEMORY if hard == resource.RLIM_INFINITY else min(MAX_MEMORY, hard)
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def describe(trace: Any) -> tuple[dict[str, str], np.ndarray]:
    """(facts, samples) of a trace; gaps are NaN."""
    stats = trace.stats
    facts = {"step": repr(float(stats.delta)), "start": stats.starttime.datetime.isoformat(), "id": trace.id}
    facts |= {name: str(stats.get(name, "")) for name in ("network", "station", "channel", "_format")}
    values = np.ma.asarray(trace.data).astype(np.float64)
    return facts, np.ma.filled(values, np.nan)


def main() -> int:
    """0 with the records on standard output, 1 with a reason on standard error."""
    data = sys.stdin.buffer.read()
    warnings.simplefilter("ignore")
    obspy = import_module("obspy")
    limit_memory()
    try:
        described = [describe(trace) for trace in obspy.read(io.BytesIO(data))]
    # obspy's readers raise whatever their parsing meets; all of it means that this is not such a file.
    except Exception as error:
        print(str(error).splitlines()[0][:100] if str(error) else type(error).__name__, file=sys.stderr)
        return 1
    arrays: dict[str, Any] = {f"samples_{k}": values for k, (_, values) in enumerate(described)}
    packed = io.BytesIO()
    np.savez(packed, facts=np.array(json.dumps([facts for facts, _ in described])), **arrays)
    sys.stdout.buffer.write(packed.getvalue())
    return 0


if __name__ == "__main__":
    sys.exit(main())
