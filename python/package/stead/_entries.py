"""Parts of JSON documents: made of the output schemas, as a test of the report crate holds it. Do not edit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from ._record import Placement, Record


class Input(Record):
    """A file that a result depends on."""

    name: str
    role: str
    sha256: str


class MeanAndMax(Record):
    """Mean and largest value of a deflection over the path points."""

    max: float
    mean: float


class Deflections(Record):
    """How large a deflection is in each direction and altogether, in mm."""

    axis: MeanAndMax
    feed: MeanAndMax
    surface: MeanAndMax | None
    total: MeanAndMax
    wall: MeanAndMax
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "axis": MeanAndMax,
        "feed": MeanAndMax,
        "surface": MeanAndMax,
        "total": MeanAndMax,
        "wall": MeanAndMax,
    }


class FeedLimit(Record):
    """What decides the highest feed: a joint or an external axis, and where."""

    external_axis: str | None
    joint: int | None
    kind: str
    point: int
    segment: int


class CutFeed(Record):
    """Feeds of a plan."""

    decided_by: FeedLimit | None
    highest_mm_per_s: float | None
    programmed_mm_per_s: float
    segments_mm_per_s: list[float | None]
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "decided_by": FeedLimit,
    }


class JointTurn(Record):
    """A turn of a joint along the path."""

    joint: int
    length_mm: float
    points: list[int]
    turn_deg: float


class JointTravel(Record):
    """How much the joints turn in the cut."""

    largest_turn: JointTurn | None
    length_mm: float
    max_step_deg: float
    total_deg: float
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "largest_turn": JointTurn,
    }


class Clearance(Record):
    """The least clearance at the points of a plan."""

    distance_mm: float
    pair: list[str]
    point: int


class UnfollowedMove(Record):
    """A straight move of the tool that the arm cannot follow."""

    since: str
    to_point: int


class HeldFeed(Record):
    """A plan at the feed that the arm holds."""

    deflection_mm: Deflections
    max_mm: float
    mean_mm: float
    slowed_segments: int
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "deflection_mm": Deflections,
    }


class ByOrigin(Record):
    """What each thing that yields adds to the scored part; one below 0 takes from the others."""

    axes_mm: float
    base_mm: float
    mount_mm: float
    normal_by_joint_mm: list[float]
    normal_mm: float
    part_mm: float
    tip_mm: float


class PlanEntries(Record):
    """A plan with its feeds and times."""

    at_held_feed: HeldFeed | None
    by_origin_mm: ByOrigin | None
    clearance: Clearance | None
    cutting_s: float
    cycle_s: float | None
    deflection_mm: Deflections
    feed: CutFeed
    joint_travel: JointTravel
    max_mm: float
    mean_mm: float
    mean_std_mm: float | None
    objective_mm: float
    p50_mm: float
    p95_mm: float
    posture_words: list[str]
    postures: list[int]
    sag_mm: Record | None
    unfollowed_moves: list[UnfollowedMove]
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "at_held_feed": HeldFeed,
        "by_origin_mm": ByOrigin,
        "clearance": Clearance,
        "deflection_mm": Deflections,
        "feed": CutFeed,
        "joint_travel": JointTravel,
        "unfollowed_moves": UnfollowedMove,
    }


class ShortLine(Record):
    """A line along the tool axis that is not as long as it should be."""

    length_mm: float
    since: str
    wanted_mm: float


class Transfer(Record):
    """A move between two segments."""

    after_segment: int
    approaches: bool | None
    blocked_by: str | None
    duration_s: float | None
    joints_deg: list[list[float]] | None
    retracts: bool | None
    short_lines: list[ShortLine | None] | None
    travel_deg: float
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "short_lines": ShortLine,
    }


class ActiveBound(Record):
    """A bound that holds an optimum."""

    bound: str
    gain: float
    side: str
    unit: str


class StiffnessGain(Record):
    """What one per cent more stiffness of a joint, or of one of its springs, does to the objective."""

    joint: int
    mm_per_percent: float
    percent_per_percent: float | None
    spring: str | None


class ExternalAxes(Record):
    """Positions of external axes."""

    axes: list[Record]
    for_each: str
    positions: list[list[float]]


class CaseEntries(Record):
    """A case: where the workpiece is, and how it is milled there."""

    active_bounds: list[ActiveBound] | None
    at_held_feed: HeldFeed | None
    by_origin_mm: ByOrigin | None
    case: int
    clearance: Clearance | None
    cutting_s: float
    cycle_s: float | None
    deflection_mm: Deflections
    external_axes: ExternalAxes | None
    feed: CutFeed
    joint_travel: JointTravel
    leans_deg: list[list[float]] | None
    max_mm: float
    mean_mm: float
    mean_std_mm: float | None
    objective_by_stiffness: list[StiffnessGain] | None
    objective_mm: float
    orientation: str | None
    p50_mm: float
    p95_mm: float
    placement: Placement
    placement_exact: Placement
    posture_words: list[str]
    postures: list[int]
    sag_mm: Record | None
    transfers: list[Transfer]
    unfollowed_moves: list[UnfollowedMove]
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "active_bounds": ActiveBound,
        "at_held_feed": HeldFeed,
        "by_origin_mm": ByOrigin,
        "clearance": Clearance,
        "deflection_mm": Deflections,
        "external_axes": ExternalAxes,
        "feed": CutFeed,
        "joint_travel": JointTravel,
        "objective_by_stiffness": StiffnessGain,
        "placement": Placement._of,
        "placement_exact": Placement._of,
        "transfers": Transfer,
        "unfollowed_moves": UnfollowedMove,
    }


class Proof(Record):
    """What is proved of a placement."""

    bound_mm: float
    found_mm: float
    gap_percent: float
    limits_relaxed: list[str]
    nodes: int
    open_boxes: int
    placement: Placement
    status: str
    value_mm: float
    with_beta_rate: bool
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "placement": Placement._of,
    }


class Certificate(Record):
    """How far the placements found are from the best and the worst possible; the reason where there is no proof."""

    best: Proof | None
    best_reason: str | None
    format: int
    gap_percent_asked: float
    inputs: list[Input]
    memory_gb: float
    nodes: int
    notes: list[str]
    sentence: str | None
    time_limit_s: float | None
    version: str
    wall_s: float | None
    warnings: list[str]
    worst: Proof | None
    worst_reason: str | None
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "best": Proof,
        "inputs": Input,
        "worst": Proof,
    }


class Explanation(Record):
    """A posture at a path point; its figures are null where it is out of reach."""

    by_origin_mm: ByOrigin | None
    feasible: bool
    inverse_condition: float | None
    joints_deg: list[float] | None
    normal_deflection_mm: float | None
    posture: int
    posture_words: str
    score_mm: float | None
    std_mm: float | None
    total_deflection_mm: float | None
    violations: list[str]
    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {
        "by_origin_mm": ByOrigin,
    }


class ReferenceCircle(Record):
    """A reference circle."""

    center_x_mm: float
    center_y_mm: float
    center_z_mm: float | None
    circularity_mm: float
    largest_radius_mm: float
    radius_mm: float
    smallest_radius_mm: float


class Force(Record):
    """A force over time."""

    max_n: float
    mean_n: float
    min_n: float
    rms_n: float
