//! What the user should see to in forces from a path.

use crate::cut::CutFigures;
use crate::error::place;
use crate::operation::{ForcesProblem, PathStock, Stock};
use crate::outcome::RemovalForces;
use crate::sums::{Event, Events, GOUGE};
use stead_numerics::digits::figures;
use stead_numerics::message::{Note, Warning};

/// Chips below this are rubbed rather than cut. m
const THIN: f64 = 2e-6;
/// A path that cuts nothing on more of its scored length may be for another stock.
const MOSTLY_AIR: f64 = 0.3;
/// Volumes below so many cells are none.
const CELLS: f64 = 8.0;

/// Adds warnings, notes and the share of the path in air.
pub fn warnings(all: &mut RemovalForces, problem: &ForcesProblem, events: &Events) {
    of_events(all, problem, events);
    let scored: Vec<usize> = (0..all.points.len()).filter(|point| all.path.is_scored(*point)).collect();
    of_air(all, &scored);
    of_thin_chips(all, &scored);
    let path = &all.path;
    let cutting = path.scored_where(|point| !is_air(all, point));
    all.cut = CutFigures::of(path, &all.points, &problem.operation, all.air);
    let of_cut = all.cut.map(|cut| cut.warnings(path, &all.points));
    all.warnings.extend(of_cut.into_iter().flatten());
    all.path = cutting;
    notes(all, problem);
}

/// What the cutter, its shank and the finished part meet where they should not.
fn of_events(all: &mut RemovalForces, problem: &ForcesProblem, events: &Events) {
    let (original, mill) = (&problem.operation.path, &problem.operation.mill);
    let least = CELLS * all.cell.powi(3);
    // Points are told by their numbers in the results, which count those that were added.
    let numbers: Vec<usize> = (0..all.points.len()).filter(|point| !all.points[*point].is_added).collect();
    let mut warn = |event: Event, kind: &'static str, text: &dyn Fn() -> String| {
        let met: Vec<(u32, f64)> = events
            .iter()
            .filter(|((known, _), volume)| *known == event && **volume > least)
            .map(|((_, point), volume)| (*point, *volume))
            .collect();
        let Some((first, _)) = met.first() else { return };
        let volume: f64 = met.iter().map(|(_, volume)| volume).sum();
        let number = numbers.get(*first as usize).copied().unwrap_or_default();
        let at = place(&original.points()[*first as usize].position);
        let count = met.len();
        let points = if count == 1 {
            format!("at point {number}")
        } else {
            format!("at {count} points, first at point {number}")
        };
        let message = format!("{} {points}, {at}: {:.1} mm3", text(), volume * 1e9);
        all.warnings.push(Warning::new(kind, message));
    };
    warn(Event::Rapid, "rapid-in-stock", &|| "rapid moves go through the stock".to_owned());
    // Stock from the path is where the cutter is put down.
    if let Stock::Solid { .. } = &problem.stock {
        warn(Event::Before, "starts-in-stock", &|| {
            "the cutter stands in the stock where a segment begins, which gives no force:".to_owned()
        });
    }
    warn(Event::InPlace, "turns-in-stock", &|| {
        "the tool turns in place in the stock, without a feed and so without a force".to_owned()
    });
    warn(Event::AboveFlutes, "above-flutes", &|| {
        let flutes = mill.flute_length * 1e3;
        format!("material is cut above the flutes ({flutes} mm), reckoned as if they went on,")
    });
    warn(Event::DeadCentre, "dead-centre", &|| {
        let radius = (mill.dead_centre() * 1e6).round() / 1e3;
        format!("the cutter is not centre-cutting, and its bottom cuts within {radius} mm of its axis")
    });
    warn(Event::Holder, "holder-in-stock", &|| "shank or holder are in the stock".to_owned());
    warn(Event::Gouge, "gouge", &|| format!("the finished part is cut into by more than about {} mm", GOUGE * 1e3));
}

