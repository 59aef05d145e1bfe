//! Deviations from a circle as data, drawn (after Klimchik et al. 2017, Fig. 24).

use super::axes::{Scale, Ticks};
use super::canvas::{Canvas, Place, TextStyle, nearest, picture};
use super::colour::{BLUE, Colour, GREY, GRID, INK, ORANGE, PALE, TEAL, WHITE};
use super::labels::whole_or_figures;
use crate::cards::{Polar, PolarChoice};
use crate::units::fixed;
use std::f64::consts::{PI, TAU};

/// Middle of the plot.
const MIDDLE: Place = (390.0, 425.0);
/// Radius of the reference circle, distance of the zone circles from it, and radius of the plot. Pixels
const REFERENCE: f64 = 200.0;
const ZONE: f64 = 70.0;
const RIM: f64 = 320.0;
/// Most points that are drawn as dots; more make a line alone.
const DOTS: usize = 400;
/// Directions that are drawn apart: with more points, the extremes of each direction stand for all of it.
const DIRECTIONS: usize = 1440;
/// Least half width of a zone that is magnified to the whole ring, in radii.
const MIN_HALF_WIDTH: f64 = 1e-7;
/// Two points are joined by an arc of steps of this angle, since a chord would dip inwards. rad
const ARC: f64 = PI / 180.0;
/// Points farther apart than this are not joined: so many times their mean distance, but no less than 2 deg.
const GAP: f64 = 3.0;
/// Dots of the profile.
const PROFILE: Colour = Colour(52, 84, 140);

/// The profile about the centre of a reference circle: the deviation from it, magnified so that the band of the
/// deviations that count fills a fixed part of the picture, and the circularity about each of the circles. Points left
/// out are shown apart, those beyond the rim on it.
pub fn polar(card: &Polar, shown: &PolarChoice) -> String {
    picture((1040, 800), |canvas| {
        let plot = Plot::new(card, shown);
        canvas.title(&card.title, (30, 28));
        let magnified = whole_or_figures((plot.scale * shown.radius / REFERENCE * 1e3).round() / 1e3);
        let detail = format!("{}, magnified {magnified} times", card.detail);
        canvas.text(&detail, (30, 52), TextStyle::new(13.0).coloured(INK));
        plot.grid(canvas);
        for (deviation, colour, width) in [(0.0, INK, 1), (shown.band[1], TEAL, 2), (shown.band[0], TEAL, 2)] {
            plot.ring(canvas, deviation, colour, width);
        }
        plot.profile(canvas);
        plot.excluded.iter().for_each(|point| canvas.dot(plot.place(*point), 3, ORANGE));
        plot.ring_labels(canvas);
        plot.legend(canvas)
    })
}

/// A point as drawn: angle about the centre (rad) and deviation from the reference circle.
type Point = (f64, f64);

struct Plot<'a> {
    card: &'a Polar,
    shown: &'a PolarChoice,
    kept: Vec<Point>,
    excluded: Vec<Point>,
    /// Pixels to a unit of length of the deviation.
    scale: f64,
}

impl<'a> Plot<'a> {
    fn new(card: &'a Polar, shown: &'a PolarChoice) -> Self {
        let all = || card.angles.iter().map(|angle| angle.to_radians()).zip(shown.deviations.iter().copied());
        let of = |is_excluded: bool| {
            let points = all().zip(&card.excluded).filter(|(_, excluded)| **excluded == is_excluded);
            let mut points: Vec<Point> = points.map(|(point, _)| point).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            thinned(points)
        };
        // A perfect circle is shown as one, and not as what rounding makes of it.
        let half = (0.5 * (shown.band[1] - shown.band[0])).max(MIN_HALF_WIDTH * shown.radius);
        Self { card, shown, kept: of(false), excluded: of(true), scale: ZONE / half }
    }

    fn place(&self, point: Point) -> Place {
        let radius = (REFERENCE + self.scale * point.1).clamp(0.0, RIM);
        let (sine, cosine) = libm::sincos(point.0);
        (MIDDLE.0 + radius * cosine, MIDDLE.1 - radius * sine)
    }

    fn ring(&self, canvas: &mut Canvas, deviation: f64, colour: Colour, width: i32) {
        let points: Vec<Place> = (0..=360).map(|k| self.place((TAU * f64::from(k) / 360.0, deviation))).collect();
        canvas.curve(&points, colour, width)
    }

    /// Deviations at which there are rings.
    fn ticks(&self) -> Ticks {
        let reach = (RIM - REFERENCE) / self.scale;
        Ticks::round(&Scale::new(-reach, reach, 0, 1), 8)
    }

    fn grid(&self, canvas: &mut Canvas) {
        for deviation in self.ticks().values {
            self.ring(canvas, deviation, GRID, 1);
        }
        let rim = (RIM - REFERENCE) / self.scale;
        self.ring(canvas, rim, PALE, 1);
        for k in 0..12 {
            let angle = TAU * f64::from(k) / 12.0;
            canvas.curve(&[MIDDLE, self.place((angle, rim))], GRID, 1);
            let (sine, cosine) = libm::sincos(angle);
            let label = (MIDDLE.0 + (RIM + 20.0) * cosine, MIDDLE.1 - (RIM + 16.0) * sine);
            let style = TextStyle::new(12.0).coloured(INK).centred();
            canvas.text(&format!("{}\u{b0}", 30 * k), nearest(label), style);
        }
    }

