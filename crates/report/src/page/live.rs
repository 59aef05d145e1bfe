//! The page of a placement that is moved by hand, `stead live`: what is in it when it is opened, and the answers that
//! it is given later. Both are made of the same parts as the page of a results folder, so that its script shows them.

use super::content::Thinned;
use super::data::page_data;
use super::map_data::{MapColumns, columns};
use super::moves::moves;
use super::setup::part_turn;
use super::table::Table;
use super::{content, html};
use crate::document::value;
use crate::output::ReportError;
use crate::placement::context::Context;
use crate::placement::evaluation::{preview_json, score_json};
use crate::placement::tables;
use nalgebra::Vector3;
use serde::Serialize;
use serde_json::Value;
use stead_model::robot::Posture;
use stead_numerics::mean_max::MeanAndMax;
use stead_placement::outcome::PlanPoint;
use stead_placement::place::{Preview, Score};
use stead_planning::feasibility::MapRow;
use stead_problem::evaluate::reference::ScoredByOrigin;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::BySense;
use stead_problem::setup::AxisPath;

/// What the page shows of a placement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// How many path points its figures are of, and how many there are.
    pub points: [usize; 2],
    /// Whether it is all that `stead score` states, or the best plan on the grid of the run alone.
    pub is_whole: bool,
    /// As `score.json`.
    document: Value,
    /// The tables of its plans, the best first, by their columns.
    plans: Vec<Value>,
    /// For each plan its moves between segments, as in `page-data.json`.
    #[serde(skip_serializing_if = "Option::is_none")]
    moves: Option<Value>,
    /// How the part is turned before it is placed, where it may lie in several ways.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_turn: Option<[[f64; 3]; 3]>,
}

/// The best plan of a placement of which nothing is known.
#[derive(Debug, Default, Serialize)]
struct BlankPlan {
    mean_mm: f64,
    max_mm: f64,
    postures: [u8; 0],
    cutting_s: f64,
    cycle_s: Option<f64>,
    transfers: [u8; 0],
    joint_travel: Option<f64>,
    deflection_mm: BlankDeflection,
}

/// Its deflection.
#[derive(Debug, Default, Serialize)]
struct BlankDeflection {
    total: MeanAndMax,
}

/// Such a placement.
#[derive(Debug, Serialize)]
struct BlankPlacement<'a> {
    best: BlankPlan,
    placement: &'a Value,
    placement_exact: &'a Value,
    orientation: &'a Value,
    feasible: bool,
}

/// What is shown of a run beyond a single placement.
#[derive(Debug)]
pub struct LivePage<'a> {
    /// The problem as the page has its task.
    problem: &'a Problem,
    context: &'a Context,
    /// The points that a long path is drawn with.
    drawn: Option<Vec<usize>>,
}

impl<'a> LivePage<'a> {
    /// That of a problem.
    pub fn new(problem: &'a Problem, context: &'a Context) -> Self {
        Self { problem, context, drawn: content::evenly_chosen(problem) }
    }

    /// A placement that is moved: the problem in its setup, and what the preview comes to on so many of all points.
    ///
    /// # Errors
    /// [`ReportError::Format`] when a table cannot be made.
    pub fn preview(
        &self,
        problem: &Problem,
        placement: &Placement,
        preview: &Preview,
        points: [usize; 2],
    ) -> Result<Answer, ReportError> {
        Ok(Answer {
            points,
            is_whole: false,
            document: preview_json(placement, problem, preview, self.context),
            plans: vec![self.columns(problem, &preview.plan.points, &preview.plan.axes, points[0] == points[1])?],
            moves: None,
            part_turn: self.part_turn(problem),
        })
    }

    /// A placement at rest, with all that `stead score` states of it.
    ///
    /// # Errors
    /// [`ReportError::Format`] when a table cannot be made.
    pub fn score(&self, problem: &Problem, score: &Score, context: &Context) -> Result<Answer, ReportError> {
        let BySense { best, worst } = score.cases();
        let plans = [&best, &worst].map(|case| self.columns(problem, &case.plan.points, &case.plan.axes, true));
        let count = problem.task.points().len();
        Ok(Answer {
            points: [count, count],
            is_whole: true,
            document: score_json(problem, score, context),
            plans: plans.into_iter().collect::<Result<_, _>>()?,
            moves: moves(problem, &context.transfer, &[&best, &worst]).map(|moves| value(&moves)),
            part_turn: self.part_turn(problem),
        })
    }

