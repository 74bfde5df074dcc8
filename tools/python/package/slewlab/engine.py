"""Many tasks side by side, each result as it comes: in threads, in processes of this machine, on a cluster by Dask.

`run_in_threads`, `run_in_processes` and `run_on_cluster` yield (index of the task, what `function` made of it), in the order
in which tasks end. Nothing of a result depends on which of them ran it, or on how many did so at a time.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from types import ModuleType
from typing import Any

Done = Iterator[tuple[int, Any]]


@dataclass(frozen=True)
class WorkerDied:
    """In place of a result: the process that computed it ended, and so did the one that tried it again alone."""

    reason: str


def worker_count(asked: int | None) -> int:
    if asked is not None and asked < 0:
        raise ValueError(f"found {asked} workers, expected at least 1, or none said for one per core")
    return asked or len(os.sched_getaffinity(0))


def run_in_threads(function: Callable[[Any], Any], tasks: Sequence[Any], threads: int | None = None) -> Done:
    """For functions that let the interpreter's lock go, as a run does. What a task raises comes out, and ends all."""
    with ThreadPoolExecutor(worker_count(threads)) as pool:
        yield from _feed(pool, function, dict(enumerate(tasks)), worker_count(threads))


def run_in_processes(function: Callable[[Any], Any], tasks: Sequence[Any], workers: int | None = None) -> Done:
    """`function` and tasks can be pickled. A worker that dies takes only its task with it: tasks that were under way then are
    tried again, one at a time in a process of its own, and the one that kills its process again has WorkerDied as its result.
    No workers: all in this process, which a debugger can hold."""
    if workers == 0:
        yield from ((index, function(task)) for index, task in enumerate(tasks))
        return
    pending = dict(enumerate(tasks))
    while pending:  # again where a worker died
        suspects: dict[int, Any] = {}
        with _Processes(min(worker_count(workers), len(pending))) as pool:
            try:
                for index, result in _feed(pool, function, pending, worker_count(workers), suspects):
                    yield index, result
            except BrokenProcessPool:
                pass
        for index, task in suspects.items():
            with _Processes(1) as pool:
                try:
                    result = pool.submit(function, task).result()
                except BrokenProcessPool as broken:
                    result = WorkerDied(str(broken))
            yield index, result


def run_on_cluster(function: Callable[[Any], Any], tasks: Sequence[Any], client: Any) -> Done:
    """`client` is a distributed.Client; its workers have this package and the same files. A worker that dies is Dask's affair:
    it tries the task elsewhere, and after some deaths the result is WorkerDied."""
    from distributed import as_completed
    from distributed.scheduler import KilledWorker

    waiting = iter(enumerate(tasks))
    indices = {}

    def submit() -> Any:
        for index, task in waiting:
            future = client.submit(function, task, pure=False)
            indices[future.key] = index
            return future
        return None

    # A few tasks more than there are threads: no worker waits, and the scheduler holds no million of them.
    at_once = 4 * max(1, sum(client.nthreads().values()))
    running = as_completed([future for future in (submit() for _ in range(at_once)) if future is not None], raise_errors=False)
    for future in running:
        error = future.exception()
        if error is None:
            result = future.result()
        elif isinstance(error, KilledWorker):
            result = WorkerDied(str(error))
        else:
            raise error
        index = indices.pop(future.key)
        future.release()
        following = submit()
        if following is not None:
            running.add(following)
        yield index, result


class _Processes(ProcessPoolExecutor):
    """Started anew and not forked: this process may have threads (pyarrow's), whose locks a fork would inherit. A worker does
    not import the program that asks, which may be a notebook or have no guard against that."""

    def __init__(self, count: int) -> None:
        super().__init__(count, mp_context=get_context("spawn"), initializer=_live_with, initargs=(os.getpid(),))
        try:
            self.submit(os.getpid).result()
        except BrokenProcessPool as broken:
            raise RuntimeError(f"no worker process can be started: {broken}") from broken

    def submit(self, *arguments: Any, **named: Any) -> Any:
        program = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        # A process that is started here inherits it: Ctrl-C is the parent's affair from the child's first moment on.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(*arguments, **named)
        finally:
            sys.modules["__main__"] = program
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _live_with(parent: int) -> None:
    """Nobody is left behind: the kernel ends this process with its parent, however that ends."""
    parent_death_signal = 1  # PR_SET_PDEATHSIG, linux/prctl.h
    ctypes.CDLL(None, use_errno=True).prctl(parent_death_signal, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _feed(pool: Any, function: Callable[[Any], Any], pending: dict[int, Any], workers: int, under_way: dict[int, Any] | None = None) -> Done:
    """Takes tasks out of `pending`, no more at a time than keep every worker busy. `under_way` holds those begun and not
    yet yielded."""
    under_way = {} if under_way is None else under_way
    futures: dict[Any, int] = {}
    try:
        while pending or futures:
            while pending and len(futures) < 2 * workers:
                index = next(iter(pending))
                under_way[index] = pending.pop(index)
                futures[pool.submit(function, under_way[index])] = index
            done, _ = wait(futures, return_when=FIRST_COMPLETED)
            for future in sorted(done, key=futures.__getitem__):
                result = future.result()
                index = futures.pop(future)
                del under_way[index]
                yield index, result
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
