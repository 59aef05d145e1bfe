//! What all JSON documents have in common: what they state first, their bytes, and views that several of them hold.

use crate::figure::{AngleDeg, DeflectionMm, PlaceMm, Plain, SpeedMmPerS};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use stead_disk::input::InputFile;
use stead_numerics::mean_max::MeanAndMax;
use stead_placement::outcome::DeflectionFigures;
use stead_planning::feed::{CutFeed, FeedLimit, FeedLimitKind};
use stead_problem::joint_travel::{JointTravel, Swing};
use stead_problem::problem::Placement;

/// How long a computation took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Time on the clock. s
    pub wall: f64,
    /// Threads used.
    pub threads: usize,
}

/// The layout of every JSON document of stead; raised when a key goes or changes its meaning, not when one is added.
pub const FORMAT: u32 = 1;

/// A JSON document of stead: what every one states first, and its result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Document<T = ()> {
    /// Layout of the document.
    format: u32,
    /// Version of stead that made it.
    version: &'static str,
    /// The files the result depends on.
    inputs: Vec<Input>,
    /// What the result rests on: assumptions made and values left at their defaults.
    notes: Vec<String>,
    /// Why the result may not be what was wanted.
    warnings: Vec<String>,
    #[serde(flatten)]
    result: T,
}

records! {
    /// A file that a result depends on.
    pub struct Input of (file: &InputFile) {
        /// What the file is for: `config`, `robot`, `task` and the like.
        role: &'static str = file.role,
        /// For the config its file name, for the others the path as the config gives it.
        name: String = file.name.clone(),
        /// SHA-256 digest of its bytes, in hexadecimal.
        sha256: String = file.sha256.clone(),
    }
}

impl Document {
    /// A document on what was computed from these files, without notes and warnings yet.
    pub fn new(inputs: &[InputFile]) -> Self {
        Self {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION"),
            inputs: inputs.iter().map(Input::of).collect(),
            notes: Vec::new(),
            warnings: Vec::new(),
            result: (),
        }
    }

    /// States what the result rests on: assumptions made and values left at their defaults.
    pub fn notes(mut self, notes: impl IntoIterator<Item = impl ToString>) -> Self {
        self.notes.extend(notes.into_iter().map(|note| note.to_string()));
        self
    }

    /// States why the result may not be what was wanted.
    pub fn warnings(mut self, warnings: impl IntoIterator<Item = impl ToString>) -> Self {
        self.warnings.extend(warnings.into_iter().map(|warning| warning.to_string()));
        self
    }

    /// The document with a result, whose entries join those of the document.
    pub fn with<T: Serialize>(self, result: T) -> Value {
        let Self { format, version, inputs, notes, warnings, .. } = self;
        value(&Document { format, version, inputs, notes, warnings, result })
    }
}

/// A result as a JSON value, its keys in alphabetical order.
pub(crate) fn value(result: &impl Serialize) -> Value {
    // Only maps whose keys are no strings cannot be written, and there are none.
    serde_json::to_value(result).unwrap_or_default()
}

/// A document as the bytes of a file or of standard output: indented, with a line break at the end.
pub fn bytes(document: &Value) -> Vec<u8> {
    format!("{document:#}\n").into_bytes()
}

/// A document as bytes without spaces, for files that only programs read.
pub(crate) fn compact(document: &impl serde::Serialize) -> Vec<u8> {
    // Only maps whose keys are no strings cannot be written, and there are none.
    serde_json::to_vec(document).unwrap_or_default()
}

