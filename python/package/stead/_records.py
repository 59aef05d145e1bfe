"""Parts of JSON documents with attributes named as their keys.

The meaning of each key is that of the documents which the commands print with `--json`; units are in the names.
"""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ._tables import Table

if TYPE_CHECKING:
    import pandas


class Record:
    """A part of a JSON document. Its keys are attributes; a key that this document leaves out is `None`."""

    _declared: ClassVar[frozenset[str]] = frozenset()
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {}
    _entries: Mapping[str, Any]

    def __init__(self, entries: Mapping[str, Any]) -> None:
        self._entries = entries

    def __init_subclass__(cls) -> None:
        own = (name for name in inspect.get_annotations(cls) if not name.startswith("_"))
        cls._declared = cls._declared | frozenset(own)

    def to_dict(self) -> dict[str, Any]:
        """A copy as plain Python objects, with the keys of the JSON document."""
        copy: dict[str, Any] = json.loads(json.dumps(self._entries))
        return copy

    # Not for type checkers: they know the declared keys, and find slips.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            if name not in self._entries:
                if name in self._declared:
                    return None
                known = ", ".join(self._entries)
                raise AttributeError(f"{type(self).__name__} has no {name!r}; there are: {known}")
            value = self._entries[name]
            make = self._made.get(name, Record)
            if isinstance(value, list):
                return [make(item) if isinstance(item, dict) else item for item in value]
            return make(value) if isinstance(value, dict) else value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._entries})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._entries == other._entries

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={_short(value)}' for key, value in self._entries.items())})"


def _short(value: Any) -> str:
    if isinstance(value, (list, dict)):
        return f"<{len(value)} {'items' if isinstance(value, list) else 'keys'}>"
    return repr(value)


class Input(Record):
    """A file that a result came from, with the SHA-256 digest of its bytes."""

    role: str
    name: str
    sha256: str


@dataclass(frozen=True)
class Placement:
    """Where the workpiece stands: its origin in the robot base frame (mm) and its yaw about the vertical (deg)."""

    x_mm: float
    y_mm: float
    z_mm: float
    yaw_deg: float

    @classmethod
    def from_q4(cls, x_mm: float, y_mm: float, z_mm: float, q4: float) -> Placement:
        """From the quaternion component Q4 = sin(yaw / 2), from -1 to 1, by which the papers state the yaw."""
        return cls(x_mm, y_mm, z_mm, math.degrees(2.0 * math.asin(q4)))

    @property
    def q4(self) -> float:
        """Q4 = sin(yaw / 2)."""
        return math.sin(math.radians(self.yaw_deg) / 2.0)

    @classmethod
    def _of(cls, entries: Mapping[str, float]) -> Placement:
        return cls(entries["x_mm"], entries["y_mm"], entries["z_mm"], entries["yaw_deg"])


class MeanAndMax(Record):
    """Mean and largest value over the path, in mm."""

    mean: float
    max: float


class Deflections(Record):
    """Deflection of the tool by direction, in mm: normal to the wall, to the stated surface, along feed and tool axis, and altogether."""

    wall: MeanAndMax
    surface: MeanAndMax | None
    feed: MeanAndMax
    axis: MeanAndMax
    total: MeanAndMax
    _made = dict.fromkeys(("wall", "surface", "feed", "axis", "total"), MeanAndMax)


class FeedLimit(Record):
    """What decides the highest feed: which kind of limit, of which joint (from 1) or external axis, in which segment, at which point."""

    kind: str
    joint: int | None
    external_axis: str | None
    segment: int
    point: int


class CutFeed(Record):
    """The programmed feed, and the highest that the joints hold, altogether and by segment."""

    programmed_mm_per_s: float
    highest_mm_per_s: float | None
    decided_by: FeedLimit | None
    segments_mm_per_s: list[float | None]
    _made = {"decided_by": FeedLimit}


class JointTurn(Record):
    """The largest turn of a joint (from 1) along 25 mm of the cut or less."""

    joint: int
    turn_deg: float
    length_mm: float
    points: list[int]


class JointTravel(Record):
    """How much the joints turn in the cut: all together, and at the most from one point to the next."""

    total_deg: float
    length_mm: float
    max_step_deg: float
    largest_turn: JointTurn | None
    _made = {"largest_turn": JointTurn}


class PlanFigures(Record):
    """What a plan of the spindle angle gives, in mm and s: what was minimised, mean and largest score, percentiles, times."""

    objective_mm: float
    mean_mm: float
    max_mm: float
    p50_mm: float
    p95_mm: float
    mean_std_mm: float | None
    deflection_mm: Deflections
    postures: list[int]
    joint_travel: JointTravel
    feed: CutFeed
    cutting_s: float
    cycle_s: float | None
    unfollowed_moves: list[Any]
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "deflection_mm": Deflections,
        "joint_travel": JointTravel,
        "feed": CutFeed,
    }

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


class Transfer(Record):
    """The move after a segment: time (`None` where a joint speed is unknown) and the longest way of a joint."""

    after_segment: int
    duration_s: float | None
    travel_deg: float


class ActiveBound(Record):
    """A bound that holds the placement back, and what moving it gains."""

    bound: str
    side: str
    gain: float
    unit: str


class StiffnessGain(Record):
    """What one per cent more stiffness of a joint (from 1) does to the figure that is minimised, with the spindle angle planned anew."""

    joint: int
    mm_per_percent: float
    percent_per_percent: float | None


class Case(PlanFigures):
    """One of the four cases: 1 and 2 the best placement with its best and its worst plan, 3 and 4 the worst placement likewise."""

    case: int
    placement: Placement
    placement_exact: Placement
    objective_by_stiffness: list[StiffnessGain] | None
    active_bounds: list[ActiveBound] | None
    transfers: list[Transfer]
    _made = {
        **PlanFigures._made,
        "placement": Placement._of,
        "placement_exact": Placement._of,
        "objective_by_stiffness": StiffnessGain,
        "active_bounds": ActiveBound,
        "transfers": Transfer,
    }


class Proof(Record):
    """A bound on what any placement can reach, and how far the one found is from it."""

    status: str
    placement: Placement
    found_mm: float
    value_mm: float
    bound_mm: float | None
    gap_percent: float | None
    limits_relaxed: list[str]
    nodes: int
    open_boxes: int
    with_beta_rate: bool
    _made = {"placement": Placement._of}


class Certificate(Record):
    """How far the placements found are from the best and the worst possible; the reason where there is no proof."""

    gap_percent_asked: float
    best: Proof | None
    best_reason: str | None
    worst: Proof | None
    worst_reason: str | None
    nodes: int
    memory_gb: float
    time_limit_s: float | None
    wall_s: float
    warnings: list[str]
    notes: list[str]
    inputs: list[Input]
    version: str
    format: int
    _made = {"best": Proof, "worst": Proof, "inputs": Input}


class Explanation(Record):
    """What one of the eight postures gives at a path point, and which constraints it violates."""

    posture: int
    feasible: bool
    joints_deg: list[float] | None
    inverse_condition: float | None
    normal_deflection_mm: float | None
    total_deflection_mm: float | None
    score_mm: float | None
    std_mm: float | None
    violations: list[str]


class ReferenceCircle(Record):
    """A reference circle of ISO 12181, in the frame of the points, and the circularity about it. mm"""

    center_x_mm: float
    center_y_mm: float
    center_z_mm: float | None
    radius_mm: float
    circularity_mm: float
    smallest_radius_mm: float
    largest_radius_mm: float


class Force(Record):
    """A force over the judged window of a simulated pass. N"""

    min_n: float
    max_n: float
    mean_n: float
    rms_n: float
