"""Studies on a Ray cluster: a shard is a task, which Ray gives to another worker when its own or the whole node dies.

Workers and this process have the study file, the files that it names and the results folder in common, under the same paths. What a task
has finished is in the journal of its shard, so a retry goes on there.
"""

from __future__ import annotations

import importlib
import logging
import os
import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ._errors import ArgumentError, Error, Locked
from ._study import Study

MAX_SHARDS = 9999
"""More than a study may be divided into."""

CASES_OF_A_THREAD = 20
"""Cases that a thread of a shard does at most by default. A case takes seconds, so that a shard takes minutes."""

SHARDS_OF_A_WORKER = 4
"""Shards that fall to each worker at least by default, so that the last ones end at about the same time."""

LOCKED_S = 120.0
"""How long a shard waits for the process that holds it: one that dies lets go of it, from another machine after the lease of its lock."""


@dataclass(frozen=True)
class Work:
    """A study and its folder as absolute paths, and the number of its shards and of the threads of each."""

    file: str
    folder: str
    shards: int
    threads: int


@dataclass(frozen=True)
class Answer:
    """What a task says: warnings, or the error that ended it."""

    problems: list[str]
    error: str | None = None
    is_bad_input: bool = False


def shard_count(cases: int, workers: int, threads: int) -> int:
    """The number of shards for so many cases, workers and threads of each."""
    most = max(1, min(CASES_OF_A_THREAD * threads, cases // (SHARDS_OF_A_WORKER * workers)))
    return max(1, min(-(-cases // most), MAX_SHARDS))


def do_shard(work: Work, shard: int, locked_s: float = LOCKED_S) -> Answer:
    """Does a shard, on a worker. The study is read anew there: only paths travel."""
    pause, end = 0.1, time.monotonic() + locked_s
    try:
        study = Study.read(work.file, threads=work.threads)
        while True:
            try:
                return Answer(study.run(work.folder, (shard, work.shards), work.threads).problems)
            except Locked:
                if time.monotonic() + pause > end:
                    raise
            time.sleep(pause)
            pause = min(2.0 * pause, 5.0)
    except Error as error:
        return Answer([], f"shard {shard}/{work.shards}: {error}", error.is_bad_input)


class Cluster:
    """A connection to Ray."""

    def __init__(self, ray: Any) -> None:
        self._ray = ray

    def workers(self, threads: int) -> int:
        """How many tasks of so many threads run at the same time.

        Raises:
            ArgumentError: No node has as many processors.
        """
        nodes = [int(node["Resources"].get("CPU", 0)) for node in self._ray.nodes() if node["Alive"]]
        if threads > max(nodes, default=0):
            most = max(nodes, default=0)
            raise ArgumentError(f"no node of the cluster has {threads} processors; allowed: up to {most} threads")
        return sum(processors // threads for processors in nodes)

    def run(self, work: Work, look: Callable[[], object], warn: Callable[[str], object]) -> None:
        """Does all shards. `look` is called about twice a second, `warn` with what was found wrong in the folder.

        Raises:
            Error: The first shard that fails; the others are stopped, and finished cases are kept.
        """
        task = self._ray.remote(num_cpus=work.threads, max_retries=-1)(do_shard)
        pending = {task.remote(work, shard): shard for shard in range(1, work.shards + 1)}
        try:
            while pending:
                ready, _ = self._ray.wait(list(pending), num_returns=1, timeout=0.5)
                for reference in ready:
                    for problem in self._answer(reference, f"shard {pending.pop(reference)}/{work.shards}").problems:
                        warn(problem)
                look()
        finally:
            for reference in pending:
                self._ray.cancel(reference)

    def _answer(self, reference: Any, shard: str) -> Answer:
        try:
            answer: Answer = self._ray.get(reference)
        except self._ray.exceptions.RayError as problem:
            raise Error(f"{shard}: {_line(problem)}") from problem
        if answer.error is not None:
            error = Error(answer.error)
            error.is_bad_input = answer.is_bad_input
            raise error
        return answer


@contextmanager
def connected(address: str | None) -> Iterator[Cluster]:
    """Connects to the cluster at an address, to one that runs here, or to one that is started for this process.

    Raises:
        ArgumentError: Ray is not installed, or no cluster answers.
    """
    # Where a cluster is started here, it tells nobody.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        ray = importlib.import_module("ray")
    except ImportError:
        problem = "ray is not installed; allowed: --engine local, or pip install ray"
        raise ArgumentError(problem) from None
    # Ray says on standard output what becomes of its nodes.
    with redirect_stdout(sys.stderr):
        try:
            _reach(address or os.environ.get("RAY_ADDRESS"))
            ray.init(address=address, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
        except (ConnectionError, OSError, RuntimeError, ValueError) as problem:
            where = f"at {address or os.environ.get('RAY_ADDRESS') or 'this machine'}"
            words = f"no Ray cluster {where}: {_line(problem)}; allowed: the address of a cluster that runs, or none"
            raise ArgumentError(words) from problem
        try:
            yield Cluster(ray)
        finally:
            ray.shutdown()


def _reach(address: str | None) -> None:
    """Looks whether anybody listens at an address with a port: Ray itself gives up only after minutes."""
    host, colon, port = (address or "").rpartition("://")[2].rpartition(":")
    if colon and port.isdecimal():
        socket.create_connection((host.strip("[]"), int(port)), timeout=10.0).close()


def _line(problem: BaseException) -> str:
    """What an exception says that says more than a line: its last one, which Python ends its traces with."""
    lines = [line.strip() for line in str(problem).splitlines() if line.strip()]
    return lines[-1] if lines else type(problem).__name__


def absolute(path: Path) -> str:
    """A path for all nodes."""
    return str(Path(os.path.abspath(path)))
