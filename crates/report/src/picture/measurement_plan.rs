//! A plan of measurements: how well every compliance will be known, and where the arm stands for it.

use super::axes::{Panel, Scale, Ticks, around};
use super::canvas::{Canvas, Place, TextStyle, nearest, picture};
use super::colour::{BLUE, Colour, GREY, INK, ORANGE, PALE, TEAL};
use crate::units::{figures, fixed};
use nalgebra::{Vector2, Vector3};
use stead_calibration::identification::design::expected::ExpectedCompliance;
use stead_calibration::identification::design::{Design, Request};
use stead_calibration::identification::{FitModel, LoadCase};
use stead_model::robot::Frames;

const LEFT: i32 = 85;
const RIGHT: i32 = 1075;
/// Upper and lower edge of the bars.
const BARS: (i32, i32) = (130, 400);
/// Upper edge of the views, and their side.
const VIEWS: (i32, i32) = (500, 450);
/// Length of the arrow of a load. Pixels
const ARROW: f64 = 34.0;

/// Above: expected standard deviation of every compliance in per cent of it, from the plan, the best and the median of
/// the random sets; for the joint with several compliances by its law. Below: the arm in all configurations of the plan
/// with the load on it, from above and in the vertical plane through axis 1 and the load point.
pub fn measurement_plan(request: &Request, plan: &Design) -> String {
    picture((1100, 1020), |canvas| {
        let title = format!("Expected errors of {} configurations", plan.load_cases.len());
        canvas.title(&title, (LEFT, 26));
        legend(canvas, plan);
        draw_bars(canvas, request, plan);
        draw_views(canvas, request, plan)
    })
}

/// The three standard deviations of a compliance in per cent of it: plan, best and median of the random sets.
fn percents(bar: &ExpectedCompliance) -> [Option<f64>; 3] {
    [Some(bar.by_law), bar.best_random, bar.median_random].map(|d| d.map(|d| (100.0 * d / bar.value).abs()))
}

const COLOURS: [Colour; 3] = [TEAL, BLUE, PALE];

fn legend(canvas: &mut Canvas, plan: &Design) {
    let expected = &plan.errors;
    let names = ["the plan", "best random set", "median random set"];
    let errors = [expected.planned, expected.best_random, expected.median_random];
    for (index, (name, error)) in names.into_iter().zip(errors).enumerate() {
        let (x, y) = (LEFT + 330 * index as i32, 56);
        canvas.fill((x, y - 7), (x + 26, y + 7), COLOURS[index]);
        let error =
            if error.is_finite() { format!("{} mm", figures(error * 1e3)) } else { "does not tell all".to_owned() };
        canvas.text(&format!("{name}: {error}"), (x + 34, y), TextStyle::new(12.0).bold());
    }
    let text = format!(
        "mm: expected error of the deflection of the tip over {} tests, rms, where the deflection itself is {} mm; random sets: {}",
        plan.tests.len(),
        figures(plan.deflection * 1e3),
        expected.random_sets
    );
    canvas.text(&text, (LEFT, 84), TextStyle::new(12.0).coloured(INK))
}

fn draw_bars(canvas: &mut Canvas, request: &Request, plan: &Design) {
    let max = plan.compliances.iter().flat_map(percents).flatten().fold(0.0, f64::max);
    let y = Scale::new(0.0, if max > 0.0 { 1.12 * max } else { 1.0 }, BARS.1, BARS.0);
    let x = Scale::new(0.0, plan.compliances.len().max(1) as f64, LEFT, RIGHT);
    let panel = Panel::new(x, y, [1, 7], ["compliance", "standard deviation (%)"]);
    let panel = Panel { x_ticks: Ticks::none(), ..panel };
    panel.draw_grid(canvas);
    for (index, bar) in plan.compliances.iter().enumerate() {
        let (from, to) = (panel.x.pixel(index as f64 + 0.12), panel.x.pixel(index as f64 + 0.88));
        let width = (to - from) / 3;
        for (k, percent) in percents(bar).into_iter().enumerate() {
            let (left, Some(percent)) = (from + width * k as i32, percent) else { continue };
            canvas.fill((left + 1, panel.y.pixel(percent)), (left + width - 1, panel.y.start), COLOURS[k]);
            let style = TextStyle::new((f64::from(width) / 2.6).min(10.0)).centred().coloured(INK);
            canvas.text(&two_figures(percent), (left + width / 2, panel.y.pixel(percent) - 8), style);
        }
        let angle = bar.angle.map_or_else(String::new, |angle| format!(" at {}°", fixed(angle.to_degrees(), 0)));
        let name = match request.model {
            FitModel::Axes => format!("k{}{angle}", bar.joint + 1),
            FitModel::Full => format!("{}{}{angle}", bar.joint + 1, bar.about.word()),
        };
        let size = (f64::from(to - from) / (name.chars().count() as f64 * 0.55)).min(12.0);
        canvas.text(&name, ((from + to) / 2, panel.y.start + 15), TextStyle::new(size).centred());
    }
    panel.draw_frame(canvas)
}