    fn profile(&self, canvas: &mut Canvas) {
        let closing = self.kept.first().map(|(angle, deviation)| (angle + TAU, *deviation));
        let points: Vec<Point> = self.kept.iter().copied().chain(closing).collect();
        let gap = (GAP * TAU / self.kept.len().max(1) as f64).max(PI / 90.0);
        for run in points.chunk_by(|a, b| b.0 - a.0 < gap).filter(|run| run.len() > 1) {
            let arcs = run.windows(2).flat_map(|pair| self.arc(pair[0], pair[1]));
            canvas.curve(&arcs.chain([self.place(run[run.len() - 1])]).collect::<Vec<_>>(), BLUE, 2);
        }
        if self.kept.len() <= DOTS {
            self.kept.iter().for_each(|point| canvas.dot(self.place(*point), 2, PROFILE));
        }
    }

    /// Places from one point towards the next, without the next.
    fn arc(&self, from: Point, to: Point) -> impl Iterator<Item = Place> + '_ {
        let steps = ((to.0 - from.0) / ARC).ceil().clamp(1.0, 360.0) as u32;
        (0..steps).map(move |k| {
            let part = f64::from(k) / f64::from(steps);
            self.place((from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1)))
        })
    }

    /// What the rings stand for, upwards from the middle, on white so that the profile does not hide them.
    fn ring_labels(&self, canvas: &mut Canvas) {
        let ticks = self.ticks();
        let style = TextStyle::new(11.0).coloured(INK).centred();
        for deviation in &ticks.values {
            let sign = if *deviation > 0.0 { "+" } else { "" };
            let label = format!("{sign}{}", ticks.label(*deviation));
            let (x, y) = nearest(self.place((75.0_f64.to_radians(), *deviation)));
            let half = style.width(&label) / 2;
            canvas.fill((x - half, y - 7), (x + half, y + 7), WHITE);
            canvas.text(&label, (x, y), style);
        }
    }

    fn legend(&self, canvas: &mut Canvas) {
        let (left, mut y) = (750, 110);
        let heading = TextStyle::new(13.0).bold();
        let style = TextStyle::new(12.0).coloured(INK);
        let circularity = |choice: &PolarChoice| (choice.name.clone(), fixed(choice.band[1] - choice.band[0], 6));
        let Polar { choices, unit, .. } = self.card;
        let lists = [
            (format!("Circularity ({unit})"), choices.iter().map(circularity).collect()),
            (format!("Shown: {}, {unit}", self.shown.name), self.shown.figures.clone()),
        ];
        for (title, lines) in lists {
            canvas.text(&title, (left, y), heading);
            for (name, value) in lines {
                y += 22;
                canvas.text(&name, (left, y), style);
                canvas.text(&value, (left + 265, y), style.ending());
            }
            y += 40;
        }
        let excluded = self.card.excluded.iter().filter(|is_excluded| **is_excluded).count();
        let measured = format!("measured, {} points", self.card.excluded.len() - excluded);
        for (label, colour, width) in
            [("reference circle", INK, 1), ("zone circles", TEAL, 2), (measured.as_str(), BLUE, 2)]
        {
            canvas.line(&[(left, y), (left + 30, y)], colour, width);
            canvas.text(label, (left + 40, y), style);
            y += 22;
        }
        if excluded > 0 {
            canvas.dot((f64::from(left) + 15.0, f64::from(y)), 3, ORANGE);
            canvas.text(&format!("left out, {excluded} points"), (left + 40, y), style);
            y += 22;
        }
        canvas.text(&format!("Numbers at the rings: deviation in {unit}."), (left, y + 10), style.coloured(GREY));
        if self.excluded.iter().any(|(_, deviation)| self.scale * deviation > RIM - REFERENCE) {
            canvas.text("Points beyond the rim are drawn on it.", (left, y + 30), style.coloured(GREY));
        }
    }
}

/// The points, sorted by angle; of very many the extremes of each direction.
fn thinned(points: Vec<Point>) -> Vec<Point> {
    if points.len() <= 2 * DIRECTIONS {
        return points;
    }
    let direction = |point: &Point| (point.0 / TAU * DIRECTIONS as f64) as usize;
    let mut kept = Vec::with_capacity(2 * DIRECTIONS);
    for run in points.chunk_by(|a, b| direction(a) == direction(b)) {
        let low = run.iter().fold(run[0], |a, b| if b.1 < a.1 { *b } else { a });
        let high = run.iter().fold(run[0], |a, b| if b.1 > a.1 { *b } else { a });
        kept.extend(if low.0 <= high.0 { [low, high] } else { [high, low] });
    }
    kept
}
