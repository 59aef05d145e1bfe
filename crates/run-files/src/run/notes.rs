//! What the user should know about a run though it is not wrong, in sentences.

use stead_format::field::FieldOverride;
use stead_model::robot::Robot;
use stead_model::task::{Task, ToolPath};

/// A feed that misses the plane normal to the tool axis by no more than this is normal to it. deg
const NORMAL_FEED_DEG: f64 = 0.1;

/// A value that is not that of the files.
pub(super) fn override_note(field: &FieldOverride) -> String {
    format!("{} is {} in place of what the files say", field.path(), field.value())
}

/// The largest tilt of the feed, where there is one.
pub(super) fn tilt_note(path: &ToolPath, lines: &[usize]) -> Option<String> {
    let tilts = path.points().iter().zip(lines).map(|(point, line)| (point.feed_tilt().abs().to_degrees(), line));
    let steepest = tilts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(tilt, _)| *tilt > NORMAL_FEED_DEG);
    steepest.map(|(tilt, line)| {
        format!(
            "feed is up to {tilt:.2} deg off the normal of the tool axis (task line {line}): \
             the wall normal is axis x feed"
        )
    })
}

/// A feed that points away from the next point by more than this is suspicious. deg
const FEED_TO_PATH_DEG: f64 = 60.0;

/// The first point whose feed does not point along the path.
pub(super) fn direction_note(task: &Task) -> Option<String> {
    let points = task.points();
    let off = |point: &usize| {
        let (feed, chord) = (points[point - 1].feed, points[*point].position - points[point - 1].position);
        libm::acos((feed.dot(&chord) / chord.norm()).clamp(-1.0, 1.0)).to_degrees()
    };
    // The feed of a point that is not scored says nothing, and neither does the way to one.
    let are_scored = |point: &usize| task.path().is_scored(*point) && task.path().is_scored(point - 1);
    let mut inner = task.segments().iter().flat_map(|span| span.clone().skip(1)).filter(are_scored);
    let first = inner.find(|point| off(point) > FEED_TO_PATH_DEG)?;
    let (from, angle) = (first - 1, off(&first));
    Some(format!("at point {from} the feed is {angle:.0} deg off the way to the next point: check the signs of feed_*"))
}

/// The joints whose speed is not known, where there are some.
pub(super) fn speed_note(robot: &Robot) -> Option<String> {
    let unknown = robot.joints().iter().zip(1..).filter(|(joint, _)| joint.max_speed.is_none());
    let numbers: Vec<String> = unknown.map(|(_, number): (_, usize)| number.to_string()).collect();
    (!numbers.is_empty()).then(|| {
        format!(
            "the robot file gives no max_speed_deg_per_s for joints {}: their steps along the path are not bounded, \
             and the times of moves between segments are not known",
            numbers.join(", ")
        )
    })
}