/// A percentage with two figures.
fn two_figures(percent: f64) -> String {
    fixed(percent, if percent < 0.995 { 2 } else { usize::from(percent < 9.95) })
}

/// The places of an arm from its base to the load point, and the force, in one view.
struct Posed {
    arm: Vec<Vector2<f64>>,
    force: Vector2<f64>,
}

fn posed(request: &Request, plan: &Design, from_above: bool) -> Vec<Posed> {
    let pose = |LoadCase { theta, force, .. }: &LoadCase| {
        let frames = Frames::new(&request.robot, theta);
        let load = frames.base_from_flange.point(&request.load_point);
        let (sine, cosine) = libm::sincos(libm::atan2(load.y, load.x));
        let seen = |v: &Vector3<f64>| {
            if from_above { Vector2::new(v.x, v.y) } else { Vector2::new(v.x * cosine + v.y * sine, v.z) }
        };
        let [_, second, third, wrist, ..] = frames.origins;
        let shoulder = Vector3::new(0.0, 0.0, second.z);
        let places = [Vector3::zeros(), shoulder, second, third, wrist, frames.base_from_flange.translation, load];
        Posed { arm: places.iter().map(seen).collect(), force: seen(force) / request.load }
    };
    plan.load_cases.iter().map(pose).collect()
}

fn draw_views(canvas: &mut Canvas, request: &Request, plan: &Design) {
    let (top, side) = VIEWS;
    let titles = ["From above", "In the vertical plane through axis 1 and the load point"];
    for (index, title) in titles.into_iter().enumerate() {
        let left = LEFT + index as i32 * (RIGHT - LEFT - side);
        canvas.text(title, (left, top - 42), TextStyle::new(13.0).bold());
        let text = "grey: the arm to the load point; red: the load, its full length where it lies in the view";
        if index == 0 {
            canvas.text(text, (left, top - 20), TextStyle::new(12.0).coloured(INK));
        }
        view(canvas, &posed(request, plan, index == 0), left, index == 0);
    }
}

/// One view, with the same scale across and up.
fn view(canvas: &mut Canvas, poses: &[Posed], left: i32, from_above: bool) {
    let (top, side) = VIEWS;
    let places = poses.iter().flat_map(|pose| &pose.arm).map(|place| [place.x, place.y]);
    let [low, high] = around(places).unwrap_or_default().map(Vector2::from);
    let (middle, half) = ((low + high) / 2.0, 0.56 * (high - low).amax().max(0.1));
    let x = Scale::new((middle.x - half) * 1e3, (middle.x + half) * 1e3, left, left + side);
    let y = Scale::new((middle.y - half) * 1e3, (middle.y + half) * 1e3, top + side, top);
    let labels = if from_above { ["x (mm)", "y (mm)"] } else { ["out from axis 1 (mm)", "z (mm)"] };
    let panel = Panel::new(x, y, [6, 8], labels);
    panel.draw_grid(canvas);
    let place = |v: &Vector2<f64>| -> Place { panel.place(v.x * 1e3, v.y * 1e3) };
    for pose in poses {
        canvas.curve(&pose.arm.iter().map(place).collect::<Vec<_>>(), PALE, 1);
    }
    canvas.dot(place(&Vector2::zeros()), 5, GREY);
    for pose in poses {
        let Some(load) = pose.arm.last().map(place) else { continue };
        let tip = (load.0 + ARROW * pose.force.x, load.1 - ARROW * pose.force.y);
        if nearest(tip) == nearest(load) {
            canvas.dot(load, 3, ORANGE);
        } else {
            canvas.arrow(load, tip, ORANGE, 1);
        }
    }
    panel.draw_frame(canvas)
}
