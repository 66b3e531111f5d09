"""A sweep carried out: chunks side by side on this machine's cores or on a dask cluster, kept as they are done.

Only so many chunks are under way as keep the workers busy, so the sweep may be larger than memory.  What is there is
not computed again; a chunk of a worker that died is given to another.  Two runs on one file take turns: the second
finds it done.

Source   none, own convention
Status   killed and gone on with, on cores and on a cluster (tests)
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, nullcontext
from itertools import islice
from pathlib import Path
from typing import Any

import xarray as xr
from tqdm import tqdm

from studies.running.files import clear_unfinished, sealed
from studies.running.interrupts import Noted, first_done, noted
from studies.running.lock import alone
from studies.running.parts import sources_hash
from studies.sweep.chunks import Box, Folder, as_dataset, boxes, count_boxes
from studies.sweep.declared import Sweep
from studies.sweep.evaluation import evaluate
from studies.sweep.gathering import attributes_of, gather

CHUNK_POINTS = 64
"""Points of a chunk unless the caller says otherwise: seconds of work, so that little is lost."""

AHEAD = 2
"""Chunks under way for each worker."""

Task = tuple[int, Box]
Results = Generator[tuple[Task, Mapping[str, Any]], None, None]


def _on_cores(declared: Mapping[str, Any], tasks: Iterator[Task], workers: int, interrupt: Noted) -> Results:
    """Results in the order in which they are done; compiled code runs side by side in threads.

    After Ctrl-C, or when one fails, those under way are finished and given before it goes on.
    """
    pool = ThreadPoolExecutor(workers)
    under_way: dict[Any, Task] = {}
    try:
        for task in tasks:
            under_way[pool.submit(evaluate, declared, task[1])] = task
            if len(under_way) >= AHEAD * workers:
                for future in first_done(under_way, interrupt):
                    yield under_way.pop(future), future.result()
        while under_way:
            for future in first_done(under_way, interrupt):
                yield under_way.pop(future), future.result()
    except (KeyboardInterrupt, Exception):
        pool.shutdown(wait=True, cancel_futures=True)
        for future, task in under_way.items():
            if not future.cancelled() and future.exception() is None:
                yield task, future.result()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_cluster(declared: Mapping[str, Any], tasks: Iterator[Task], address: str) -> Results:
    """The same on a dask cluster.

    Raises:
        ValueError: dask.distributed is not installed, or there is no scheduler.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise ValueError("scheduler: want dask.distributed, pip install 'rocking-blocks[cluster]'") from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise ValueError(f"scheduler={address!r}: want the address of a dask scheduler ({error})") from None
    with client:
        ahead = AHEAD * max(1, sum(client.nthreads().values()))
        under_way: dict[Any, Task] = {}
        queue = as_completed()

        def submit(task: Task) -> None:
            future = client.submit(evaluate, declared, task[1], pure=False, retries=3)
            under_way[future.key] = task
            queue.add(future)

        for task in islice(tasks, ahead):
            submit(task)
        for future in queue:
            yield under_way.pop(future.key), future.result()
            following = next(tasks, None)
            if following is not None:
                submit(following)


def identity_of(sweep: Sweep, chunk_points: int) -> dict[str, Any]:
    """What a chunk has to be of, to be taken for one of this sweep."""
    sources = sources_hash(evaluate.__module__)
    return {"declaration": json.loads(sweep.as_json()), "sources": sources, "chunk size": chunk_points}


def run(
    sweep: Sweep,
    out: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_points: int = CHUNK_POINTS,
    command: str = "studies.sweep.run",
    progress: bool = True,
    watch: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Carry out a sweep, or go on with it, and write its dataset; it is opened, not loaded.

    Args:
        sweep: what is computed.
        out: the NetCDF file; chunks are kept in a folder beside it until it is whole.
        workers: chunks side by side on this machine; as many as there are cores if not given.
        scheduler: address of a dask scheduler, on whose workers this package is installed; this machine if not given.
        chunk_points: points of a chunk.
        command: for the attributes.
        progress: whether to show a bar.
        watch: called with the number of each chunk that has been written.

    Raises:
        ValueError: an argument is not one that it can be, another sweep has begun there, or the file is there and holds
            something else, which is left as it is.
        RuntimeError: a chunk was damaged; it has been removed, and the same call computes it again.
        OSError: a file cannot be written; chunks that are done are kept.
    """
    if workers is not None and workers < 1:
        raise ValueError(f"workers={workers}: want 1 or more")
    if chunk_points < 1:
        raise ValueError(f"chunk_points={chunk_points}: want 1 or more")
    target = Path(out)
    identity = identity_of(sweep, chunk_points)
    attributes = attributes_of(sweep, identity, command)
    _check_target(target, attributes)
    target.parent.mkdir(parents=True, exist_ok=True)
    with alone(target):
        if not _there(target, attributes):
            clear_unfinished(target)
            folder = Folder(target.with_name(f"{target.name}.parts"))
            folder.begin(identity)
            _compute(sweep, folder, workers, scheduler, chunk_points, progress, watch)
            gather(sweep, folder, chunk_points, target, attributes)
            folder.sweep_away()
    with noted():
        return xr.open_dataset(target)


def _compute(
    sweep: Sweep,
    folder: Folder,
    workers: int | None,
    scheduler: str | None,
    chunk_points: int,
    progress: bool,
    watch: Callable[[int], None] | None,
) -> None:
    """Every chunk that is not there yet."""
    declared = json.loads(sweep.as_json())
    missing = ((i, box) for i, box in enumerate(boxes(sweep.shape, chunk_points)) if not folder.done(i))
    total = count_boxes(sweep.shape, chunk_points)
    there = sum(folder.done(i) for i in range(total))
    with (
        noted() if scheduler is None else nullcontext(Noted()) as interrupt,
        closing(
            _on_cores(declared, missing, workers or os.cpu_count() or 1, interrupt)
            if scheduler is None
            else _on_cluster(declared, missing, scheduler)
        ) as results,
        tqdm(total=total, initial=there, unit="chunk", disable=None if progress else True) as bar,
    ):
        for (number, box), result in results:
            folder.keep(number, as_dataset(sweep, box, result))
            bar.update()
            if watch is not None:
                watch(number)


def _stated(target: Path) -> Mapping[str, Any]:
    """The attributes of a dataset; none of what is no dataset."""
    try:
        with noted(), xr.open_dataset(target, engine="netcdf4") as ds:
            return dict(ds.attrs)
    except Exception:  # whatever the libraries meet in a stranger's file means that it is none
        return {}


def _there(target: Path, attributes: Mapping[str, str]) -> bool:
    """Whether the file is the dataset of this sweep by these sources."""
    stated = _stated(target) if target.is_file() and sealed(target) is not False else {}
    return all(stated.get(key) == attributes[key] for key in ("declared", "sources"))


def _check_target(target: Path, attributes: Mapping[str, str]) -> None:
    """ValueError where something else is under that name, which the sweep would write over."""
    if target.exists() and not (target.is_file() and _stated(target).get("declared") == attributes["declared"]):
        raise ValueError(f"{target}: is there and not of this sweep; want another --out, or remove it")
