"""What all jobs have in common. They run without the global interpreter lock.

- `progress(stage, done, total)` is called on the calling thread, a few times a second and once at the end; what it raises stops the job. Of
  a certificate, `done` are the nodes bounded and `total` those and the open ones.
- `threads`: by default one for each processor, at most 1024. It does not change a result.
- `time_limit_s`: the job ends then with what it has; where that is nothing, with `Error`.
- Ctrl-C stops a job, and raises `Interrupted`, a `KeyboardInterrupt` with what was found as `result`; the second one does not wait.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from os import PathLike
from typing import TypeVar

from . import _stead
from ._errors import ArgumentError, Interrupted
from ._results import Result

File = str | PathLike[str]
Progress = Callable[[str, int, int], object]
_R = TypeVar("_R", bound=Result)
_N = TypeVar("_N")


def options_of(
    progress: Progress | None = None, threads: int | None = None, time_limit_s: float | None = None
) -> _stead._Options:
    if threads is not None:
        threads = checked_integer("number of threads", threads, 1, _stead.MAX_THREADS)
    return {"progress": progress, "threads": threads, "time_limit_s": time_limit_s}


def finished(kind: type[_R], done: tuple[_stead.Outcome | None, bool]) -> _R:
    """The result of a job, or `Interrupted` with it."""
    outcome, was_stopped = done
    result = kind(outcome) if outcome is not None else None
    if was_stopped or result is None:
        raise Interrupted(result)
    return result


def read_done(done: tuple[_N | None, bool]) -> _N:
    """What was read, or `Interrupted` where Ctrl-C stopped what had to be computed for it."""
    native, was_stopped = done
    if was_stopped or native is None:
        raise Interrupted()
    return native


def checked_integer(name: str, value: int, least: int, most: int) -> int:
    """A whole number in a range; what only looks like one, as 2.0 or a truth value, is none."""
    try:
        whole = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        whole = None
    if whole is None or not least <= whole <= most:
        kind = "a whole number from " if whole is None else ""
        raise ArgumentError(f"no such {name}, found {value!r}; allowed: {kind}{least} to {most}")
    return whole


def checked_seed(seed: int | None) -> int | None:
    return None if seed is None else checked_integer("seed", seed, 0, 2**63 - 1)
