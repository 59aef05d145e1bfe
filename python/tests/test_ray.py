"""A study on two Ray nodes of this machine, one of which is killed while it works: the bytes of one process all the same."""

from __future__ import annotations

import fcntl
import json
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import stead
from stead._ray import Answer, Work, do_shard

pytest.importorskip("ray")
pytestmark = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="processes are found in /proc")

CASES, SHARDS = 24, 8
DEADLINE_S = 180.0
# Of this machine alone. Ray would put an address that others see in place of 127.0.0.1.
HOSTS = "127.0.0.2", "127.0.0.3"


class Node:
    """A Ray node of this machine with one processor. Its processes are known by a variable of their environment."""

    def __init__(self, folder: Path, host: str, *options: str) -> None:
        self._mark = f"STEAD_TEST_NODE={secrets.token_hex(16)}"
        name, value = self._mark.split("=")
        self.environment = {
            **os.environ,
            name: value,
            "HOME": str(folder),
            "RAY_USAGE_STATS_ENABLED": "0",
            # Workers are not to wait for whatever else this machine does.
            "RAY_worker_niceness": "0",
        }
        self._workers: list[int] = []
        self._next_look = 0.0
        self._options = [f"--node-ip-address={host}", "--num-cpus=1", "--object-store-memory=80000000", "--disable-usage-stats", *options]

    def start(self) -> None:
        call = [sys.executable, "-m", "ray.scripts.scripts", "start", *self._options]
        done = subprocess.run(call, env=self.environment, capture_output=True, text=True, check=False, timeout=90)
        assert done.returncode == 0, done.stdout + done.stderr

    def processes(self) -> list[int]:
        """The numbers of its processes, of workers too."""
        mark = self._mark.encode()

        def is_ours(process: Path) -> bool:
            try:
                return mark in (process / "environ").read_bytes().split(b"\0")
            except OSError:
                return False

        return [int(process.name) for process in Path("/proc").iterdir() if process.name.isdigit() and is_ours(process)]

    def kill(self) -> None:
        """Kills all of it at once, and what it starts meanwhile."""
        end = time.monotonic() + 20.0
        while processes := self.processes():
            assert time.monotonic() < end, processes
            for process in processes:
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    continue
            time.sleep(0.05)

    def journals(self, folder: Path) -> list[Path]:
        """The journals that its workers have open."""
        found = []
        if time.monotonic() > self._next_look:
            self._workers = self.processes()
            self._next_look = time.monotonic() + 0.5
        for process in self._workers:
            try:
                files = [Path(os.readlink(file)) for file in Path(f"/proc/{process}/fd").iterdir()]
            except OSError:
                continue
            found += [file for file in files if file.parent == folder / "shards" and file.suffix == ".jsonl"]
        return found


@pytest.fixture
def nodes() -> Iterator[tuple[Node, Node, str]]:
    """Two nodes, and the address of the cluster."""
    # A name of a socket is short, so this is not a folder of pytest.
    folder = Path(tempfile.mkdtemp(prefix="stead-ray-"))
    with socket.socket() as free:
        free.bind((HOSTS[0], 0))
        port = free.getsockname()[1]
    # A dead node is found out in seconds.
    system = json.dumps({"health_check_initial_delay_ms": 500, "health_check_period_ms": 500, "health_check_failure_threshold": 4})
    head = Node(folder, HOSTS[0], "--head", f"--port={port}", "--include-dashboard=false", f"--temp-dir={folder}", f"--system-config={system}")
    second = Node(folder, HOSTS[1], f"--address={HOSTS[0]}:{port}")
    try:
        head.start()
        second.start()
        yield head, second, f"{HOSTS[0]}:{port}"
    finally:
        second.kill()
        head.kill()
        shutil.rmtree(folder, ignore_errors=True)


def kill_at_work(head: Node, second: Node, folder: Path, driver: subprocess.Popen[str]) -> tuple[Path, list[str]]:
    """Kills the second node while a shard of it has finished some of its cases. Returns the journal and its whole lines."""
    end = time.monotonic() + DEADLINE_S / 2.0
    is_head_at_work = False
    while time.monotonic() < end:
        assert driver.poll() is None, driver.communicate()
        is_head_at_work = is_head_at_work or bool(head.journals(folder))
        for journal in second.journals(folder) if is_head_at_work else []:
            if 1 <= journal.read_text().count("\n") < CASES // SHARDS:
                second.kill()
                lines = [line for line in journal.read_text().splitlines(keepends=True) if line.endswith("\n")]
                assert 1 <= len(lines) < CASES // SHARDS
                return journal, lines
        time.sleep(0.01)
    raise AssertionError("the two nodes were not seen at work")


