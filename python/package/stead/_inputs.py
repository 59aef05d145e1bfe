"""Inputs: one class for each kind of file, with `read` and a method for each command.

Long jobs run without the global interpreter lock. What they have in common:

- `progress(stage, done, total)` is called on the calling thread, a few times a second and once at the end; what it raises stops the job. Of
  a certificate, `done` are the nodes bounded and `total` those and the open ones.
- `threads`: by default one for each processor. It does not change a result.
- `time_limit_s`: the job ends then with what it has.
- Ctrl-C stops a job that takes `progress`, and raises `Interrupted`, a `KeyboardInterrupt` with what was found as `result`; the second one
  does not wait. Other jobs raise `KeyboardInterrupt` at once, and what they have begun ends unheard.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Literal, TypeVar

from . import _stead
from ._errors import ArgumentError, Interrupted
from ._records import Placement
from ._results import (
    Circularity,
    CompensatedPath,
    Explanations,
    IdentifiedRobot,
    MeasurementPlan,
    PlacementScore,
    Placements,
    Result,
    RobotAssessment,
    SimulatedPass,
    StabilityAnalysis,
    Warning,
)

File = str | PathLike[str]
Progress = Callable[[str, int, int], object]
Variant = Literal["springs", "gravity", "orthogonal", "backlash"]
_R = TypeVar("_R", bound=Result)


def _options(
    progress: Progress | None = None, threads: int | None = None, time_limit_s: float | None = None
) -> _stead._Options:
    if threads is not None and threads < 1:
        raise ArgumentError(f"no such number of threads, found {threads}; allowed: 1 or more")
    return {"progress": progress, "threads": threads, "time_limit_s": time_limit_s}


def _finished(kind: type[_R], done: tuple[_stead.Outcome | None, bool]) -> _R:
    """The result of a job, or `Interrupted` with it."""
    outcome, was_stopped = done
    result = kind(outcome) if outcome is not None else None
    if was_stopped or result is None:
        raise Interrupted(result)
    return result


def _seed(seed: int | None) -> int | None:
    if seed is not None and not 0 <= seed < 2**63:
        raise ArgumentError(f"no such seed, found {seed}; allowed: a whole number from 0 to {2**63 - 1}")
    return seed


def _place(placement: Placement) -> _stead._Place:
    return (placement.x_mm, placement.y_mm, placement.z_mm, placement.yaw_deg)


class Run:
    """A run file with the robot and the task that it names: `stead place`, `stead score`, `stead explain`."""

    def __init__(self, native: _stead.Run) -> None:
        self._native = native

    @classmethod
    def read(
        cls, file: File, *, certify: float | None = None, seed: int | None = None, sensitivity: bool = False
    ) -> Run:
        """Reads a run file and the files that it names.

        Args:
            file: The run file (TOML).
            certify: Gap of a certificate in per cent, whatever the file says of one.
            seed: Seed of the random numbers, instead of the file's.
            sensitivity: Refine once more for force errors of 10 %, and say how far the best placement moves.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
        """
        return cls(_stead.Run.read(Path(file), certify, _seed(seed), sensitivity))

    def with_seed(self, seed: int) -> Run:
        """The same run with another seed of the random numbers."""
        _seed(seed)
        return Run(self._native.with_seed(seed))

    def with_sensitivity(self, force_error: float) -> Run:
        """The same run, refined once more where scores have to cover force errors of this relative size (0.1 for 10 %)."""
        return Run(self._native.with_sensitivity(force_error))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

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
        return _finished(Placements, self._native.place(_options(progress, threads, time_limit_s), certify))

    def certify(
        self,
        placements: Placements,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
    ) -> Placements:
        """These placements with the certificate that their run asks for: bounds how far they are from the best and the worst possible."""
        done = placements._native.certified(_options(progress, threads, time_limit_s))
        return _finished(Placements, done)

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
            time_limit_s: After so many seconds the critical depths and the map are left out.
            deflection_map: Also make the deflection map, as the command does where it writes files.

        Raises:
            Infeasible: The placement violates constraints.
        """
        options = _options(progress, threads, time_limit_s)
        if isinstance(placement, Placement):
            score = _finished(PlacementScore, self._native.score(_place(placement), options))
        else:
            score = _finished(PlacementScore, self._native.score_of(Path(placement), case, options))
        return _finished(PlacementScore, score._native.mapped(options)) if deflection_map else score

    def explain(self, placement: Placement, point: int, beta_deg: float) -> Explanations:
        """What each of the eight postures gives at a path point (from 0) and a spindle angle beta (deg).

        Raises:
            ArgumentError: for a point that the path does not have.
        """
        if point < 0:
            raise ArgumentError(f"no such path point, found {point}; allowed: 0 to {self.point_count - 1}")
        return Explanations(self._native.explain(_place(placement), point, beta_deg))


