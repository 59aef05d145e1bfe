"""Results: one class for each command."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import Any, ClassVar, NamedTuple

from . import _stead
from ._errors import ArgumentError
from ._records import (
    Case,
    Certificate,
    Explanation,
    Force,
    Input,
    Placement,
    PlanFigures,
    Record,
    ReferenceCircle,
)
from ._tables import Picture, Table


class Warning(NamedTuple):  # noqa: A001
    """Why a result may not be what was wanted: `kind`, the same for all warnings of a kind, and `message`, a sentence."""

    kind: str
    message: str

    def __str__(self) -> str:
        return self.message


class Folder:
    """A results folder, held so that no other run takes it during a long job: `with Folder("dir") as folder: out.write(folder)`.

    Raises `OutputError` where the folder cannot be written to or another run holds it.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        self._native = _stead.Folder(self.path)

    def release(self) -> None:
        """Lets other runs write to the folder."""
        self._native.release()

    def __enter__(self) -> Folder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()


@dataclass(frozen=True)
class _Kept:
    """What is left of a result that was pickled: all that it says, without what made it."""

    document: str
    printed: str
    noted: list[str]
    warned: list[tuple[str, str]]
    named: list[tuple[str, bytes]]

    @classmethod
    def of(cls, native: _stead.Outcome) -> _Kept:
        return cls(native.json(), native.text(), native.notes(), native.warnings(), native.files())

    def json(self) -> str:
        return self.document

    def text(self) -> str:
        return self.printed

    def notes(self) -> list[str]:
        return self.noted

    def warnings(self) -> list[tuple[str, str]]:
        return self.warned

    def files(self) -> list[tuple[str, bytes]]:
        return self.named


def _whole(native: _stead.Outcome | _Kept) -> _stead.Outcome:
    if isinstance(native, _Kept):
        raise ArgumentError(
            "a result that was pickled keeps what it says and the contents of its files (`files`); allowed: to write it, "
            "certify it or make its map in the process that made it"
        )
    return native


class Result(Record):
    """A result: `str()` is the text that the command prints, attributes are the keys of its JSON document.

    A result can be pickled. What comes out has the same document, text, tables and files, but cannot be written as a results folder.

    Attributes:
        inputs: The files that it came from.
        version: The version of stead that made it.
        format: The layout of the document.
    """

    inputs: list[Input]
    version: str
    format: int
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {"inputs": Input}

    def __init__(self, native: _stead.Outcome | _Kept) -> None:
        self._native = native

    def __reduce__(self) -> tuple[Any, ...]:
        native = self._native
        kept = native if isinstance(native, _Kept) else _Kept.of(native)
        return type(self), (kept,)

    @cached_property
    def _entries(self) -> Mapping[str, Any]:  # type: ignore[override]
        entries: dict[str, Any] = json.loads(self._native.json())
        return entries

    def to_json(self) -> str:
        """The JSON document, byte for byte as the command prints it with `--json`."""
        return self._native.json()

    def write(self, folder: str | PathLike[str] | Folder) -> list[Path]:
        """Writes the files that the command leaves, byte for byte, and `manifest.json`. Returns their paths.

        Args:
            folder: Made where it is missing; or one that is held already.

        Raises:
            OutputError: The folder or a file cannot be written, or another run writes to it.
        """
        if isinstance(folder, Folder):
            return _whole(self._native).write_in(folder._native)
        return _whole(self._native).write(Path(folder))

    @property
    def notes(self) -> list[str]:
        """What the user should know about the input though it is not wrong: assumptions, and values left at their defaults."""
        return self._native.notes()

    @property
    def warnings(self) -> list[Warning]:
        """Why the result may not be what was wanted."""
        return [Warning(*warning) for warning in self._native.warnings()]

    @cached_property
    def files(self) -> dict[str, bytes]:
        """Name and content of each file that `write` leaves, without the manifest."""
        return dict(self._native.files())

    @cached_property
    def tables(self) -> dict[str, Table]:
        """The tables by the names of their CSV files, without `.csv`."""
        return {name[:-4]: Table(data.decode()) for name, data in self.files.items() if name.endswith(".csv")}

    @cached_property
    def pictures(self) -> dict[str, Picture]:
        """The pictures by the names of their SVG files, without `.svg`."""
        return {name[:-4]: Picture(data.decode()) for name, data in self.files.items() if name.endswith(".svg")}

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        return f"<stead.{type(self).__name__}>"


class Placements(Result):
    """The best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III."""

    summary: list[Record]
    evaluations: int
    states: int
    interrupted: bool
    threads: int
    wall_s: float
    states_per_second: float | None
    table: Record
    refinements: list[Record]
    reference: Record | None
    path_levels: Record | None
    stiffness_sets: Record | None
    sensitivity: Record | None
    setup_sheet: Record | None
    stability: Record | None
    certificate: Certificate | None
    _made = {**Result._made, "certificate": Certificate}

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """The four cases, in their order; the first two where the worst placement was not looked for."""
        tables = ("best", "best-worst-plan", "worst", "worst-worst-plan")

        def case(entries: dict[str, Any], table: str) -> Case:
            return Case(entries, lambda: self.tables[table])

        return tuple(case(entries, table) for entries, table in zip(self._entries["cases"], tables))

    @property
    def best(self) -> Case:
        """Case 1: the best placement with its best plan."""
        return self.cases[0]

    @property
    def worst(self) -> Case:
        """Case 3: the worst placement with its best plan.

        Raises:
            ArgumentError: where the worst placement was not looked for.
        """
        if len(self.cases) < 3:
            raise ArgumentError("the worst placement was not looked for; allowed: a run with it")
        return self.cases[2]


