//! A tool that leans from the axis of the task, by turns of its frame and by what its end touches.

use crate::path::Point;
use crate::values::{number, range, section, sections, text};
use crate::verdict::Verdict;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use toml::Table;

/// What the run says of it.
struct Rules {
    radius: f64,
    corner: f64,
    rule: String,
    /// What forces do, where the run says so.
    force: Option<String>,
}

fn rules(run: &Table, has_normals: bool) -> Option<Rules> {
    let (lean, tool) = (section(run, "lean")?, section(run, "tool")?);
    let radius = number(tool, "cutter_diameter_mm")? * 0.5e-3;
    let corner = number(tool, "corner_radius_mm").unwrap_or(0.0) * 1e-3;
    let usual = if corner >= radius {
        "centre"
    } else if has_normals {
        "contact"
    } else {
        "plane"
    };
    let rule = text(lean, "rule").unwrap_or(usual).to_owned();
    Some(Rules { radius, corner, rule, force: text(lean, "force").map(str::to_owned) })
}

/// Where a torus of the cutting end, its centre circle of radius R - r, has its point farthest along -n: from the tip.
fn lowest(rules: &Rules, axis: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    let aside = normal - axis * normal.dot(axis);
    let spoke = if aside.norm() > 1e-9 { aside.normalize() } else { Vector3::zeros() };
    axis * rules.corner - spoke * (rules.radius - rules.corner) - normal * rules.corner
}

/// The points with a tool that leans by lead and tilt (rad) at each; the axes that are scored stay. None for a run that
/// does not say how, or whose forces are computed from a stock for every lean: the judge removes no material.
pub(crate) fn leaned(points: &[Point], run: &Table, leans: &[[f64; 2]]) -> Option<Vec<Point>> {
    let rules = rules(run, points.iter().any(|point| point.normal.is_some()))?;
    if run.contains_key("stock") && rules.force.is_none() {
        return None;
    }
    let lean = |(point, [lead, tilt]): (&Point, &[f64; 2])| {
        let mut leaned = point.clone();
        if *lead == 0.0 && *tilt == 0.0 {
            return leaned;
        }
        let about = |axis: Vector3<f64>, angle: f64| Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
        let (feed, left, up) =
            (point.axes.column(0).into_owned(), point.axes.column(1).into_owned(), point.axes.column(2).into_owned());
        let first = about(left, *lead);
        let turn = about(first * feed, -tilt) * first;
        let axis = turn * up;
        let ahead = (feed - axis * feed.dot(&axis)).normalize();
        leaned.axes = Matrix3::from_columns(&[ahead, axis.cross(&ahead), axis]);
        let normal = point.normal.unwrap_or(up);
        let [before, after] = [up, axis].map(|axis| lowest(&rules, &axis, &normal));
        leaned.place = point.place
            + match rules.rule.as_str() {
                // The centre of the ball is a radius above its tip.
                "centre" => (up - axis) * rules.radius,
                // What is lowest stays as high.
                "plane" => normal * (before - after).dot(&normal),
                _ => before - after,
            };
        let turns_forces = rules.force.as_deref().map_or(point.is_of_tool, |force| force == "tool");
        if turns_forces {
            let carried = leaned.axes * point.axes.transpose();
            (leaned.force, leaned.moment) = (carried * point.force, carried * point.moment);
        } else {
            leaned.moment = point.moment + (point.place - leaned.place).cross(&point.force);
        }
        leaned
    };
    Some(points.iter().zip(leans).map(lean).collect())
}

/// Whether the tool leans no farther than it may, and turns from point to point no more than its contact allows.
pub(crate) fn judge(verdict: &mut Verdict, name: &str, run: &Table, points: &[Point], leans: &[[f64; 2]]) {
    let Some(table) = section(run, "lean") else {
        verdict.holds("a tool that may not lean", || name.to_owned(), leans.is_empty());
        return;
    };
    let ends = |table: &Table, key: &str| range(table, key, 1_f64.to_radians());
    for (i, (point, lean)) in points.iter().zip(leans).enumerate() {
        let own = sections(table, "segment").into_iter().find(|t| number(t, "number") == Some(point.segment as f64));
        for (k, key) in ["lead_deg", "tilt_deg"].into_iter().enumerate() {
            let stated = own.and_then(|own| ends(own, key)).or_else(|| ends(table, key));
            let [low, high] = point.leans[k].or(stated).filter(|_| point.is_scored).unwrap_or([0.0; 2]);
            let beyond = (low - lean[k]).max(lean[k] - high);
            verdict.within("range of the lean (rad)", || format!("{name} point {i} {key}"), beyond, 1e-6);
        }
        let angle = (lean[0].cos() * lean[1].cos()).min(1.0).acos();
        if let Some(most) = number(table, "max_lean_deg").filter(|_| point.is_scored) {
            verdict.within("largest lean (rad)", || format!("{name} point {i}"), angle, most.to_radians() + 2e-6);
        }
    }
}