class AssessmentRun:
    """An assessment file with its robots: `stead assess`."""

    def __init__(self, native: _stead.AssessmentRun) -> None:
        self._native = native

    @classmethod
    def read(cls, file: File, *, accuracy_mm: float | None = None, force_n: float | None = None) -> AssessmentRun:
        """Reads an assessment file; robots are ranked by accuracy and cutting force, where given instead of the file's.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
            ArgumentError: where only one of accuracy and force is known.
        """
        return cls(_stead.AssessmentRun.read(Path(file), accuracy_mm, force_n))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    def assess(
        self, progress: Progress | None = None, threads: int | None = None, time_limit_s: float | None = None
    ) -> RobotAssessment:
        """Maps the circularity of a milled circle for every robot, and ranks the robots.

        Raises:
            Error: No robot can mill the circle anywhere, or the time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        return _finished(RobotAssessment, self._native.assess(_options(progress, threads, time_limit_s)))


class FitRun:
    """An identification file with a filled measurement sheet: `stead identify fit`."""

    def __init__(self, native: _stead.FitRun) -> None:
        self._native = native

    @classmethod
    def read(cls, file: File) -> FitRun:
        """Reads an identification file and the files that it names.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
        """
        return cls(_stead.FitRun.read(Path(file)))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    def fit(self, threads: int | None = None) -> IdentifiedRobot:
        """Fits compliances, gravity compensator and their covariance to the sheet.

        Raises:
            InputError: at the line of the sheet that is at fault.
            Error: where a sound sheet gives no robot.
        """
        return IdentifiedRobot(self._native.fit(_options(threads=threads)))


class DesignRun:
    """An identification file with a table `[plan]`: `stead identify plan`."""

    def __init__(self, native: _stead.DesignRun) -> None:
        self._native = native

    @classmethod
    def read(cls, file: File, *, seed: int | None = None) -> DesignRun:
        """Reads an identification file and the robot that it names, with another seed of the random numbers where given.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
        """
        return cls(_stead.DesignRun.read(Path(file), _seed(seed)))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    def check_folder(self, folder: File) -> None:
        """Refuses a folder whose measurement sheet has readings in it, with `InputError`."""
        self._native.check_folder(Path(folder))

    def plan(
        self, progress: Progress | None = None, threads: int | None = None, time_limit_s: float | None = None
    ) -> MeasurementPlan:
        """Chooses the configurations and loads to measure.

        Raises:
            InputError: where too little was asked for.
            Error: where nothing was found.
            Interrupted: at Ctrl-C.
        """
        return _finished(MeasurementPlan, self._native.plan(_options(progress, threads, time_limit_s)))


class CompensationRun:
    """A compensation file with its run and plan: `stead compensate`."""

    def __init__(self, native: _stead.CompensationRun) -> None:
        self._native = native

    @classmethod
    def read(cls, file: File, *, reality: File | None = None) -> CompensationRun:
        """Reads a compensation file and the files that it names.

        Args:
            file: The compensation file (TOML).
            reality: Robot file of the same geometry on which the corrected path is evaluated, instead of the file's.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
        """
        return cls(_stead.CompensationRun.read(Path(file), None if reality is None else Path(reality)))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    def compensate(self, all_or_nothing: bool = False, threads: int | None = None) -> CompensatedPath:
        """Finds for every point the pose to command.

        Args:
            all_or_nothing: Fail where a point cannot be corrected, instead of keeping its target with a warning.
            threads: Number of threads; it does not change the result.

        Raises:
            NotCompensated: Not one point can be compensated, or not all where all were asked for.
        """
        return CompensatedPath(self._native.compensate(all_or_nothing, _options(threads=threads)))


class SimulationRun:
    """A simulation file with its robot: `stead simulate`."""

    def __init__(self, native: _stead.SimulationRun) -> None:
        self._native = native

    @classmethod
    def read(
        cls,
        file: File,
        *,
        variant: Variant | None = None,
        damping_scale: float | None = None,
        spindle_rpm: float | None = None,
    ) -> SimulationRun:
        """Reads a simulation file and its robot, with some values in place of the file's.

        Args:
            file: The simulation file (TOML).
            variant: How much of the arm is modelled.
            damping_scale: Factor on all damping of the arm.
            spindle_rpm: Spindle speed in rev/min.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
            ArgumentError: for a value out of range.
        """
        return cls(_stead.SimulationRun.read(Path(file), variant, damping_scale, spindle_rpm))

    def simulate(self, condensed: bool = False, threads: int | None = None) -> SimulatedPass:
        """Simulates the pass with the whole kinematic chain.

        Args:
            condensed: With mass matrix and Jacobian frozen every few millimetres, as `stead simulate --fast`.
            threads: Number of threads; it does not change the result.

        Raises:
            Error: for a pass too short to be judged.
        """
        return SimulatedPass(self._native.simulate(condensed, _options(threads=threads)))


class StabilityRun:
    """A simulation file with its robot: `stead stability`."""

    def __init__(self, native: _stead.StabilityRun) -> None:
        self._native = native

    @classmethod
    def read(
        cls,
        file: File,
        *,
        variant: Variant | None = None,
        damping_scale: float | None = None,
        spindle_rpm: float | None = None,
    ) -> StabilityRun:
        """Reads a simulation file and its robot; arguments and exceptions as in `SimulationRun.read`."""
        return cls(_stead.StabilityRun.read(Path(file), variant, damping_scale, spindle_rpm))

    def analyse(self, threads: int | None = None) -> StabilityAnalysis:
        """Modes of the arm, frequency response at the tip, critical depth and stability lobes.

        Raises:
            Error: for an arm that says too little, or a cut without width.
        """
        return StabilityAnalysis(self._native.analyse(_options(threads=threads)))


class Profile:
    """Measured points of a circular profile: `stead circularity`."""

    def __init__(self, native: _stead.Profile) -> None:
        self._native = native

    @classmethod
    def read(cls, file: File) -> Profile:
        """Reads measured points: a CSV file with `x_mm,y_mm` or `x_mm,y_mm,z_mm`.

        Raises:
            InputError: with file, line, column, value found and what is allowed.
        """
        return cls(_stead.Profile.read(Path(file)))

    def circularity(self, exclude_deg: Sequence[tuple[float, float]] = ()) -> Circularity:
        """The four reference circles of ISO 12181 and the circularity about each.

        Args:
            exclude_deg: Sectors to leave out, from angle to angle counter-clockwise about the least-squares centre.

        Raises:
            InputError: for points on a line, or too few.
            ArgumentError: for angles that are not from -360 to 360 deg.
        """
        return Circularity(self._native.circularity(list(exclude_deg)))
