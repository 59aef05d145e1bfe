//! Kinds of load: loads that coarse tables treat as one, up to their size.

use super::load::Load;
use super::load::norm;
use super::region::Point;

/// A load of size 1 that stands for others of size 1, which differ from it by as much at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kind {
    pub load: Load,
    /// How far the forces are from its own, at most.
    pub force_spread: f64,
    /// How far the moments are from its own, at most. m
    pub moment_spread: f64,
    /// How far the compliances of the part are from its own, at most. m/N
    pub part_spread: f64,
}

/// Kinds of load that have a table: those of most weight.
const MAX_KINDS: usize = 12;
/// Spreads tried one after the other until few enough kinds cover all points: rounding, then ever coarser. A moment
/// counts as the force that makes it at a metre.
const SPREADS: [f64; 5] = [1e-13, 0.01, 0.03, 0.1, 0.3];

/// A load of size 1, and how many times as large another one is; `None` of one without a force.
fn unit(load: &Load) -> Option<(Load, f64)> {
    let size = norm(load.force);
    let [force, moment] = [load.force, load.moment].map(|v| v.map(|x| x / size));
    (size > 0.0).then_some((Load { force, moment, error: load.error / size, turn: 0.0, ..*load }, size))
}

/// How far a load of size 1 is from another one in force, in moment (m) and in the compliance of the part (m/N), where
/// the same directions are scored, and the part yields under both or neither.
fn apart(a: &Load, b: &Load) -> Option<[f64; 3]> {
    let long = a.directions.iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-13 * long);
    let alike = a.directions.iter().zip(&b.directions).all(|(a, b)| near(a, b)) && (a.error - b.error).abs() <= 1e-13;
    let off = |a: &[f64; 3], b: &[f64; 3]| norm(std::array::from_fn(|k| a[k] - b[k]));
    let part = match (a.part, b.part) {
        (None, None) => 0.0,
        (Some(a), Some(b)) => a.apart(&b),
        _ => return None,
    };
    alike.then(|| [off(&a.force, &b.force), off(&a.moment, &b.moment), part])
}

/// The kinds of load of path points, those of most weight first; and for each point the number of its kind and how many
/// times as large its own is, `None` where it is left out.
pub(super) fn kinds(points: &[Point]) -> (Vec<Kind>, Vec<Option<(usize, f64)>>) {
    kinds_of(points.iter().map(|point| &point.load))
}

/// The same of loads.
pub(super) fn kinds_of<'a>(loads: impl Iterator<Item = &'a Load>) -> (Vec<Kind>, Vec<Option<(usize, f64)>>) {
    let loads: Vec<Option<(Load, f64)>> = loads.map(unit).collect();
    let mut found = Vec::new();
    for spread in SPREADS {
        found = kinds_within(&loads, spread);
        if found.len() <= MAX_KINDS {
            break;
        }
    }
    found.truncate(MAX_KINDS);
    let of = |(load, size): &(Load, f64)| {
        let of_kind = |kind: &Kind| {
            let [force, moment, part] = apart(&kind.load, load)?;
            let is_within = force <= kind.force_spread && moment <= kind.moment_spread && part <= kind.part_spread;
            is_within.then_some(())
        };
        Some((found.iter().position(|kind| of_kind(kind).is_some())?, *size))
    };
    let numbers = loads.iter().map(|load| load.as_ref().and_then(of)).collect();
    (found, numbers)
}

/// Each load joins the first kind that is near enough, or begins one; never many more than have tables.
fn kinds_within(loads: &[Option<(Load, f64)>], spread: f64) -> Vec<Kind> {
    let mut all: Vec<(Kind, f64)> = Vec::new();
    for (load, size) in loads.iter().flatten() {
        let is_full = all.len() >= 100;
        let near = all.iter_mut().find_map(|(kind, weight)| {
            let size = kind.load.part.map_or(1.0, |part| part.size().max(f64::MIN_POSITIVE));
            let off = apart(&kind.load, load).filter(|[force, moment, part]| force + moment + part / size <= spread)?;
            Some((kind, weight, off))
        });
        match near {
            Some((kind, weight, [force, moment, part])) => {
                *weight += size;
                kind.force_spread = kind.force_spread.max(force);
                kind.moment_spread = kind.moment_spread.max(moment);
                kind.part_spread = kind.part_spread.max(part);
            }
            None if !is_full => {
                let kind = Kind { load: *load, force_spread: 0.0, moment_spread: 0.0, part_spread: 0.0 };
                all.push((kind, *size));
            }
            None => {}
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.into_iter().map(|(kind, _)| kind).collect()
}
