"""Campaigns: independent work items on any executor, each finished item one Parquet part.

An interrupted campaign resumes by skipping the finished parts. Results do not
depend on the executor, on the number of workers or on the order of completion.
"""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from multiprocessing import connection, get_context, parent_process
from pathlib import Path
from typing import Any

from bench.errors import BenchError, InputError
from bench.table import Table

TRIES = 2  # a failed item is tried once more before it is reported


@dataclass(frozen=True)
class Item:
    """One piece of work.

    Attributes
    ----------
    key : str
        Unique among the items of a campaign; names its part file.
    work : picklable
        What `measure` is given.
    """

    key: str
    work: Any


class CampaignError(BenchError):
    """An item failed on every try; the message names it, so that it can be run alone."""


class CampaignInterrupted(BenchError):
    """Ctrl-C: finished parts are intact, and the message says where."""


def cpu_count() -> int:
    """Return the number of CPUs that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def open_executor(jobs: int, scheduler: str | None = None) -> AbstractContextManager[Executor | None]:
    """Return a context that gives an executor: None for one job, processes, or a Dask cluster.

    Parameters
    ----------
    jobs : int
        Worker processes; 1 works in this process.
    scheduler : str, optional
        Address of a Dask scheduler, used instead of processes (needs the extra ``cluster``).

    Raises
    ------
    InputError
        If dask is not installed or the scheduler does not answer.
    """
    if scheduler is not None:
        return _dask_executor(scheduler)
    if jobs == 1:
        return nullcontext()
    # spawn: a forked child would inherit threads and locks that it cannot use.
    return ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_obey_the_parent)


def _obey_the_parent() -> None:
    """Leave Ctrl-C to the parent, and end with it, however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    assert parent is not None

    def follow() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def _dask_executor(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError:
        raise InputError("scheduler needs dask: install strapbench[cluster]") from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(f"scheduler must be the address of a Dask scheduler, got {address!r}: {error}") from error
    with client, client.get_executor() as executor:
        yield executor


def run_campaign(
    measure: Callable[[Any], Table],
    items: Sequence[Item],
    *,
    executor: Executor | None = None,
    folder: Path | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
    first_here: bool = False,
) -> Table:
    """Return the rows of all items, in the order of the items.

    Parameters
    ----------
    measure : callable
        Module-level function of an item's work, returning a `Table`.
    items : sequence of Item
    executor : concurrent.futures.Executor, optional
        None works in this process.
    folder : Path, optional
        Where the parts are kept; parts already there are not computed again.
    progress : callable
        Told the number of finished items and of all items.
    first_here : bool
        Do the first item in this process, so that kernels are compiled once and the workers load them.

    Raises
    ------
    CampaignError
        If an item fails on every try.
    CampaignInterrupted
        On Ctrl-C.
    """
    parts: dict[str, Table] = {}
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        parts = _finished(folder, items)
    progress(len(parts), len(items))

    def finish(item: Item, table: Table) -> None:
        if folder is not None:
            table.write_parquet(_part(folder, item))
        parts[item.key] = table
        progress(len(parts), len(items))

    todo = [item for item in items if item.key not in parts]
    try:
        here = len(todo) if executor is None else int(first_here)
        for item in todo[:here]:
            finish(item, _try_here(measure, item))
        if executor is not None:
            _run_on(executor, measure, todo[here:], finish)
    except KeyboardInterrupt:
        kept = f"kept in {folder}; run the same command again to continue" if folder else "lost: no folder was given"
        raise CampaignInterrupted(f"interrupted; {len(parts)} of {len(items)} parts are finished and {kept}") from None
    return Table.concatenate([parts[item.key] for item in items])


def _finished(folder: Path, items: Sequence[Item]) -> dict[str, Table]:
    """Return the parts that are there; one that cannot be read was damaged from outside and is made again."""
    parts = {}
    for item in items:
        with suppress(OSError, ValueError):
            parts[item.key] = Table.read_parquet(_part(folder, item))
    return parts


def _part(folder: Path, item: Item) -> Path:
    return folder / f"{item.key}.parquet"


def _failed(item: Item, error: BaseException) -> CampaignError:
    last = f"the last time with {error!r}"
    return CampaignError(f"item {item.key} failed {TRIES} times, {last}; to rerun it: {item.work}")


def _try_here(measure: Callable[[Any], Table], item: Item) -> Table:
    for last in (False, True):
        try:
            return measure(item.work)
        except Exception as error:
            if last:
                raise _failed(item, error) from error
    raise AssertionError("unreachable")


def _run_on(
    executor: Executor, measure: Callable[[Any], Table], todo: Sequence[Item], finish: Callable[[Item, Table], None]
) -> None:
    pending: dict[Future[Table], tuple[Item, int]] = {executor.submit(measure, item.work): (item, 1) for item in todo}
    try:
        while pending:
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in done:
                item, tries = pending.pop(future)
                error = future.exception()
                if error is None:
                    finish(item, future.result())
                elif tries == TRIES:
                    raise _failed(item, error) from error
                else:
                    pending[executor.submit(measure, item.work)] = (item, tries + 1)
    except KeyboardInterrupt:
        for future, (item, _) in pending.items():
            if future.done() and future.exception() is None:
                finish(item, future.result())
        if isinstance(executor, ProcessPoolExecutor):  # what they have in hand is small, and made again on resuming
            for process in list((executor._processes or {}).values()):
                process.terminate()
            pending.clear()  # the broken pool settles them itself, and stumbles over those that are cancelled
        raise
    finally:
        for future in pending:
            future.cancel()