def study_of(small_study: Path, cases: int) -> Path:
    file = small_study.with_name(f"ray-{cases}.toml")
    steps = f'{{ from = 0.2, to = 6.0, count = {cases}, spacing = "log" }}'
    axis = f'[[axis]]\nfield = "robot.joints[1].stiffness_mnm_per_rad"\nrange = {steps}\n'
    file.write_text(f"{small_study.read_text()}\n{axis}")
    return file


@contextmanager
def started(call: list[str | Path], head: Node) -> Iterator[subprocess.Popen[str]]:
    """A process that is gone in the end."""
    pipe = subprocess.PIPE
    with subprocess.Popen(call, env=head.environment, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def test_a_node_that_is_killed_costs_no_case(
    nodes: tuple[Node, Node, str], small_study: Path, command: list[str], tmp_path: Path
) -> None:
    head, second, address = nodes
    file, folder = study_of(small_study, CASES), tmp_path / "ray"
    call: list[str | Path] = [sys.executable, "-m", "stead.study", file, "--engine", "ray", "--address", address]
    call += ["--shards", str(SHARDS), "--out", folder]
    with started(call, head) as driver:
        journal, finished = kill_at_work(head, second, folder, driver)
        out, err = driver.communicate(timeout=DEADLINE_S)
    assert driver.returncode == 0, err
    assert out == f"study: {CASES} of {CASES} cases done, {CASES} of them now; results in {folder / 'study.csv'}\n"
    assert "Traceback" not in err and "error: " not in err, err

    subprocess.run([*command, "study", "run", file, "--out", tmp_path / "local"], capture_output=True, check=True)
    assert (folder / "study.csv").read_bytes() == (tmp_path / "local" / "study.csv").read_bytes()
    status = stead.Study.read(file).status(folder)
    assert status.done == CASES and [shard.shard for shard in status.shards] == [(i, SHARDS) for i in range(1, 9)]

    # The shard that was begun on the killed node went on where it was: its finished cases keep the time that they took there.
    lines = Path(journal).read_text().splitlines()
    assert len(lines) == CASES // SHARDS and lines[: len(finished)] == finished


def test_ctrl_c_and_what_is_refused(nodes: tuple[Node, Node, str], small_study: Path, tmp_path: Path) -> None:
    head, _, address = nodes
    file, folder = study_of(small_study, 40), tmp_path / "out"
    call: list[str | Path] = [sys.executable, "-m", "stead.study", file, "--engine", "ray", "--address", address]
    call += ["--out", folder]
    with started([*call, "--threads", "7"], head) as driver:
        assert driver.communicate(timeout=DEADLINE_S) == (
            "",
            "error: no node of the cluster has 7 processors; allowed: up to 1 threads\n",
        )
    assert driver.returncode == 2

    study = stead.Study.read(file)
    with started(call, head) as driver:
        end = time.monotonic() + DEADLINE_S / 2.0
        while study.status(folder).done == 0:
            assert time.monotonic() < end and driver.poll() is None
            time.sleep(0.05)
        driver.send_signal(signal.SIGINT)
        out, err = driver.communicate(timeout=DEADLINE_S)
    assert (driver.returncode, out) == (130, ""), err
    assert err.endswith("interrupted: finished cases are kept; the same command goes on\n") and "Traceback" not in err
    done = study.status(folder).done
    assert 0 < done < 40
    with started([*call, "--shards", "3"], head) as driver:
        out, err = driver.communicate(timeout=DEADLINE_S)
    assert (driver.returncode, err) == (0, "") or "progress" in err, err
    assert out.startswith("study: 40 of 40 cases done, ") and f" {40 - done} of them now" in out


def test_a_cluster_that_is_not_there_is_said_at_once(small_study: Path, tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
    call = [sys.executable, "-m", "stead.study", str(study_of(small_study, 2)), "--engine", "ray", "--out", str(tmp_path)]
    ended = subprocess.run([*call, "--address", address], capture_output=True, text=True, check=False, timeout=60)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.startswith(f"error: no Ray cluster at {address}: ") and ended.stderr.count("\n") == 1


def test_a_shard_that_is_held_is_waited_for(small_study: Path, tmp_path: Path) -> None:
    work = Work(str(study_of(small_study, 2)), str(tmp_path), 2, 1)
    assert do_shard(work, 1) == Answer([])
    with open(tmp_path / "shards" / "0002-of-0002.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        answer = do_shard(work, 2, locked_s=0.3)
        assert answer.is_bad_input and answer.error is not None
        assert answer.error.startswith("shard 2/2: ") and "worked on by another process" in answer.error
        threading.Timer(0.5, lambda: fcntl.flock(lock, fcntl.LOCK_UN)).start()
        assert do_shard(work, 2) == Answer([])
