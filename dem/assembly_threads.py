"""The compiled loop over steps, called from several threads that wait for one another in every step.

Source   none, own convention
Status   Ctrl-C while threads begin, work and end is heard after the chunk of steps (tests)
"""

from __future__ import annotations

import _thread
from typing import Any

from dem import assembly_step
from dem.interrupts import uninterrupted, waited_for


def by_workers(workers: int, arguments: tuple[Any, ...]) -> int:
    """How a chunk of steps ended, advanced by so many threads.

    The threads are begun and waited for by a thread that Ctrl-C does not reach: a KeyboardInterrupt between two of
    them would leave those that have begun waiting for the others for ever.

    Raises:
        KeyboardInterrupt: Ctrl-C; the chunk is ended, or was not begun.  A second one does not wait.
    """
    if workers == 1:
        return int(uninterrupted(assembly_step.advance_assembly, 0, *arguments))
    endings, failed, ended = list[int](), list[BaseException](), list[int]()
    gate = _thread.allocate_lock()

    def work(worker: int) -> None:
        with gate:  # until all have begun
            pass
        try:
            if not failed:
                ending = assembly_step.advance_assembly(worker, *arguments)
                if worker == 0:
                    endings.append(ending)
        except BaseException as error:
            failed.append(error)
        finally:
            ended.append(worker)

    def begin() -> None:
        with gate:
            for worker in range(1, workers):
                try:
                    _thread.start_new_thread(work, (worker,))
                except RuntimeError as error:  # the system gives no more threads
                    failed.append(error)
                    ended.append(worker)
        work(0)

    waited_for(begin, lambda: len(ended) == workers)
    if failed:
        raise failed[0]
    return endings[0]
