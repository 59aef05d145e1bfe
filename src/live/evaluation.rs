//! What a placement comes to: at once while it is moved, and all of it at rest.

use super::newest::Outcome;
use super::place::Place;
use super::reading::Reading;
use super::requests::{Body, RequestError};
use super::session::Session;
use crate::{Error, Run};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};
use stead_placement::place::PreviewProblem;
use stead_planning::feasibility::deflection_rows;
use stead_report::page::live::{Answer, LivePage, map_columns, map_points};

/// How long a part of a deflection map is worked at.
const MAP_PART: Duration = Duration::from_millis(60);
/// Columns of a map that are computed side by side.
const SIDE_BY_SIDE: usize = 8;

impl Session {
    /// Answers what pages ask of placements until [`close`](Self::close), in two threads that are returned.
    ///
    /// # Errors
    /// [`Error::Failed`] when the system gives no threads.
    pub fn start(self: &Arc<Self>) -> Result<Vec<std::thread::JoinHandle<()>>, Error> {
        let spawn = |name: &str, work: fn(&Self)| {
            let session = Arc::clone(self);
            std::thread::Builder::new().name(name.to_owned()).spawn(move || work(&session)).map_err(Error::failed)
        };
        Ok(vec![spawn("previews", Self::answer_previews)?, spawn("wholes", Self::answer_wholes)?])
    }

    /// Answers previews until the session ends. Planner and tables are kept as long as the setup stays.
    pub(super) fn answer_previews(&self) {
        let mut first = self.previews.next();
        while let Some(waiting) = first.take() {
            let reading = Arc::clone(&waiting.asked.reading);
            let setup = waiting.asked.place.setup.clone();
            let problem = reading.run.problem().in_setup(&setup);
            let shown = PreviewProblem::new(&problem);
            let planner = shown.planner();
            let mut workspace = planner.workspace();
            let page = LivePage::new(reading.run.problem(), &reading.context);
            let transfer = &reading.context.transfer;
            let mut next = Some(waiting);
            while let Some(waiting) = next {
                if !Arc::ptr_eq(&waiting.asked.reading, &reading) || waiting.asked.place.setup != setup {
                    first = Some(waiting);
                    break;
                }
                let placement = waiting.asked.place.placement;
                let answer = match shown.preview(&planner, &placement, transfer, &mut workspace) {
                    Ok(preview) => stated(page.preview(&problem, &placement, &preview, shown.points())),
                    Err(blocked) => refused(&blocked.reasons(), shown.points(), false),
                };
                let answer = waiting.asked.about(answer);
                waiting.answer(Outcome::Answered(answer));
                next = self.previews.next();
            }
        }
    }

    /// What the page shows of a placement when it is opened; none where it has no plan.
    pub(super) fn preview_at(
        &self,
        reading: &Reading,
        place: &Place,
        page: &LivePage<'_>,
    ) -> Result<Option<Answer>, Error> {
        let problem = reading.run.problem().in_setup(&place.setup);
        let shown = PreviewProblem::new(&problem);
        let [looked_at, all] = shown.points();
        if looked_at < all {
            // The script is opened with the columns of all points.
            return Ok(None);
        }
        let planner = shown.planner();
        let transfer = &reading.context.transfer;
        let found = shown.preview(&planner, &place.placement, transfer, &mut planner.workspace());
        Ok(found.ok().map(|preview| page.preview(&problem, &place.placement, &preview, [all, all])).transpose()?)
    }

    /// Scores placements at rest until the session ends.
    pub(super) fn answer_wholes(&self) {
        while let Some(waiting) = self.wholes.next() {
            let asked = &waiting.asked;
            let monitor = self.jobs.whole_begins(&waiting.page);
            let run = asked.reading.run.in_setup(&asked.place.setup);
            let scored = run.score(&asked.place.placement, &monitor);
            if monitor.should_stop() {
                waiting.answer(Outcome::Superseded);
                continue;
            }
            let count = run.problem().task.points().len();
            let page = LivePage::new(asked.reading.run.problem(), &asked.reading.context);
            let answer = match scored {
                Ok(score) => stated(page.score(&score.run.problem, &score.score, &score.context)),
                Err(Error::Infeasible(nothing)) => {
                    let reasons: Vec<String> = nothing.to_string().lines().map(|line| line.trim().to_owned()).collect();
                    refused(&reasons, [count, count], true)
                }
                Err(error) => refused(&[error.to_string()], [count, count], true),
            };
            let answer = asked.about(answer);
            waiting.answer(Outcome::Answered(answer));
        }
    }

    /// Columns of the deflection map of a placement from one of them on: as many as a short time allows.
    ///
    /// # Errors
    /// [`RequestError`] for a request that says no placement.
    pub fn map(&self, body: &[u8]) -> Result<Value, RequestError> {
        let body = Body::read(body)?;
        let reading = self.reading();
        let problem = reading.run.problem();
        let (place, from) = (body.place(problem)?, body.whole("from")?);
        let points = if reading.run.run.maps { map_points(problem) } else { Vec::new() };
        let wanted = points.get(from..).unwrap_or_default();
        let problem = problem.in_setup(&place.setup);
        let begun = Instant::now();
        let mut rows = Vec::new();
        for some in wanted.chunks(SIDE_BY_SIDE) {
            if begun.elapsed() > MAP_PART && !rows.is_empty() {
                break;
            }
            rows.extend(deflection_rows(&problem, &place.placement, some, || false).unwrap_or_default());
        }
        let made = &wanted[..rows.len().min(wanted.len())];
        let columns = map_columns(&problem, &place.placement, made, &rows);
        Ok(json!({
            "id": body.whole("id")?,
            "version": reading.version,
            "from": from,
            "all": points,
            "columns": columns,
        }))
    }
}

impl Run {
    /// The same run in a setup, in which external axes are not looked for.
    pub(super) fn in_setup(&self, setup: &stead_problem::setup::Setup) -> Self {
        let problem = self.run.problem.in_setup(setup).into_owned();
        Self { is_set_up: true, ..Self::of(stead_runs::Run { problem, ..(*self.run).clone() }) }
    }
}

/// An answer as the page has it; one that cannot be made says why.
fn stated(answer: Result<Answer, stead_report::ReportError>) -> Value {
    let failed = |error: String| refused(&[error], [0, 0], false);
    match answer {
        Ok(answer) => match serde_json::to_value(&answer) {
            Ok(mut value) => {
                value["feasible"] = true.into();
                value
            }
            Err(error) => failed(error.to_string()),
        },
        Err(error) => failed(error.to_string()),
    }
}

/// A placement without a plan.
fn refused(reasons: &[String], points: [usize; 2], is_whole: bool) -> Value {
    json!({ "feasible": false, "reasons": reasons, "points": points, "is_whole": is_whole })
}
