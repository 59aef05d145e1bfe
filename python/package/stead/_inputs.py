"""The other inputs: one class for each kind of file, with `read` and a method for each command. What their jobs have in common is in `_jobs`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from . import _stead
from ._jobs import File, Progress, checked_seed, finished, options_of, read_done
from ._results import (
    Circularity,
    CompensatedPath,
    IdentifiedRobot,
    MeasurementPlan,
    RobotAssessment,
    SimulatedPass,
    StabilityAnalysis,
)

Variant = Literal["springs", "gravity", "orthogonal", "backlash"]


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
        return finished(RobotAssessment, self._native.assess(options_of(progress, threads, time_limit_s)))


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

    def fit(
        self,
        threads: int | None = None,
        *,
        progress: Progress | None = None,
        time_limit_s: float | None = None,
    ) -> IdentifiedRobot:
        """Fits compliances, gravity compensator and their covariance to the sheet.

        Raises:
            InputError: at the line of the sheet that is at fault.
            Error: where a sound sheet gives no robot, or the time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        return finished(IdentifiedRobot, self._native.fit(options_of(progress, threads, time_limit_s)))


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
        return cls(_stead.DesignRun.read(Path(file), checked_seed(seed)))

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
        return finished(MeasurementPlan, self._native.plan(options_of(progress, threads, time_limit_s)))


class CompensationRun:
    """A compensation file with its run and plan: `stead compensate`."""

    def __init__(self, native: _stead.CompensationRun) -> None:
        self._native = native

    @classmethod
    def read(
        cls,
        file: File,
        *,
        reality: File | None = None,
        progress: Progress | None = None,
        threads: int | None = None,
        time_limit_s: float | None = None,
    ) -> CompensationRun:
        """Reads a compensation file and the files that it names; `progress` and what follows as in `Run.read`.

        Args:
            file: The compensation file (TOML).
            reality: Robot file of the same geometry on which the corrected path is evaluated, instead of the file's.

        Raises:
            InputError: with file, line, field, value found and what is allowed.
        """
        options = options_of(progress, threads, time_limit_s)
        done = _stead.CompensationRun.read(Path(file), None if reality is None else Path(reality), options)
        return cls(read_done(done))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong."""
        return self._native.notes()

    def compensate(
        self,
        all_or_nothing: bool = False,
        threads: int | None = None,
        *,
        progress: Progress | None = None,
        time_limit_s: float | None = None,
    ) -> CompensatedPath:
        """Finds for every point the pose to command.

        Args:
            all_or_nothing: Fail where a point cannot be corrected, instead of keeping its target with a warning.
            threads: Number of threads; it does not change the result.
            progress: Called with stage, steps done and steps in all.
            time_limit_s: The job ends without a result after so many seconds.

        Raises:
            NotCompensated: Not one point can be compensated, or not all where all were asked for.
            Error: The time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        options = options_of(progress, threads, time_limit_s)
        return finished(CompensatedPath, self._native.compensate(all_or_nothing, options))


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

    def simulate(
        self,
        threads: int | None = None,
        *,
        progress: Progress | None = None,
        time_limit_s: float | None = None,
    ) -> SimulatedPass:
        """Simulates the pass with the whole kinematic chain.

        Args:
            threads: Number of threads; it does not change the result.
            progress: Called with stage, steps done and steps in all.
            time_limit_s: The job ends without a result after so many seconds.

        Raises:
            Error: for a pass too short to be judged, or the time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        options = options_of(progress, threads, time_limit_s)
        return finished(SimulatedPass, self._native.simulate(options))


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

    def analyse(
        self,
        threads: int | None = None,
        *,
        progress: Progress | None = None,
        time_limit_s: float | None = None,
    ) -> StabilityAnalysis:
        """Modes of the arm, frequency response at the tip, critical depth and stability lobes.

        Raises:
            Error: for an arm that says too little, or a cut without width, or the time was up.
            Interrupted: at Ctrl-C, without a result.
        """
        return finished(StabilityAnalysis, self._native.analyse(options_of(progress, threads, time_limit_s)))


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
