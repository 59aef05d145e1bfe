"""What all jobs have in common. They run without the global interpreter lock.

- `progress(stage, done, total)` is called on the calling thread, a few times a second and once at the end; what it raises stops the job. Of
  a certificate, `done` are the nodes bounded and `total` those and the open ones.
- `threads`: by default one for each processor, at most 1024. It does not change a result.
- `time_limit_s`: the job ends then with what it has; where that is nothing, with `Error`.
- Ctrl-C stops a job, and raises `Interrupted`, a `KeyboardInterrupt` with what was found as `result`; the second one does not wait.
"""

from __future__ import annotations

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
    if threads is not None and not 1 <= threads <= _stead.MAX_THREADS:
        raise ArgumentError(f"no such number of threads, found {threads}; allowed: 1 to {_stead.MAX_THREADS}")
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


def checked_seed(seed: int | None) -> int | None:
    if seed is not None and not 0 <= seed < 2**63:
        raise ArgumentError(f"no such seed, found {seed}; allowed: a whole number from 0 to {2**63 - 1}")
    return seed
