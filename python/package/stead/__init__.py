"""stead finds where to put a workpiece in a robot cell so that the robot machines it most accurately.

    import stead

    run = stead.Run.read("configs/caro-2013.toml")
    out = run.place()
    print(out)                      # the table that the command prints
    out.cases[0].mean_mm            # names are those of the JSON documents, with their units
    out.best.plan["theta1_deg"]     # numpy arrays, named as the columns of best.csv
    out.best.to_pandas()
    out.pictures["cell"]            # shown by a notebook
    out.write("results/mine")       # byte for byte what `stead place` leaves

There is one class for each kind of input file, with `read` and a method for each job, and one for each kind of result; `stead.command`
runs any command of the terminal, as `export`, `import path` or `check`. Files,
conventions and methods are explained in the user guide (`src/guide/` of the repository, `python.md` first).
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any, Literal

from . import _stead
from ._command import CommandError, Completed, command
from ._errors import ArgumentError, Error, Infeasible, InputError, Interrupted, Locked, NotCompensated, OutputError
from ._inputs import (
    AssessmentRun,
    CompensationRun,
    DesignRun,
    FitRun,
    Profile,
    SimulationRun,
    StabilityRun,
)
from ._records import Case, Certificate, Placement, PlanFigures, Record
from ._results import (
    Circularity,
    CompensatedPath,
    Explanations,
    Folder,
    IdentifiedRobot,
    MeasurementPlan,
    PlacementScore,
    Placements,
    Result,
    RobotAssessment,
    SimulatedPass,
    StabilityAnalysis,
    StudyReport,
    Warning,
)
from ._run import Run
from ._study import Finished, ShardStatus, Study, StudyCase, StudyStatus
from ._tables import Picture, Table

__version__ = _stead.__version__


def init(
    kind: Literal["place", "assess", "identify", "simulate", "study", "compensate", "forces"],
    folder: str | PathLike[str],
    *,
    force: bool = False,
) -> list[Path]:
    """Writes a commented starter set of files that runs. Returns their paths, the one to begin with first.

    With `force` files that are there are replaced.

    Raises:
        InputError: A file of that name is there already, or cannot be written; nothing is changed then.
    """
    return _stead.init(kind, Path(folder), force)


def schema(kind: str) -> dict[str, Any]:
    """The JSON Schema of a kind of input file: `run`, `robot`, `simulate`, `assess` and so on.

    Raises:
        ArgumentError: naming the nearest kind there is.
    """
    import json

    document: dict[str, Any] = json.loads(_stead.schema(kind))
    return document


__all__ = [
    "ArgumentError",
    "AssessmentRun",
    "Case",
    "Certificate",
    "Circularity",
    "CommandError",
    "CompensatedPath",
    "CompensationRun",
    "Completed",
    "DesignRun",
    "Error",
    "Explanations",
    "Finished",
    "FitRun",
    "Folder",
    "IdentifiedRobot",
    "Infeasible",
    "InputError",
    "Interrupted",
    "Locked",
    "MeasurementPlan",
    "NotCompensated",
    "OutputError",
    "Picture",
    "Placement",
    "PlacementScore",
    "Placements",
    "PlanFigures",
    "Profile",
    "Record",
    "Result",
    "RobotAssessment",
    "Run",
    "ShardStatus",
    "SimulatedPass",
    "SimulationRun",
    "StabilityAnalysis",
    "StabilityRun",
    "Study",
    "StudyCase",
    "StudyReport",
    "StudyStatus",
    "Table",
    "Warning",
    "command",
    "init",
    "schema",
]