class PlacementScore(Result):
    """A given placement with its best and its worst plan."""

    summary: list[Record]
    placement: Placement
    placement_exact: Placement
    feasible: bool
    interrupted: bool
    setup_sheet: Record | None
    stability: Record | None
    orientation: str | None
    external_axes: Record | None
    leans_deg: list[list[float]] | None
    _made = {**Result._made, "placement": Placement._of, "placement_exact": Placement._of}

    @cached_property
    def best(self) -> PlanFigures:
        """The best plan of the spindle angle."""
        return PlanFigures(self._entries["best"], lambda: self.tables["best-plan"])

    @cached_property
    def worst(self) -> PlanFigures:
        """The worst plan of the spindle angle."""
        return PlanFigures(self._entries["worst"], lambda: self.tables["worst-plan"])


class Explanations(Result):
    """What each of the eight postures gives at one path point and one spindle angle. Leaves no files."""

    placement: Placement
    point: int
    beta_deg: float
    postures: list[Explanation]
    _made = {**Result._made, "placement": Placement._of, "postures": Explanation}


class RobotAssessment(Result):
    """Circularity maps, zones and rankings of robots."""

    robots: list[Record]
    order: list[str]
    accuracies: list[Record]
    selection: list[Record]
    reference: Record | None
    threads: int
    wall_s: float


class IdentifiedRobot(Result):
    """Joint compliances with their covariance; the robot file that states them is `files["robot-identified.toml"]`."""

    robot: str
    model: str | None
    compliances: list[Record]
    arm: list[Record]
    springs: list[Record] | None
    compensator: Record | None
    configurations: int
    readings: int
    degrees_of_freedom: int
    noise_mm: float
    noise_estimated: bool
    noise_ratio: float
    residual_rms_mm: float
    leave_one_out: Record
    outliers: list[Record]
    outliers_searched: bool
    held: list[Record]
    held_springs: list[str] | None
    law_probability: float | None
    setup: Record


class MeasurementPlan(Result):
    """Configurations and loads to measure, and what they will tell; the sheet to fill in is `files["sheet.csv"]`."""

    robot: str
    configurations: list[Record]
    compliances: list[Record]
    compensator: list[Record]
    deflection: Record
    candidates: Record
    hardly_seen: list[Record]
    unseen: list[Record]
    load_n: float
    noise_mm: float
    points: int
    seed: int
    travel_deg: float


class CompensatedPath(Result):
    """A corrected path, with what remains of the deflection; point by point in `tables["corrected-path"]`."""

    robot: str
    reality: str | None
    model: str
    placement: Placement
    points: int
    corrected: int
    not_corrected: list[Record]
    before: Record
    after: Record
    normal: Record
    correction: Record
    reduction_percent: float | None
    gravity: bool | None
    alpha: float
    iterations: int
    max_iterations: int
    tolerance_mm: float
    _made = {**Result._made, "placement": Placement._of}


class SimulatedPass(Result):
    """A simulated pass: forces (`tables["series"]`), the wall that is left (`tables["wall"]`), and whether the cut stayed calm."""

    robot: str
    variant: str
    end: str
    end_reason: str | None
    judgement: str
    stable: bool
    small_motions: Record
    force_x: Force
    force_y: Force
    profile: Record | None
    modes: list[Record]
    published: Record | None
    spindle_rpm: float
    damping_scale: float
    step_s: float
    steps: int
    steps_per_turn: int
    slices: int
    evaluations: int
    unrest: float | None
    unrest_of_teeth_alike: float | None
    window_s: list[float]
    real_time_factor: float
    wall_s: float
    _made = {**Result._made, "force_x": Force, "force_y": Force}


class StabilityAnalysis(Result):
    """Whether a cut chatters: `tables["modes"]`, `tables["frequency-response"]` and `tables["lobes"]`.

    The numbers are those of the cut that the file states: how fast small motions grow, where along the pass, and the critical depths.
    """

    robot: str
    variant: str
    kind: str
    stable: bool
    growth_rate_per_s: float
    growth_in_pass: float
    pass_time_s: float
    way_mm: float
    axial_depth_mm: float
    max_depth_mm: float
    critical_depth_mm: Record
    modes: list[Record]
    lobes: list[Record]
    spindle_rpm: float
    damping_scale: float


class StudyReport(Result):
    """What a study says that is done: `tables["study-ranking"]`, `tables["study-front"]` and `tables["study-effects"]`, with pictures."""

    study: str
    noise_percent: float
    tasks_joined: bool
    ranking: Record
    tasks: list[Record]
    front: Record | None
    effects: Record
    map: Record | None
    failures: Record


class Circularity(Result):
    """The four reference circles of a profile, and every point's deviation from them in `tables["deviations"]`."""

    input: Record
    points: int
    excluded: int
    plane: Record | None
    lsc: ReferenceCircle
    mzc: ReferenceCircle
    mic: ReferenceCircle
    mcc: ReferenceCircle
    _made = {**Result._made, **dict.fromkeys(("lsc", "mzc", "mic", "mcc"), ReferenceCircle)}