records! {
    /// A placement: the workpiece origin in the base frame of the robot, or in that of the cell where the robot is
    /// mounted.
    #[derive(Copy, Default)]
    pub struct PlacementFigures from placement: &Placement {
        /// x of the workpiece origin.
        pub x_mm: PlaceMm = placement.x.into(),
        /// y of the workpiece origin.
        pub y_mm: PlaceMm = placement.y.into(),
        /// z of the workpiece origin.
        pub z_mm: PlaceMm = placement.z.into(),
        /// Rotation about z.
        pub yaw_deg: AngleDeg = placement.yaw.into(),
        /// The quaternion component that states the yaw (Caro 2013, eq. 4).
        pub q4: Plain = placement.q4().into(),
    }

    /// A placement with every digit, so that reading it again gives the same placement.
    #[derive(Copy, Default)]
    pub struct PlacementExact from placement: &Placement {
        /// x of the workpiece origin. mm
        x_mm: f64 = placement.x * 1e3,
        /// y of the workpiece origin. mm
        y_mm: f64 = placement.y * 1e3,
        /// z of the workpiece origin. mm
        z_mm: f64 = placement.z * 1e3,
        /// Rotation about z. deg
        yaw_deg: f64 = placement.yaw.to_degrees(),
    }

    /// Mean and largest value of a deflection over the path points.
    #[derive(Copy)]
    pub struct DeflectionMean from figures: MeanAndMax {
        /// Mean.
        pub mean: DeflectionMm = figures.mean.into(),
        /// Largest.
        pub max: DeflectionMm = figures.max.into(),
    }

    /// How large a deflection is in each direction and altogether, in mm.
    #[derive(Copy)]
    pub struct DeflectionByDirection from figures: &DeflectionFigures {
        /// Normal to feed and tool axis.
        pub wall: DeflectionMean = figures.wall.into(),
        /// Along the normal of the surface; null where the task states none.
        pub surface: Option<DeflectionMean> = figures.surface.map(Into::into),
        /// Along the feed.
        pub feed: DeflectionMean = figures.feed.into(),
        /// Along the tool axis.
        pub axis: DeflectionMean = figures.axis.into(),
        /// The size of the whole.
        pub total: DeflectionMean = figures.total.into(),
    }

    /// Feeds of a plan.
    pub struct FeedFigures from feed: &CutFeed {
        let highest = feed.highest();
        let speed = |limit: FeedLimit| limit.feed.into();
    } with {
        /// The programmed feed.
        programmed_mm_per_s: SpeedMmPerS = feed.programmed.into(),
        /// The highest that the plan holds; null where no limit of the joints is known.
        highest_mm_per_s: Option<SpeedMmPerS> = highest.map(speed),
        /// What decides the highest.
        decided_by: Option<FeedDecision> = highest.map(|limit: FeedLimit| FeedDecision::of(limit, feed)),
        /// The highest of each segment.
        segments_mm_per_s: Vec<Option<SpeedMmPerS>> = feed.segments.iter().map(|limit| limit.map(speed)).collect(),
    }

    /// What decides the highest feed: a joint or an external axis, and where.
    pub struct FeedDecision of (limit: FeedLimit, feed: &CutFeed) {
        let external_axis = feed.external_axis(&limit).map(|name| name.to_owned());
        let FeedLimit { kind, joint, segment, point, .. } = limit;
    } with {
        /// Which of its limits.
        #[schemars(with = "String")] kind: FeedLimitKind = kind,
        /// The joint, from 1; null where it is an external axis.
        joint: Option<usize> = external_axis.is_none().then_some(joint),
        /// The external axis.
        external_axis?: String = external_axis,
        /// The segment, from 1.
        segment: usize = segment,
        /// The path point, from 0.
        point: usize = point,
    }

    /// How much the joints turn in the cut.
    #[derive(Copy)]
    pub struct JointTravelFigures from travel: &JointTravel {
        /// What all joints turn.
        total_deg: AngleDeg = travel.total.into(),
        /// Length of the path that they do it on.
        length_mm: PlaceMm = travel.length.into(),
        /// The largest turn of one joint from a point to the next.
        max_step_deg: AngleDeg = travel.largest_step.into(),
        /// The largest turn of a joint along a short stretch of the path.
        largest_turn: Option<LargestTurn> = travel.swing.as_ref().map(Into::into),
    }

    /// A turn of a joint along the path.
    #[derive(Copy)]
    pub struct LargestTurn from swing: &Swing {
        /// The joint, from 1.
        joint: usize = swing.joint,
        /// How far it turns.
        turn_deg: AngleDeg = swing.angle.into(),
        /// Length of the path on which it does.
        length_mm: PlaceMm = swing.length.into(),
        /// The path points of its start and its end, from 0.
        points: [usize; 2] = swing.points,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// What decides the feed is a joint by its number or an external axis by its name.
    #[test]
    fn the_external_axis_that_decides_the_feed_is_named() {
        use stead_planning::feed::FeedLimitKind;
        let of = |joint: usize| {
            let limit = FeedLimit { feed: 0.02, kind: FeedLimitKind::Speed, joint, segment: 1, point: 7 };
            let (programmed_segments, external_axes) = (vec![0.05], vec!["rail".to_owned()]);
            let feed = CutFeed { programmed: 0.05, programmed_segments, segments: vec![Some(limit)], external_axes };
            value(&FeedFigures::from(&feed))["decided_by"].clone()
        };
        assert_eq!(of(3), json!({ "kind": "speed", "joint": 3, "segment": 1, "point": 7 }));
        assert_eq!(of(7), json!({ "kind": "speed", "joint": null, "external_axis": "rail", "segment": 1, "point": 7 }));
    }

    #[test]
    fn a_document_states_where_it_comes_from_before_its_result() {
        let input = InputFile { role: "config", name: "run.toml".to_owned(), sha256: "0".repeat(64) };
        let document = Document::new(&[input]).notes(["a"]).warnings(["b", "c"]).with(json!({ "mean_mm": 0.5 }));
        assert_eq!((&document["format"], &document["mean_mm"]), (&json!(1), &json!(0.5)));
        assert_eq!((&document["notes"], &document["warnings"]), (&json!(["a"]), &json!(["b", "c"])));
        assert_eq!(document["inputs"][0]["name"], "run.toml");
        assert!(bytes(&document).ends_with(b"}\n"));
    }
}
