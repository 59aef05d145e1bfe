"""`python -m stead.study`: a study on this machine or on a Ray cluster."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from ._errors import Error
from ._ray import MAX_SHARDS, Work, absolute, connected, shard_count
from ._study import Study

ABOUT = """\
Does what is left to do of a study, as `stead study run` does, here or on a Ray cluster.

With --engine ray a shard of the study is a task. When a worker or a node dies its shard is done by another one, which goes on where it was. The
study file, the files that it names and the results folder must be seen by all nodes under the same paths, and stead be installed on each.
The command may be killed at any moment: the same command goes on where it was. The bytes of study.csv depend on neither
engine nor shards nor threads.
"""

EXIT_CODES = """\
Exit codes:
  0  done; cases without a placement are rows with their reason
  1  a file could not be written, or a worker failed; finished cases are kept
  2  wrong usage, bad input, no ray, or a shard that another process works on
130  Ctrl-C ended it; finished cases are kept
"""

MAX_THREADS = 1024


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"error: {message}\n")


def _number(most: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"found {text}; allowed: a whole number from 1 to {most}")
        return int(text)

    return read


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        "python -m stead.study",
        description=ABOUT,
        epilog=EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("file", type=Path, metavar="FILE", help="study file (TOML)")
    add("--engine", choices=("local", "ray"), default="local", help="where the cases are done [default: local]")
    add(
        "--shards",
        type=_number(MAX_SHARDS),
        metavar="N",
        help="parts of the study [default: with ray four or more for each worker, of minutes each; else 1]",
    )
    add(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder for the results, which all nodes see [default: results/<name of the study file>]",
    )
    add(
        "--address",
        metavar="A",
        help="Ray cluster, as 10.0.0.1:6379 [default: $RAY_ADDRESS, or the one that runs here, or a new one of this machine]",
    )
    add(
        "--threads",
        type=_number(MAX_THREADS),
        metavar="N",
        help="threads, with ray the processors and threads of each shard [default: number of processors; with ray 1]",
    )
    return parser


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


class _Shown:
    """Cases done of planned on standard error: one line that changes on a terminal, else a line now and then."""

    def __init__(self, study: Study, folder: Path) -> None:
        self._study, self._folder = study, folder
        self._started = time.monotonic()
        self._is_terminal = sys.stderr.isatty()
        self._every = 1.0 if self._is_terminal else 30.0
        self._next = self._started + self._every

    def look(self) -> None:
        """Shows how far the study is, where that is due."""
        begun = time.monotonic()
        if begun < self._next:
            return
        status = self._study.status(self._folder)
        text = f"cases: {status.done} of {status.planned}, {begun - self._started:.0f} s"
        if self._is_terminal:
            print(f"\r{text}", end="\033[K", file=sys.stderr, flush=True)
        else:
            _say(f"progress: {text}")
        # Looking at a large study takes a second, and is to take little of the time.
        ended = time.monotonic()
        self._next = ended + max(self._every, 20.0 * (ended - begun))

    def end(self) -> None:
        """Makes room for what is said next."""
        if self._is_terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def _on_this_machine(options: argparse.Namespace, study: Study, folder: Path, shown: _Shown) -> None:
    shards = options.shards or 1
    for shard in range(1, shards + 1):
        ended = study.run(folder, (shard, shards), options.threads, lambda stage, done, total: shown.look())
        for problem in ended.problems:
            _say(f"warning: {problem}")


def _on_ray(options: argparse.Namespace, study: Study, folder: Path, shown: _Shown) -> None:
    threads = options.threads or 1
    told: set[str] = set()

    def warn(problem: str) -> None:
        # Every shard sees what is wrong in the folder.
        if problem not in told:
            told.add(problem)
            _say(f"warning: {problem}")

    with connected(options.address) as cluster:
        workers = cluster.workers(threads)
        shards = options.shards or shard_count(len(study.cases), workers, threads)
        cluster.run(Work(absolute(options.file), absolute(folder), shards, threads), shown.look, warn)


def _run(options: argparse.Namespace) -> None:
    study = Study.read(options.file, threads=options.threads)
    folder: Path = options.out or Path("results", options.file.stem)
    before = study.status(folder).done
    shown = _Shown(study, folder)
    try:
        (_on_ray if options.engine == "ray" else _on_this_machine)(options, study, folder, shown)
    finally:
        shown.end()
    if not study.merge(folder):
        problem = "cases are missing though every shard has ended"
        raise Error(f"{folder}: {problem}; allowed: files and a folder that all nodes see, and one version of stead on all")
    planned = len(study.cases)
    print(f"study: {planned} of {planned} cases done, {planned - before} of them now; results in {folder / 'study.csv'}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command and returns its exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.address is not None and options.engine != "ray":
        parser.error("--address is for --engine ray")
    try:
        _run(options)
    except KeyboardInterrupt:
        _say("interrupted: finished cases are kept; the same command goes on")
        return 130
    except Error as error:
        _say(f"error: {error}")
        return 2 if error.is_bad_input else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
