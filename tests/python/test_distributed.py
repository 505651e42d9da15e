"""Sweeps on executors and on a real cluster of processes."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import Client, LocalCluster

import iva
from iva import distributed, remote, sweeping
from iva.sampling import LatinHypercube, Uniform
from patience import PATIENCE, started, until

# Ends a process at once; of Windows it is the other.
HARD = signal.SIGTERM if sys.platform == "win32" else signal.SIGKILL
# Runs of 5 ms each: parts are small, so that there are many of them.
SCENE: dict[str, Any] = {
    "start": iva.Start(displacement=1.0),
    "periods": 1500,
    "over": {
        "relative_clearance": np.linspace(0.5, 1.2, 60),
        "restitution": np.linspace(0.7, 0.95, 25),
    },
}
# Points of two or three of its parts, of which there are more than four.
SOME = 300
RUN_PART = distributed.run_part


def sweep(**more: Any) -> iva.Table:
    return iva.sweep(
        iva.Piva(mass_ratio=0.1, frequency_ratio=0.4, length=10.0),
        iva.Primary(damping_ratio=0.001),
        **(SCENE | more),
    )


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file below a folder, hidden ones too."""
    files = (file for file in folder.rglob("*") if file.is_file())
    return {str(file.relative_to(folder)): file.read_bytes() for file in files}


def held(gate: Path, *part: Any) -> str:
    """Run a part on a worker: the first three that come at once, the others once a gate is open."""
    for number in range(3):
        try:
            (gate / f"passes-{number}").touch(exist_ok=False)
        except FileExistsError:
            continue
        return RUN_PART(*part)
    (gate / f"waits-{os.getpid()}").touch()
    until((gate / "open").exists)
    return RUN_PART(*part)


def waiting(gate: Path) -> int:
    """Return a process that waits at a gate, once there is one."""
    until(lambda: any(gate.glob("waits-*")))
    return int(next(gate.glob("waits-*")).name.removeprefix("waits-"))


@pytest.fixture
def gate(tmp_path: Path) -> Iterator[Path]:
    """Return a gate: a sweep that is held at it is under way for as long as a test needs."""
    folder = tmp_path / "gate"
    folder.mkdir()
    yield folder
    (folder / "open").touch()


@pytest.fixture(scope="module")
def local(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the sweep as one process writes it."""
    folder = tmp_path_factory.mktemp("local") / "out"
    sweep(out=folder)
    assert len(list((folder / "summary").iterdir())) > 4
    return folder


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """Return a cluster of two processes."""
    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True
    ) as cluster:  # fmt: skip
        yield cluster


@pytest.fixture
def client(cluster: LocalCluster) -> Iterator[Client]:
    with Client(cluster) as client:
        yield client


def processes() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def test_a_cluster_writes_the_same_bytes(local: Path, tmp_path: Path, client: Client) -> None:
    reports: list[tuple[int, int]] = []
    table = sweep(client=client, out=tmp_path / "out", progress=lambda *it: reports.append(it))
    assert contents(tmp_path / "out") == contents(local)
    assert table == iva.read(local)
    assert reports[-1] == (1500, 1500)


def test_a_cluster_gathers_the_same_tables(local: Path, client: Client) -> None:
    assert sweep(client=client) == iva.read(local)


def test_a_killed_worker_costs_no_rows(
    local: Path, tmp_path: Path, client: Client, gate: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distributed, "run_part", partial(held, gate))
    out = tmp_path / "out"
    killed: list[int] = []

    def progress(done: int, _total: int) -> None:
        if done > SOME and not killed:
            killed.append(waiting(gate))
            os.kill(killed[0], HARD)
            (gate / "open").touch()

    sweep(client=client, out=out, progress=progress)
    assert len(killed) == 1
    assert contents(out) == contents(local)


@pytest.mark.parametrize("pool", [processes, lambda: ThreadPoolExecutor(3)])
def test_an_executor_does_as_well(local: Path, tmp_path: Path, pool: Any) -> None:
    with pool() as executor:
        sweep(executor=executor, out=tmp_path / "out")
        assert contents(tmp_path / "out") == contents(local)
        assert sweep(executor=executor) == iva.read(local)


@pytest.mark.parametrize("kind", ["latin", "frame"])
def test_points_travel_with_the_parts(kind: str, tmp_path: Path) -> None:
    over: Any = {"relative_clearance": Uniform(0.5, 1.2), "restitution": Uniform(0.7, 0.95)}
    sampling: Any = LatinHypercube(400, seed=2)
    if kind == "frame":
        over = iva.sampling.points(over, sampling).drop("point")
        sampling = "grid"
    with ThreadPoolExecutor(2) as executor:
        sweep(executor=executor, over=over, sampling=sampling, out=tmp_path / "out")
    sweep(over=over, sampling=sampling, out=tmp_path / "local")
    assert contents(tmp_path / "out") == contents(tmp_path / "local")


def test_a_broken_pool_keeps_what_is_done_and_the_sweep_goes_on(
    local: Path, tmp_path: Path, gate: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distributed, "run_part", partial(held, gate))
    out = tmp_path / "out"
    with processes() as executor:

        def progress(done: int, _total: int) -> None:
            if done > SOME:
                for process in list(executor._processes.values()):
                    process.kill()

        with pytest.raises(Exception, match="terminated abruptly") as caught:
            sweep(executor=executor, out=out, progress=progress)
    assert "resume=True" in caught.value.__notes__[0]
    assert iva.read(out).summary.height >= SOME
    sweep(out=out, resume=True)
    assert contents(out) == contents(local)


INTERRUPTED = """
import sys
from functools import partial
from pathlib import Path
from distributed import Client
from iva import distributed
from test_distributed import held, sweep

if __name__ == "__main__":
    address, out, gate = sys.argv[1:]
    distributed.run_part = partial(held, Path(gate))
    with Client(address) as client:
        try:
            sweep(client=client, out=out, progress=lambda done, _: print(done, flush=True))
        except KeyboardInterrupt as interrupt:
            print(*interrupt.__notes__)
            sys.exit(130)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
def test_ctrl_c_ends_a_sweep_on_a_cluster_and_leaves_it_to_go_on(
    local: Path, tmp_path: Path, cluster: LocalCluster, client: Client, gate: Path
) -> None:
    script = tmp_path / "script.py"
    script.write_text(INTERRUPTED, encoding="utf-8")
    out = tmp_path / "out"
    with started(
        [sys.executable, str(script), cluster.scheduler_address, str(out), str(gate)],
        stdout=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parent)},
    ) as job:
        assert job.stdout is not None
        while int(job.stdout.readline()) <= SOME:
            pass
        waiting(gate)
        job.send_signal(signal.SIGINT)
        said = job.stdout.read()
        assert job.wait() == 130, said
    assert "go on with resume=True" in said
    # The cluster has nothing left to do for the one that went.
    (gate / "open").touch()
    until(lambda: not any(client.processing().values()))
    sweep(client=client, out=out, resume=True)
    assert contents(out) == contents(local)


