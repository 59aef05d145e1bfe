"""Studies: many cases of one run, `stead study`. What jobs have in common is in `_jobs`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from . import _stead
from ._errors import ArgumentError, Interrupted
from ._jobs import File, Progress, options_of, read_done
from ._results import StudyReport
from ._tables import Table


@dataclass(frozen=True)
class StudyCase:
    """A case of a study.

    Attributes:
        number: Its number, from 1.
        id: SHA-256 digest of all that its result depends on.
        task: Name of the task file.
        weight: What the task counts beside the others, where each has its own placement.
        values: Number or label of each axis, by its name.
    """

    number: int
    id: str
    task: str
    weight: float
    values: dict[str, float | str]


@dataclass(frozen=True)
class Finished:
    """How the run of a shard ended.

    Attributes:
        planned: Cases of the shard.
        before: Of those, cases that had been finished before.
        now: Cases finished now.
        interrupted: Whether the run was stopped before its end.
        is_complete: Whether every case of the study is done, so that the table of results was written.
        problems: What was found wrong in the folder and done again, in sentences.
    """

    planned: int
    before: int
    now: int
    interrupted: bool
    is_complete: bool
    problems: list[str]


@dataclass(frozen=True)
class ShardStatus:
    """How far a shard is.

    Attributes:
        shard: Its number, from 1, and how many there are.
        planned: Its cases.
        done: Those that are done, by any shard.
        without_placement: Of these, those without a placement.
        is_running: Whether a process works on it.
    """

    shard: tuple[int, int]
    planned: int
    done: int
    without_placement: int
    is_running: bool


@dataclass(frozen=True)
class StudyStatus:
    """How far a study is.

    Attributes:
        planned: All cases.
        done: Those that are done.
        infeasible: Of these, those where no placement satisfies the constraints.
        failed: Of these, those that failed.
        shards: The shards that have left anything, and with them all others of as many.
        problems: What is wrong in the folder and will be done again, in sentences.
        stale: Kept cases that are not of the study as it is now, by the names of their folders.
    """

    planned: int
    done: int
    infeasible: int
    failed: int
    shards: list[ShardStatus]
    problems: list[str]
    stale: list[str]


class Study:
    """A study file with all its cases: `stead study`. Every folder is that of the study, `results/<name of the file>` for the command."""

    def __init__(self, native: _stead.Study) -> None:
        self._native = native

    @classmethod
    def read(
        cls,
        file: File,
        *,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
    ) -> Study:
        """Reads a study file, the run file that it varies, and every case once, with its forces where there is `[stock]`.

        Args:
            file: The study file (TOML).
            progress: Called with stage, cases read and cases in all.
            threads: Number of threads; it does not change the result.
            time_limit_s: After so many seconds there is no study, but an `Error`.

        Raises:
            InputError: with file, line, field, value found and what is allowed, and where a case is wrong with its combination of values.
            Error: The time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        return cls(read_done(_stead.Study.read(Path(file), options_of(progress, threads, time_limit_s))))

    @property
    def axes(self) -> list[str]:
        """The names of the axes, which are the keys of `StudyCase.values`."""
        return self._native.axes()

    @cached_property
    def cases(self) -> list[StudyCase]:
        """All cases, in the order of their numbers."""
        axes = self.axes

        def case(entries: _stead._Case) -> StudyCase:
            values = dict(zip(axes, entries["values"], strict=True))
            return StudyCase(entries["number"], entries["id"], entries["task"], entries["weight"], values)

        return [case(entries) for entries in self._native.cases()]

    def run(
        self,
        folder: File,
        shard: tuple[int, int] | str = (1, 1),
        threads: int | None = None,
        progress: Progress | None = None,
        time_limit_s: float | None = None,
    ) -> Finished:
        """Does what is left to do of a shard, and writes the table of results once every case of the study is done.

        It may be killed at any moment and goes on where it was. The bytes of `study.csv` are those of the command.

        Args:
            folder: Where the results go; made where it is missing.
            shard: `(3, 40)` or `"3/40"` for the cases 3, 43, 83 and so on; by default all.
            threads: Number of threads; it does not change the result.
            progress: Called with stage, cases done and cases in all.
            time_limit_s: After so many seconds no further case is begun.

        Raises:
            ArgumentError: for a shard that cannot be.
            Locked: Another process works on the same shard.
            OutputError: the folder of another study, or one that cannot be written; finished cases are kept.
            Interrupted: at Ctrl-C, with `Finished` as `result`; finished cases are kept.
        """
        text = shard if isinstance(shard, str) else "/".join(map(str, shard))
        ended, was_stopped = self._native.run(Path(folder), text, options_of(progress, threads, time_limit_s))
        finished = Finished(**ended) if ended is not None else None
        if was_stopped or finished is None:
            raise Interrupted(finished)
        return finished

    def status(self, folder: File) -> StudyStatus:
        """How far the study is in a folder, which need not be there.

        Raises:
            OutputError: the folder of another study, or a file that cannot be read.
        """
        entries = self._native.status(Path(folder))
        shards = [ShardStatus(**shard) for shard in entries["shards"]]
        return StudyStatus(
            entries["planned"],
            entries["done"],
            entries["infeasible"],
            entries["failed"],
            shards,
            entries["problems"],
            entries["stale"],
        )

    def prune(self, folder: File) -> list[Path]:
        """Removes kept cases that are not of the study as it is now, after an edit of its files. Returns the folders that are gone.

        Raises:
            OutputError: the folder of another study, or a file that cannot be read or removed.
        """
        return self._native.prune(Path(folder))

    def merge(self, folder: File) -> bool:
        """Writes `study.csv` and `study-timing.csv` where every case is done, and says whether it is so.

        Raises:
            OutputError: the folder of another study, or a file that cannot be read or written.
        """
        return self._native.merge(Path(folder))

    def results(self, folder: File) -> Table | None:
        """The table of results, one row for each case with the columns of `study.csv`; `None` as long as cases are missing.

        Raises:
            OutputError: the folder of another study, or a file that cannot be read.
        """
        found = self._native.results(Path(folder))
        return Table(found[0].decode(), found[1]) if found else None

    def report(
        self,
        folder: File,
        by: str | None = None,
        front: Sequence[str] | None = None,
        map: tuple[str, str] | None = None,  # noqa: A002
        noise_percent: float | None = None,
    ) -> StudyReport:
        """What a study that is done says: which layout is best, which compromises there are, what each axis does, and what failed.

        Args:
            folder: The folder of the study.
            by: Column of the table of results to rank by, with `:min` or `:max` behind it to say which is better (`objective_mm`).
            front: Columns of the front (`best_mean_total_mm` and `cycle_s`).
            map: Axes of the map; by default the two with the largest effects.
            noise_percent: Difference up to which figures of searches are ties (0.2).

        Raises:
            OutputError: Cases are missing, or the folder is of another study.
            ArgumentError: for a column or an axis that is not there, or a column without numbers.
        """
        if noise_percent is not None and not 0.0 <= noise_percent < 100.0:
            raise ArgumentError(f"no such noise, found {noise_percent} %; allowed: a number from 0 to below 100")
        noise = None if noise_percent is None else noise_percent / 100.0
        columns = None if front is None else list(front)
        return StudyReport(self._native.report(Path(folder), by, columns, map, noise))
