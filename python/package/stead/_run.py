"""Placement runs: `stead place`, `stead score`, `stead explain`. What their jobs have in common is in `_jobs`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from . import _stead
from ._errors import ArgumentError, InputError
from ._jobs import File, Progress, checked_integer, checked_seed, finished, options_of, read_done
from ._records import Placement
from ._results import Explanations, PlacementScore, Placements, Warning, _whole


def _place(placement: Placement) -> _stead._Place:
    return (placement.x_mm, placement.y_mm, placement.z_mm, placement.yaw_deg)


class Run:
    """A run file with the robot and the task that it names: `stead place`, `stead score`, `stead explain`.

    A run can be pickled, for the workers of `multiprocessing` or Ray. It is read again there, from the same files: where one of them has changed
    since, that is an `InputError`.
    """

    def __init__(self, native: _stead.Run, made: tuple[Any, ...] = ()) -> None:
        self._native = native
        # How it was read and changed, for pickle.
        self._made = made

    def __reduce__(self) -> tuple[Any, ...]:
        return _read_again, (self._made, self._native.inputs())

    @classmethod
    def read(
        cls,
        file: File,
        *,
        set: Mapping[str, object] | Sequence[str] = (),
        certify: float | None = None,
        seed: int | None = None,
        sensitivity: bool = False,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
    ) -> Run:
        """Reads a run file and the files that it names. Forces of a table `[stock]` are computed at once, which may take long.

        Args:
            file: The run file (TOML).
            set: Values in the place of those of the file or of the files that it names, by their keys, as `--set` of the command:
                `{"cell.z_mm": [-602, -402], "robot.joints[1].stiffness_mnm_per_rad": 0.8}`.
            certify: Gap of a certificate in per cent, whatever the file says of one.
            seed: Seed of the random numbers, instead of the file's.
            sensitivity: Refine once more for force errors of 10 %, and say how far the best placement moves.
            progress: Called with stage, steps done and steps in all, where forces are computed.
            threads: Number of threads; it does not change the result.
            time_limit_s: After so many seconds there is no run, but an `Error`, where forces are computed.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
            Error: The time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        options = options_of(progress, threads, time_limit_s)
        how = (Path(file), _assignments(set), certify, checked_seed(seed), sensitivity)
        return cls(read_done(_stead.Run.read(*how, options)), (how,))

    def with_seed(self, seed: int) -> Run:
        """The same run with another seed of the random numbers."""
        seed = checked_integer("seed", seed, 0, 2**63 - 1)
        return self._changed("with_seed", seed)

    def with_sensitivity(self, force_error: float) -> Run:
        """The same run, refined once more where scores have to cover force errors of this relative size (0.1 for 10 %)."""
        return self._changed("with_sensitivity", force_error)

    def without_worst(self) -> Run:
        """The same run without a search for the worst placement, which takes half of the time."""
        return self._changed("without_worst")

    def _changed(self, change: str, *arguments: Any) -> Run:
        return Run(getattr(self._native, change)(*arguments), (*self._made, (change, *arguments)))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    @property
    def warnings(self) -> list[Warning]:
        """What the user should see to in the input."""
        return [Warning(*warning) for warning in self._native.warnings()]

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self._native.robot()

    @property
    def point_count(self) -> int:
        """Number of points of the tool path."""
        return self._native.points()

    @property
    def certificate_warning(self) -> Warning | None:
        """Why the run cannot be certified, where it asks for a certificate and that is so."""
        warning = self._native.certificate_warning()
        return Warning(*warning) if warning else None

    def outside_cell(self, placement: Placement) -> str | None:
        """A note on a placement outside the cell, which is evaluated all the same."""
        return self._native.outside_cell(_place(placement))

    def placement_of(self, results: File, case: Literal[1, 3] = 1) -> Placement:
        """The placement of case 1 (the best) or 3 (the worst) in a results folder of `place` from the same files."""
        return Placement(*self._native.placement_of(Path(results), case))

    def place(
        self,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
        certify: bool = True,
    ) -> Placements:
        """Searches for the best and the worst placement, each with its best and its worst plan of the spindle angle.

        Args:
            progress: Called with stage, steps done and steps in all.
            threads: Number of threads; it does not change the result.
            time_limit_s: After so many seconds the best found so far is returned.
            certify: Whether the certificate is made that the run asks for, see also `certify`.

        Raises:
            Infeasible: No placement met satisfies the constraints.
            Interrupted: at Ctrl-C, with the best found so far as `result`.
        """
        return finished(Placements, self._native.place(options_of(progress, threads, time_limit_s), certify))

    def certify(
        self,
        placements: Placements,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
    ) -> Placements:
        """These placements with the certificate that their run asks for: bounds how far they are from the best and the worst possible."""
        done = _whole(placements._native).certified(options_of(progress, threads, time_limit_s))
        return finished(Placements, done)

    def score(
        self,
        placement: Placement | File,
        case: Literal[1, 3] = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
        deflection_map: bool = False,
    ) -> PlacementScore:
        """Plans a given placement, best and worst.

        Args:
            placement: The placement, or a results folder of `place` from the same files whose exact placement is taken.
            case: Case of those results: 1, the best placement, or 3, the worst.
            progress: Called with stage, steps done and steps in all.
            threads: Number of threads; it does not change the result.
            time_limit_s: After so many seconds the critical depths and the maps are left out.
            deflection_map: Also make the maps, that of the deflection and, where the tool may lean, that over lead and
                tilt, as the command does where it writes files.

        Raises:
            Infeasible: The placement violates constraints.
        """
        options = options_of(progress, threads, time_limit_s)
        if isinstance(placement, Placement):
            score = finished(PlacementScore, self._native.score(_place(placement), options))
        else:
            score = finished(PlacementScore, self._native.score_of(Path(placement), case, options))
        return finished(PlacementScore, _whole(score._native).mapped(options)) if deflection_map else score

    def explain(
        self, placement: Placement | File, point: int, beta_deg: float, case: Literal[1, 3] = 1
    ) -> Explanations:
        """What each of the eight postures gives at a path point (from 0) and a spindle angle beta (deg).

        Args:
            placement: The placement, or a results folder of `place` from the same files whose exact placement is taken.
            point: The path point, from 0.
            beta_deg: The spindle angle.
            case: Case of those results: 1, the best placement, or 3, the worst.

        Raises:
            ArgumentError: for a point that the path does not have.
        """
        point = checked_integer("path point", point, 0, self.point_count - 1)
        if isinstance(placement, Placement):
            return Explanations(self._native.explain(_place(placement), point, beta_deg))
        return Explanations(self._native.explain_of(Path(placement), case, point, beta_deg))


def _assignments(values: Mapping[str, object] | Sequence[str]) -> list[str]:
    """`key=value` with the value as TOML has it."""
    return [f"{key}={_toml(value)}" for key, value in values.items()] if isinstance(values, Mapping) else list(values)


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, (int, float)):
        return repr(value)
    raise ArgumentError(f"no value of a file, found {value!r}; allowed: numbers, texts, true, false and lists of them")


def _read_again(made: tuple[Any, ...], inputs: list[tuple[str, str]]) -> Run:
    (how, *changes) = made
    file, values, certify, seed, sensitivity = how
    run = Run(read_done(_stead.Run.read(file, values, certify, seed, sensitivity, options_of())), (how,))
    for name, digest in inputs:
        if (name, digest) not in run._native.inputs():
            problem = "has changed since the run that names it was pickled"
            raise InputError(f"{name}: {problem}", file=name, problem=problem)
    for change, *arguments in changes:
        run = run._changed(change, *arguments)
    return run