def test_what_is_no_executor_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=r"executor = 5: give a concurrent\.futures\.Executor"):
        sweep(executor=5)
    with pytest.raises(TypeError, match=r"client = 5: give a dask\.distributed\.Client"):
        sweep(client=5)
    with ThreadPoolExecutor(1) as executor:
        with pytest.raises(ValueError, match="give one of them"):
            sweep(executor=executor, client=5)
        with pytest.raises(ValueError, match="memory_limit"):
            sweep(executor=executor, memory_limit=1000.0)
        with pytest.raises(ValueError, match="restitution"):
            sweep(executor=executor, over={"restitution": [1.5]}, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_url_takes_the_same_bytes_and_goes_on(
    local: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    url = f"file://{out}"
    stopped = threading.Event()
    run_part = remote.run_part

    def run(study: Any, part: tuple[int, int, int], *where: Any) -> str:
        # The first parts, whatever the order in which they end, are there when it stops.
        assert part[1] <= SOME or stopped.wait(PATIENCE)
        return run_part(study, part, *where)

    def stop(done: int, _total: int) -> None:
        if done > SOME:
            stopped.set()
            raise RuntimeError("enough")

    monkeypatch.setattr(remote, "run_part", run)
    with ThreadPoolExecutor(2) as executor:
        with pytest.raises(RuntimeError, match="enough") as caught:
            sweep(executor=executor, out=url, progress=stop)
        assert caught.value.__notes__[0].endswith("go on with resume=True")
        with pytest.raises(ValueError, match="already holds a sweep"):
            sweep(executor=executor, out=url)
        with pytest.raises(ValueError, match=r"run\.periods was 1500\.0, is 1501\.0"):
            sweep(executor=executor, out=url, resume=True, periods=1501)
        damaged = out / "summary" / "part-00000.parquet"
        damaged.write_bytes(damaged.read_bytes()[:-1])
        with pytest.warns(UserWarning, match=r"computed again: summary/part-00000\.parquet"):
            table = sweep(executor=executor, out=url, resume=True)
        assert table == iva.read(local)
        altered = out / "summary" / "part-00001.parquet"
        content = bytearray(altered.read_bytes())
        content[len(content) // 2] ^= 1
        altered.write_bytes(content)
        with pytest.warns(UserWarning, match=r"computed again: summary/part-00001\.parquet"):
            sweep(executor=executor, out=url, resume=True)
        with pytest.raises(ValueError, match="nothing else is safe"):
            sweep(executor=executor, out=url, overwrite=True)
        with pytest.raises(ValueError, match="nosuch"):
            sweep(executor=executor, out="nosuch://out")
    assert contents(out) == contents(local)
    assert not (out / ".iva-work").exists()
    with pytest.raises(ValueError, match="a URL needs executor or client"):
        sweep(out=url)


def test_csv_behind_a_url_has_the_types_of_its_table(tmp_path: Path) -> None:
    over = {"relative_clearance": [0.5, 0.6], "restitution": [0.7]}
    with ThreadPoolExecutor(2) as executor:
        table = sweep(executor=executor, over=over, out=f"file://{tmp_path}/out", format="csv")
    assert table == sweep(over=over)


def test_a_file_behind_a_url_that_was_altered_is_not_read(tmp_path: Path) -> None:
    over = {"relative_clearance": [0.5, 0.6], "restitution": [0.7]}
    with ThreadPoolExecutor(2) as executor:
        table = sweep(executor=executor, over=over, out=f"file://{tmp_path}/out", format="csv")
    part = tmp_path / "out" / "summary" / "part-00000.csv"
    part.write_text(part.read_text().replace("finished", "finishes"))
    with pytest.raises(iva.IvaError, match=r"part-00000\.csv is not what was written"):
        _ = table.summary


def test_links_behind_a_url_are_refused(tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    (precious / "folder").mkdir(parents=True)
    (precious / "folder" / "file").write_text("mine")
    over = {"relative_clearance": [0.5, 0.6], "restitution": [0.7]}
    for name in (".iva-work", "summary", "inputs", "inputs/points.parquet", "study.toml"):
        out = tmp_path / name.replace("/", " ")
        (out / name).parent.mkdir(parents=True)
        (out / name).symlink_to(precious)
        with (
            ThreadPoolExecutor(2) as executor,
            pytest.raises(ValueError, match="is a symbolic link"),
        ):
            sweep(executor=executor, over=over, out=f"file://{out}")
        assert contents(precious) == {"folder/file": b"mine"}


@pytest.mark.parametrize(
    "lie",
    [
        {"folder": "../../precious"},
        {"folder": "/etc"},
        {"folder": ""},
        {"contents": {}},
        {"contents": {"../precious": {"rows": 1, "bytes": 4, "sha256": "0" * 64}}},
        {"failed": 10**6},
        {"failed": -1},
        {"sha256": "0" * 64},
        {"bytes": 1},
        {"rows": -1},
        {"iva": "0.0.1"},
        {"iva": None},
    ],
)
def test_what_a_worker_says_is_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lie: dict[str, Any]
) -> None:
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "summary.parquet").write_text("mine")
    honest = distributed.run_part

    def lying(*arguments: Any) -> str:
        staged = json.loads(honest(*arguments))
        for key, value in lie.items():
            (staged if key in staged else staged["contents"]["summary"])[key] = value
        return json.dumps(staged)

    monkeypatch.setattr(distributed, "run_part", lying)
    over = {"relative_clearance": [0.5, 0.6], "restitution": [0.7]}
    out = tmp_path / "out"
    with ThreadPoolExecutor(2) as executor, pytest.raises((ValueError, iva.IvaError)) as caught:
        sweep(executor=executor, over=over, out=out)
    assert "worker" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert (tmp_path / "precious" / "summary.parquet").read_text() == "mine"
    assert not out.exists()


def test_few_parts_wait_at_a_time_and_none_after_the_end() -> None:
    release = threading.Event()
    futures: list[Future[bool]] = []

    def submit(part: Any) -> Future[bool]:
        # The first ends at once, the others wait for us.
        futures.append(pool.submit(release.wait, 0.0 if part[0] == 0 else PATIENCE))
        return futures[-1]

    with ThreadPoolExecutor(2) as pool:
        try:
            parts = [(number, number, number + 1) for number in range(100)]
            found = distributed.results(pool, parts, submit)
            next(found)
            assert len(futures) == 2 * distributed.AHEAD
            found.close()  # type: ignore[attr-defined]
            # One is done, two may be running.
            assert sum(future.cancelled() for future in futures) >= len(futures) - 3 > 0
        finally:
            release.set()


def test_points_that_failed_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[tuple[int, int, int]] = []

    @contextmanager
    def reporting(_progress: object) -> Iterator[Any]:
        yield lambda *now: said.append(now)

    monkeypatch.setattr(sweeping, "reporting", reporting)
    over = {"restitution": [0.7, 0.8], "relative_clearance": [0.5, 1e6]}
    with ThreadPoolExecutor(2) as executor:
        sweep(executor=executor, over=over, max_impacts=3, periods=30)
    assert said[-1] == (4, 4, 2)  # without impacts nothing fails
