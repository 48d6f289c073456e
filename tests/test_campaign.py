"""Campaigns: parts, resuming, retrying, interruption, and independence of the executor."""

import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import bench
from bench.campaign import CampaignError, CampaignInterrupted, Item, cpu_count, open_executor, run_campaign
from bench.table import Table

ROOT = Path(__file__).parents[1]


def square(work):
    return Table({"value": np.array([work, work**2], dtype=float), "name": np.array([f"item {work}"] * 2)})


def fail_once(work):
    mark, number = work
    if number == 2 and not Path(mark).exists():
        Path(mark).touch()
        raise OSError("the disk hiccups")
    return square(number)


def fail_always(work):
    raise ValueError(f"seed {work} is cursed")


def interrupt_at_three(work):
    if work == 3:
        raise KeyboardInterrupt
    return square(work)


def where(work):
    return Table({"pid": np.array([os.getpid()])})


ITEMS = [Item(f"n{k}", k) for k in range(6)]


def same(a: Table, b: Table) -> bool:
    return list(a.columns) == list(b.columns) and all(np.array_equal(a[name], b[name]) for name in a.columns)


def test_rows_are_in_the_order_of_the_items():
    rows = run_campaign(square, ITEMS)
    np.testing.assert_array_equal(rows["value"], np.ravel([[k, k**2] for k in range(6)]))


def test_executor_and_folder_do_not_change_the_rows(tmp_path):
    plain = run_campaign(square, ITEMS)
    with open_executor(2) as executor:
        processes = run_campaign(square, ITEMS, executor=executor, folder=tmp_path, first_here=True)
    assert same(plain, processes)
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"n{k}.parquet" for k in range(6)]


def test_processes_are_other_processes():
    with open_executor(2) as executor:
        rows = run_campaign(where, ITEMS[:2], executor=executor)
    assert os.getpid() not in rows["pid"]


def test_any_futures_executor_will_do():
    with ThreadPoolExecutor(3) as executor:
        assert same(run_campaign(square, ITEMS, executor=executor), run_campaign(square, ITEMS))


def test_resumes_by_skipping_finished_parts(tmp_path):
    with pytest.raises(CampaignInterrupted, match=r"3 of 6 parts are finished and kept in .*run the same"):
        run_campaign(interrupt_at_three, ITEMS, folder=tmp_path)
    assert len(list(tmp_path.glob("*.parquet"))) == 3
    told = []
    rows = run_campaign(square, ITEMS, folder=tmp_path, progress=lambda done, total: told.append((done, total)))
    assert told == [(3, 6), (4, 6), (5, 6), (6, 6)]
    assert same(rows, run_campaign(square, ITEMS))


def test_a_damaged_part_is_made_again(tmp_path):
    (tmp_path / "n1.parquet").write_bytes(b"rubbish")
    assert same(run_campaign(square, ITEMS, folder=tmp_path), run_campaign(square, ITEMS))


def test_errors_come_back_from_a_worker():
    error = bench.UnknownNameError("motion", "conning", ["coning"])
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_failed_item_is_tried_again(tmp_path, jobs):
    items = [Item(str(k), (str(tmp_path / "mark"), k)) for k in range(4)]
    with open_executor(jobs) as executor:
        rows = run_campaign(fail_once, items, executor=executor)
    assert (tmp_path / "mark").exists()
    assert len(rows) == 8


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_hopeless_item_is_named_with_its_work(jobs):
    with open_executor(jobs) as executor, pytest.raises(CampaignError, match=r"n0 failed 2 times.*cursed.*rerun it: 0"):
        run_campaign(fail_always, ITEMS[:1], executor=executor)


def test_jobs_default_to_the_cpus_of_this_process():
    assert 1 <= cpu_count() <= (os.cpu_count() or 1)


def test_unreachable_scheduler():
    message = r"scheduler must be the address of a Dask scheduler, got 'nowhere'"
    with pytest.raises(bench.InputError, match=message), open_executor(1, "nowhere"):
        pass


DASK = """
from distributed import LocalCluster
from bench.campaign import open_executor, run_campaign
from tests.test_campaign import ITEMS, same, square

if __name__ == "__main__":
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        open_executor(1, cluster.scheduler_address) as executor,
    ):
        assert same(run_campaign(square, ITEMS, executor=executor), run_campaign(square, ITEMS))
        print("the same")
"""


@pytest.mark.slow
def test_dask_gives_the_same_rows(tmp_path):
    """In a process of its own, as it is used: dask's event loop is particular about what else runs beside it."""
    (tmp_path / "on_dask.py").write_text(DASK)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, str(tmp_path / "on_dask.py")]
    result = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    assert result.stdout.endswith("the same\n"), result.stderr


SLEEPER = """
import sys, time
import numpy as np
from pathlib import Path
from bench.campaign import Item, open_executor, run_campaign
from bench.table import Table

def measure(work):
    if work:
        Path(sys.argv[1], f"started{work}").touch()
        time.sleep(120)
    return Table({"work": np.array([float(work)])})

if __name__ == "__main__":
    with open_executor(2, None) as executor:
        run_campaign(measure, [Item(str(k), k) for k in range(4)], executor=executor, folder=Path(sys.argv[1], "parts"))
"""


def heed_ctrl_c():
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job, and so its children, would ignore it


@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_workers_end_with_their_parent(tmp_path, end):
    (tmp_path / "sleeper.py").write_text(SLEEPER)
    command = [sys.executable, str(tmp_path / "sleeper.py"), str(tmp_path)]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(ROOT)}, preexec_fn=heed_ctrl_c
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "started1").exists() or not (tmp_path / "started2").exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    process.send_signal(end)
    _, said = process.communicate(timeout=20)  # the workers hold its stderr: this waits for all of them
    assert (tmp_path / "parts" / "0.parquet").exists()
    assert end == signal.SIGKILL or b"1 of 4 parts are finished and kept" in said
