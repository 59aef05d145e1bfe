"""Records of JSON documents: those of the schemas, and what is added to them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from ._entries import (
    ActiveBound,
    ByOrigin,
    CaseEntries,
    Certificate,
    Clearance,
    CutFeed,
    Deflections,
    Explanation,
    ExternalAxes,
    FeedLimit,
    Force,
    HeldFeed,
    Input,
    JointTravel,
    JointTurn,
    MeanAndMax,
    PlanEntries,
    Proof,
    ReferenceCircle,
    ShortLine,
    StiffnessGain,
    Transfer,
    UnfollowedMove,
)
from ._record import Placement, Record
from ._tables import Table

if TYPE_CHECKING:
    import pandas

__all__ = [
    "ActiveBound",
    "ByOrigin",
    "Case",
    "Certificate",
    "Clearance",
    "CutFeed",
    "Deflections",
    "Explanation",
    "ExternalAxes",
    "FeedLimit",
    "Force",
    "HeldFeed",
    "Input",
    "JointTravel",
    "JointTurn",
    "MeanAndMax",
    "Placement",
    "PlanFigures",
    "Proof",
    "Record",
    "ReferenceCircle",
    "ShortLine",
    "StiffnessGain",
    "Transfer",
    "UnfollowedMove",
]


class PlanFigures(PlanEntries):
    """What a plan of the spindle angle gives, in mm and s, with the plan itself."""

    def __init__(self, entries: Mapping[str, Any], plan: Callable[[], Table] | None = None) -> None:
        super().__init__(entries)
        self._plan = plan

    @property
    def plan(self) -> Table:
        """The plan point by point, with the columns of `best.csv`: tool positions, spindle angle, joint angles, forces, deflections."""
        if self._plan is None:
            raise AttributeError("plan")
        return self._plan()

    def to_pandas(self) -> pandas.DataFrame:
        """The plan as a data frame, as pandas reads `best.csv`. Needs pandas."""
        return self.plan.to_pandas()


class Case(PlanFigures, CaseEntries):
    """One of the four cases: 1 and 2 the best placement with its best and its worst plan, 3 and 4 the worst placement likewise."""

    _made = CaseEntries._made