fn is_air(all: &RemovalForces, point: usize) -> bool {
    all.points[point].heights.is_none()
}

/// Scored points that cut nothing, and their share of the scored length.
fn of_air(all: &mut RemovalForces, scored: &[usize]) {
    let path = &all.path;
    let starts: Vec<usize> = path.segments().iter().map(|range| range.start).collect();
    let step = |point: usize| if starts.binary_search(&point).is_ok() { 0.0 } else { path.step_length(point) };
    let weight: f64 = scored.iter().map(|point| step(*point)).sum();
    let in_air: Vec<usize> = scored.iter().copied().filter(|point| is_air(all, *point)).collect();
    if weight > 0.0 {
        all.air = in_air.iter().map(|point| step(*point)).sum::<f64>() / weight;
    }
    if let Some(first) = in_air.first() {
        let at = place(&path.points()[*first].position);
        let text = format!(
            "{} of {} scored points cut nothing, {:.1} % of the scored length: they are followed, and count for nothing; first at point \
             {}, {at}",
            in_air.len(),
            scored.len(),
            all.air * 100.0,
            first
        );
        match all.air > MOSTLY_AIR {
            true => all.warnings.push(Warning::new("in-air", text)),
            false => all.notes.push(text.into()),
        }
    }
}

/// Scored points whose chips are rubbed.
fn of_thin_chips(all: &mut RemovalForces, scored: &[usize]) {
    let thin = |point: &usize| !is_air(all, *point) && all.points[*point].chip_thickness < THIN;
    let thin: Vec<usize> = scored.iter().copied().filter(thin).collect();
    if let Some(first) = thin.first() {
        let at = place(&all.path.points()[*first].position);
        let text = format!(
            "chips are thinner than {} um at {} scored points, first at point {}, {at}: the teeth may rub",
            THIN * 1e6,
            thin.len(),
            first
        );
        all.warnings.push(Warning::new("thin-chip", text));
    }
}

/// What was assumed and done.
fn notes(all: &mut RemovalForces, problem: &ForcesProblem) {
    let [force, moment] = [0, 1].map(|k| (all.difference.rms[k] * 100.0, all.difference.largest[k] * 100.0));
    let cell = all.cell * 1e3;
    let mut computed = vec![format!(
        "forces are those of the programmed feed, from what the path removes of the stock by lines {cell:.3} mm apart; with lines \
         {:.3} mm apart the force differs by {:.2} % rms and {:.1} % at most, the moment by {:.2} % and {:.1} %, of the largest",
        2.0 * cell,
        force.0,
        force.1,
        moment.0,
        moment.1
    )];
    if let Stock::Path(PathStock { depth, layer }) = &problem.stock {
        let mm = |metres: f64| figures(metres * 1e3);
        let depth = depth.map(|depth| format!("up to {} mm above its tip", mm(depth)));
        let layer = layer.map(|layer| format!("a layer of {} mm that the operation before has left", mm(layer)));
        let what = [depth, layer].into_iter().flatten().collect::<Vec<_>>().join(", and of it ");
        computed.push(format!(
            "the stock is what the cutter passes over on its scored moves, {what}: what else stands there is not known"
        ));
    }
    let added = all.points.iter().filter(|point| point.is_added).count();
    if added > 0 {
        computed.push(format!(
            "{added} points added, where a straight line between two misses the force by more than 10 %"
        ));
    }
    all.notes.extend(computed.into_iter().map(Note::from));
    if problem.operation.rapids.iter().all(Vec::is_empty) {
        let text = "the path has no rapid moves: that they keep out of the stock is not checked";
        all.notes.push(Note::not_checked("rapids", text));
    }
    if problem.operation.mill.holder.is_empty() {
        let text = "no holder is stated: that it keeps out of the stock is not checked";
        all.notes.push(Note::not_checked("holder", text));
    }
}
