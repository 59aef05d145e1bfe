//! The Pareto front: its first column against each of the others.

use super::super::axes::{Panel, Scale};
use super::super::canvas::{Canvas, TextStyle, nearest, picture};
use super::super::colour::{BLACK, BLUE, Colour, INK, PALE, TEAL, WHITE};
use super::super::labels::{Label, Labeller};
use super::super::line_chart::{LineChart, Mark};
use super::roomy;
use stead_problem::sense::Sense;
use stead_study::analysis::{Front, FrontMember, Layouts, Measure};

/// Left edges, width, first upper edge, height, and distance of rows. Pixels
const LEFT: [i32; 2] = [100, 640];
const WIDTH: i32 = 420;
const ALONE: i32 = 880;
const TOP: i32 = 92;
const HEIGHT: i32 = 380;
const ROW: i32 = 470;

/// The layouts over the first column and each of the others: those on the front green with the numbers of their cases,
/// those that are behind it by less than the noise blue. Two columns are joined by the line beyond which nothing is.
pub fn front(front: &Front, layouts: &Layouts) -> String {
    let others = front.measures.len() - 1;
    let rows = others.div_ceil(2) as i32;
    picture((1100, TOP + ROW * rows), |canvas| {
        let names: Vec<&str> = front.measures.iter().map(|measure| measure.name.as_str()).collect();
        canvas.title(&format!("Front of {}", names.join(", ")), (LEFT[0], 26));
        let ties = front.members.iter().filter(|member| member.is_tie).count();
        let entries = [
            (TEAL, format!("on the front: {}", front.members.len() - ties), 0),
            (BLUE, format!("behind it within the noise of the search: {ties}"), 220),
            (PALE, format!("other layouts: {}", front.compared.len() - front.members.len()), 620),
        ];
        for (colour, label, along) in entries {
            canvas.dot((f64::from(LEFT[0] + along + 5), 54.0), 5, colour);
            canvas.text(&label, (LEFT[0] + along + 17, 54), TextStyle::new(12.0).coloured(INK));
        }
        for other in 0..others {
            let left = LEFT[other % 2];
            let top = TOP + ROW * (other / 2) as i32;
            let right = left + if others == 1 { ALONE } else { WIDTH };
            one(canvas, front, layouts, other + 1, [left, right, top]);
        }
    })
}

/// The first column against another, between a left and a right edge and below an upper one.
fn one(canvas: &mut Canvas, front: &Front, layouts: &Layouts, other: usize, [left, right, top]: [i32; 3]) {
    let scale =
        |column: usize, start, end| roomy(front.compared.iter().map(move |(_, values)| values[column]), start, end);
    let (x, y): (Scale, Scale) = (scale(0, left, right), scale(other, top + HEIGHT, top));
    let at = |values: &[f64]| [values[0], values[other]];
    let labels = [label(&front.measures[0]), label(&front.measures[other])];
    let ticks = if right - left > WIDTH { 11 } else { 6 };
    let mut chart = LineChart::new(Panel::new(x, y, [ticks, 8], labels));
    if front.measures.len() == 2 {
        chart.curve(stairs(&front.members), TEAL);
    }
    for (_, values) in &front.compared {
        chart.marks.push(Mark::Dot(at(values), 3, PALE));
    }
    for (is_tie, radius, colour) in [(true, 4, BLUE), (false, 5, TEAL)] {
        let of = front.members.iter().filter(|member| member.is_tie == is_tie);
        chart.marks.extend(of.map(|member| Mark::Dot(at(&member.values), radius, colour)));
    }
    chart.draw(canvas);
    let mut labeller = Labeller::new(((left, top), (right, top + HEIGHT)));
    let pixel = |values: &[f64]| nearest(chart.panel.place(values[0], values[other]));
    let all = || front.members.iter().map(|member| (member, pixel(&member.values)));
    for (_, (x, y)) in all() {
        labeller.take(((x - 5, y - 5), (x + 5, y + 5)));
    }
    for (member, (x, y)) in all().filter(|(member, _)| !member.is_tie) {
        let text = layouts.all[member.layout].cases.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        let ((half, _), colour): (_, Colour) = (Labeller::half(&text), BLACK);
        let centres =
            [(x + half + 8, y - 8), (x + half + 8, y + 9), (x - half - 8, y - 8), (x - half - 8, y + 9), (x, y - 15)];
        labeller.put(canvas, &Label { text: &text, colour, ground: WHITE }, centres.into_iter());
    }
}

/// The edge of what can be had: from each layout on at its height to where the next one takes over.
fn stairs(members: &[FrontMember]) -> Vec<[f64; 2]> {
    let mut edge: Vec<[f64; 2]> = Vec::new();
    for member in members.iter().filter(|member| !member.is_tie) {
        let [x, y] = [member.values[0], member.values[1]];
        edge.extend(edge.last().map(|before| [x, before[1]]));
        edge.push([x, y]);
    }
    edge
}

/// A column and which of its values are better.
fn label(measure: &Measure) -> String {
    let better = if measure.sense == Sense::Min { "smaller" } else { "larger" };
    format!("{} ({better} is better)", measure.name)
}