    fn part_turn(&self, problem: &Problem) -> Option<[[f64; 3]; 3]> {
        (!self.problem.orientations.is_empty()).then(|| part_turn(self.problem, &problem.setup))
    }

    /// The table of a plan by its columns; of a whole path the points that are drawn.
    fn columns(
        &self,
        problem: &Problem,
        points: &[PlanPoint],
        axes: &[AxisPath],
        is_whole: bool,
    ) -> Result<Value, ReportError> {
        let bytes = tables::plan_points(points, axes, problem.scene.as_deref())?;
        let chosen = self.drawn.as_deref().filter(|_| is_whole);
        Ok(Table::read("plan", &bytes)?.content(&["nearest_pair"], chosen)?)
    }

    /// The page as it is opened, with what is known of a placement by then, and what else its script needs to know.
    ///
    /// # Errors
    /// [`ReportError::Format`] when a table cannot be read.
    pub fn html(&self, title: &str, shown: Option<&Answer>, live: &Value) -> Result<Vec<u8>, ReportError> {
        let mut data = page_data(self.context, content::SCORE, self.problem, &[], &[]);
        if let Some(chosen) = &self.drawn {
            content::keep_points(&mut data, chosen);
        }
        let (document, plans, turn) = match shown {
            Some(answer) => (answer.document.clone(), answer.plans.clone(), answer.part_turn),
            None => (self.blank_document(&live["place"]), vec![self.blank()?], self.part_turn(self.problem)),
        };
        let [points, all] = [self.drawn.as_ref().map_or(0, Vec::len), self.problem.task.points().len()];
        data["thinned"] = if points > 0 { value(&Thinned { points: all, shown: points }) } else { Value::Null };
        data["document"] = document;
        // Until the worst plan is known, the best one stands for it.
        data["plans"] = [plans.first(), plans.last()].into_iter().flatten().cloned().collect();
        if data["document"]["worst"].is_null() {
            data["document"]["worst"] = data["document"]["best"].clone();
        }
        if let Some(turn) = turn {
            data["part_turns"] = value(&[turn; 4]);
        }
        data["posture_words"] =
            value(&Posture::ALL.map(|posture| self.problem.robot.posture_words(posture).to_string()));
        data["live"] = live.clone();
        Ok(html::html(title, html::LIVE, &data.to_string()).into_bytes())
    }

    /// The document of a placement of which nothing is known.
    fn blank_document(&self, place: &Value) -> Value {
        let (exact, orientation) = (&place["placement_exact"], &place["orientation"]);
        let best = BlankPlan::default();
        let placement = BlankPlacement { best, placement: exact, placement_exact: exact, orientation, feasible: false };
        self.context.document().with(value(&placement))
    }

    /// The columns of a plan that is not known: no deflection, and the arm in the middle of its ranges.
    fn blank(&self) -> Result<Value, ReportError> {
        let task = &self.problem.task;
        let point = |point: usize| PlanPoint {
            point,
            segment: task.path().segment_of(point) + 1,
            position: Vector3::zeros(),
            beta: 0.0,
            posture: Posture::ALL[0],
            posture_words: self.problem.robot.posture_words(Posture::ALL[0]),
            joints: self.problem.robot.mid_range(),
            inverse_condition: 0.0,
            force: Vector3::zeros(),
            deflection: Vector3::zeros(),
            feed_part: 0.0,
            normal_part: 0.0,
            axial_part: 0.0,
            surface_part: task.path().surface_normals().map(|_| 0.0),
            score: 0.0,
            deviation: self.problem.robot.uncertainty().map(|_| 0.0),
            by_origin: self.problem.yields_beside().then(ScoredByOrigin::default),
            clearance: None,
            lean: None,
        };
        let points: Vec<PlanPoint> = (0..task.points().len()).map(point).collect();
        self.columns(self.problem, &points, &self.problem.axis_paths(), true)
    }
}

/// The path points that a deflection map in the page shows.
pub fn map_points(problem: &Problem) -> Vec<usize> {
    columns(problem.task.points().len())
}

/// Rows of a deflection map at path points, as the script of the page has a whole one.
pub fn map_columns(problem: &Problem, placement: &Placement, points: &[usize], rows: &[MapRow]) -> Value {
    value(&MapColumns::of(problem, placement, points, rows))
}
