//! What all JSON documents have in common: what they state first, their bytes, and views that several of them hold.

use crate::units::Unit;
use serde_json::{Value, json};
use stead_format::input::InputFile;
use stead_numerics::mean_max::MeanAndMax;
use stead_placement::feed::{CutFeed, FeedLimit};
use stead_placement::joint_travel::{JointTravel, Swing};
use stead_placement::outcome::DeflectionFigures;
use stead_placement::problem::Placement;

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

/// A JSON document of stead: whatever it reports, it states `format`, `version`, `inputs`, `notes` and `warnings`.
#[derive(Debug, Clone, PartialEq)]
pub struct Document(Value);

impl Document {
    /// A document on what was computed from these files, without notes and warnings yet.
    pub fn new(inputs: &[InputFile]) -> Self {
        let input = |file: &InputFile| json!({ "role": file.role, "name": file.name, "sha256": file.sha256 });
        Self(json!({
            "format": FORMAT,
            "version": env!("CARGO_PKG_VERSION"),
            "inputs": inputs.iter().map(input).collect::<Value>(),
            "notes": [],
            "warnings": [],
        }))
    }

    /// States what the result rests on: assumptions made and values left at their defaults.
    pub fn notes(self, notes: impl IntoIterator<Item = impl ToString>) -> Self {
        self.messages("notes", notes)
    }

    /// States why the result may not be what was wanted.
    pub fn warnings(self, warnings: impl IntoIterator<Item = impl ToString>) -> Self {
        self.messages("warnings", warnings)
    }

    fn messages(mut self, key: &str, messages: impl IntoIterator<Item = impl ToString>) -> Self {
        if let Some(Value::Array(list)) = self.0.get_mut(key) {
            list.extend(messages.into_iter().map(|message| json!(message.to_string())));
        }
        self
    }

    /// The document with the entries of a result, which is a JSON object.
    pub fn with(self, result: Value) -> Value {
        joined(self.0, result)
    }
}

/// The entries of two JSON objects as one.
pub(super) fn joined(mut object: Value, more: Value) -> Value {
    if let (Value::Object(entries), Value::Object(more)) = (&mut object, more) {
        entries.extend(more);
    }
    object
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

/// Adds a standard deviation to an object where the robot's uncertainty is known.
pub(super) fn put_deviation(object: &mut Value, key: &str, unit: Unit, deviation: Option<f64>) {
    if let (Some(deviation), Value::Object(map)) = (deviation, object) {
        map.insert(key.to_owned(), json!(unit.number(deviation)));
    }
}

/// A placement as every JSON document states it.
pub fn placement(placement: &Placement) -> Value {
    json!({
        "x_mm": Unit::PLACE_MM.number(placement.x),
        "y_mm": Unit::PLACE_MM.number(placement.y),
        "z_mm": Unit::PLACE_MM.number(placement.z),
        "q4": Unit::PLAIN.number(placement.q4()),
        "yaw_deg": Unit::ANGLE_DEG.number(placement.yaw),
    })
}

/// The same with every digit, so that whoever reads it again has the same placement.
pub fn placement_exact(placement: &Placement) -> Value {
    json!({
        "x_mm": placement.x * 1e3,
        "y_mm": placement.y * 1e3,
        "z_mm": placement.z * 1e3,
        "yaw_deg": placement.yaw.to_degrees(),
    })
}

/// Mean and largest value of a deflection.
fn mean_and_max(figures: &MeanAndMax) -> Value {
    json!({ "mean": Unit::DEFLECTION_MM.number(figures.mean), "max": Unit::DEFLECTION_MM.number(figures.max) })
}

/// How large a deflection is in each direction and altogether, in mm; a surface that the task does not state is null.
pub fn deflection_mm(figures: &DeflectionFigures) -> Value {
    json!({
        "wall": mean_and_max(&figures.wall),
        "surface": figures.surface.as_ref().map_or(Value::Null, mean_and_max),
        "feed": mean_and_max(&figures.feed),
        "axis": mean_and_max(&figures.axis),
        "total": mean_and_max(&figures.total),
    })
}

/// The programmed feed, the highest that a plan holds with what decides it, and the highest of each segment; null where no limit of the
/// joints is known.
pub fn cut_feed(feed: &CutFeed) -> Value {
    let speed = |feed: f64| Unit::SPEED_MM_PER_S.number(feed);
    let highest = feed.highest();
    let decided_by = highest.map(|limit| {
        let axis = feed.external_axis(&limit);
        let FeedLimit { kind, joint, segment, point, .. } = limit;
        let mut value = json!({ "kind": kind, "joint": joint, "segment": segment, "point": point });
        if let Some(axis) = axis {
            value["joint"] = Value::Null;
            value["external_axis"] = json!(axis);
        }
        value
    });
    json!({
        "programmed_mm_per_s": speed(feed.programmed),
        "highest_mm_per_s": highest.map(|limit| speed(limit.feed)),
        "decided_by": decided_by,
        "segments_mm_per_s": feed.segments.iter().map(|limit| limit.map(|limit| speed(limit.feed))).collect::<Vec<_>>(),
    })
}

/// How much the joints turn in the cut.
pub fn joint_travel(travel: &JointTravel) -> Value {
    let angle = |angle: f64| Unit::ANGLE_DEG.number(angle);
    let swing = travel.swing.map(|Swing { joint, angle: turned, length, points }| {
        json!({ "joint": joint, "turn_deg": angle(turned), "length_mm": Unit::PLACE_MM.number(length), "points": points })
    });
    json!({
        "total_deg": angle(travel.total),
        "length_mm": Unit::PLACE_MM.number(travel.length),
        "max_step_deg": angle(travel.largest_step),
        "largest_turn": swing,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What decides the feed is a joint by its number or an external axis by its name.
    #[test]
    fn the_external_axis_that_decides_the_feed_is_named() {
        use stead_placement::feed::FeedLimitKind;
        let of = |joint: usize| {
            let limit = FeedLimit { feed: 0.02, kind: FeedLimitKind::Speed, joint, segment: 1, point: 7 };
            let (programmed_segments, external_axes) = (vec![0.05], vec!["rail".to_owned()]);
            let feed = CutFeed { programmed: 0.05, programmed_segments, segments: vec![Some(limit)], external_axes };
            cut_feed(&feed)["decided_by"].clone()
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
