//! What long jobs do: they go on when their page has gone, end early when they are asked to, and keep what they
//! have found.

use super::pins::{NAME, Pin};
use super::place::Place;
use super::reading::Reading;
use super::requests::{Body, RequestError};
use super::running::Ended;
use super::session::Session;
use crate::program::{ExportOptions, ProgramFormat};
use crate::{Error, Monitor, Run};
use serde_json::{Value, json};
use std::sync::Arc;
use stead_disk::Existing;
use stead_placement::place::{improve, setup_at};
use stead_problem::settings::CertificateSettings;
use stead_report::certificate::{certificate_json, certificate_text};
use stead_report::document;
use stead_report::units::{Unit, fixed};

/// What a certificate is called, with a number between.
const CERTIFICATE: [&str; 2] = ["certificate-", ".json"];

/// What can be done in the background.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// The best placement near the given one.
    SearchHere,
    /// The best placement of the cell.
    SearchCell,
    /// How far the placement is from the best possible, to a gap (relative).
    Certify(f64),
    /// The external axes where the placement is best.
    SetUp,
    /// A folder with the placement.
    Keep,
    /// A robot program of a placement that is kept.
    Export(Exported),
}

/// What a program is made of.
#[derive(Debug, Clone, PartialEq)]
struct Exported {
    pin: Pin,
    format: ProgramFormat,
    name: String,
    mechanism: Option<usize>,
    unit: Option<String>,
}

impl Kind {
    fn name(&self) -> &'static str {
        match self {
            Self::SearchHere => "search from here",
            Self::SearchCell => "search the cell",
            Self::Certify(_) => "certify",
            Self::SetUp => "set up the axes",
            Self::Keep => "keep this placement",
            Self::Export(_) => "export",
        }
    }
}

impl Session {
    /// Begins a job.
    ///
    /// # Errors
    /// [`RequestError`] for a job that there is not, or while another one runs.
    pub fn begin(self: &Arc<Self>, body: &[u8]) -> Result<Value, RequestError> {
        let body = Body::read(body)?;
        let reading = self.reading();
        let (kind, page) = (self.kind(&body, &reading)?, body.page()?);
        let place = match kind {
            Kind::Export(_) => self.known().place.clone(),
            _ => body.place(reading.run.problem())?,
        };
        let label = if body.is_on("is_labelled")? { body.text("label")?.to_owned() } else { String::new() };
        let (id, monitor) = self.jobs.begin(kind.name(), page)?;
        let session = Arc::clone(self);
        let work = move || {
            let ended = on_spare_threads(|| session.run_job(&kind, &reading, &place, &label, &monitor));
            session.jobs.end(ended.and_then(|ended| ended.map_err(|error| error.to_string())));
        };
        match std::thread::Builder::new().name("job".to_owned()).spawn(work) {
            Ok(thread) => self.jobs.runs_in(thread),
            Err(error) => self.jobs.end(Err(error.to_string())),
        }
        Ok(json!({ "id": id }))
    }

    /// Asks the job that runs to end with what it has.
    pub fn stop(&self) -> Value {
        self.jobs.stop();
        self.jobs.state()
    }

    fn kind(&self, body: &Body, reading: &Reading) -> Result<Kind, RequestError> {
        match body.text("job")? {
            "search_here" => Ok(Kind::SearchHere),
            "search_cell" => Ok(Kind::SearchCell),
            "set_up" if !reading.run.problem().external_axes.is_empty() => Ok(Kind::SetUp),
            "keep" => Ok(Kind::Keep),
            "certify" => {
                let percent = body.number("gap_percent", 100.0)?;
                let gap = CertificateSettings::gap(percent).ok_or_else(|| {
                    let problem = format!("is no such gap, found {percent} %");
                    RequestError::new("gap_percent", problem, stead_run_files::GAPS_ALLOWED)
                })?;
                Ok(Kind::Certify(gap))
            }
            "export" => self.exported(body).map(Kind::Export),
            other => {
                let allowed = "search_here, search_cell, certify, keep, export, and with external axes set_up";
                Err(RequestError::new("job", format!("is none, found {other}"), allowed))
            }
        }
    }

    fn exported(&self, body: &Body) -> Result<Exported, RequestError> {
        let (name, word) = (body.text("pin")?, body.text("format")?);
        let pin = self.known().pins.iter().find(|pin| pin.name == name).cloned();
        let pin =
            pin.ok_or_else(|| RequestError::new("pin", format!("is none, found {name}"), "a placement that is kept"))?;
        let format = ProgramFormat::ALL.into_iter().find(|format| format.word() == word);
        let format = format.ok_or_else(|| {
            let allowed = ProgramFormat::ALL.map(ProgramFormat::word).join(", ");
            RequestError::new("format", format!("is none, found {word}"), allowed)
        })?;
        let mechanism = if body.is_on("has_mechanism")? { Some(body.whole("mechanism")?) } else { None };
        let unit = if body.is_on("has_unit")? { Some(body.text("unit")?.to_owned()) } else { None };
        Ok(Exported { pin, format, name: body.text("name")?.to_owned(), mechanism, unit })
    }

    fn run_job(
        &self,
        kind: &Kind,
        reading: &Reading,
        place: &Place,
        label: &str,
        monitor: &Monitor,
    ) -> Result<Ended, Error> {
        let problem = reading.run.problem();
        match kind {
            Kind::Keep => self.keep(reading, place, label, monitor, Vec::new()),
            Kind::SearchHere => {
                let set_up = problem.in_setup(&place.setup);
                let placement = improve(&set_up, &place.placement, monitor).map_err(infeasible)?;
                let found = Place { placement, setup: place.setup.clone() };
                self.keep(reading, &found, "search from here", &Monitor::silent(), Vec::new())
            }
            Kind::SearchCell => {
                let placements = reading.run.clone().without_worst().search(monitor)?;
                let (outcome, best) = (placements.outcome(), &placements.cases().best);
                let mut said = vec![format!("the best of {} placements", outcome.evaluations)];
                said.extend(outcome.warnings.iter().map(ToString::to_string));
                let found = Place { placement: best.placement, setup: best.setup.clone() };
                self.keep(reading, &found, "search of the cell", &Monitor::silent(), said)
            }
            Kind::SetUp => {
                let setup = setup_at(&problem.in_setup(&place.setup), &place.placement, monitor);
                let found = Place { setup, ..place.clone() };
                let said = vec!["the external axes stand where the placement is best".to_owned()];
                Ok(Ended { said, place: Some(found.entry(problem)), pin: None })
            }
            Kind::Certify(gap) => self.certify(*gap, reading, place, monitor),
            Kind::Export(exported) => self.export(exported, reading, monitor),
        }
    }

    /// Scores a placement and writes its folder.
    fn keep(
        &self,
        reading: &Reading,
        place: &Place,
        label: &str,
        monitor: &Monitor,
        mut said: Vec<String>,
    ) -> Result<Ended, Error> {
        let mut score = reading.run.in_setup(&place.setup).score(&place.placement, monitor)?;
        score.map(monitor);
        score.make_sheet(monitor);
        let name = format!("{NAME}{}", self.next_number(NAME, ""));
        score.write(self.folder.path().join(&name))?;
        self.known().pins.push(Pin::new(&name, label, &reading.edits, &score.to_json()));
        // What the folder does not hold may be lost.
        let unkept = self.keep_state();
        let mean = Unit::DEFLECTION_MM.text(score.score().plans.best.mean);
        said.push(format!("mean {mean} mm, kept in {}", self.folder.path().join(&name).display()));
        said.extend(unkept);
        Ok(Ended { said, place: Some(place.entry(reading.run.problem())), pin: Some(name) })
    }

    fn certify(&self, gap: f64, reading: &Reading, place: &Place, monitor: &Monitor) -> Result<Ended, Error> {
        let set_up = reading.run.in_setup(&place.setup);
        let scored = set_up.score(&place.placement, &Monitor::silent())?;
        let settings =
            CertificateSettings { gap, ..reading.run.run.certificate.unwrap_or(CertificateSettings::new(gap)) };
        let objective = scored.score().plans.best.objective;
        let found = stead_certify::certify(set_up.problem(), &place.placement, objective, None, settings, monitor);
        let mut stated = certificate_json(&found, reading.run.inputs());
        stated["changed_values"] = reading.edits.iter().map(ToString::to_string).collect::<Vec<_>>().into();
        if let (Value::Object(stated), Value::Object(place)) = (&mut stated, place.entry(reading.run.problem())) {
            stated.extend(place);
        }
        let [before, behind] = CERTIFICATE;
        let (number, bytes) = (self.next_number(before, behind), document::bytes(&stated));
        let name = format!("{before}{number}{behind}");
        let file = self.folder.write(&name, &bytes)?;
        // A paragraph for each placement; no worst one was asked for.
        let text = certificate_text(&found);
        let best = text.split("No certificate for the worst").next().unwrap_or_default();
        let mut said = vec![best.split_whitespace().collect::<Vec<_>>().join(" ")];
        said.extend(found.warnings.iter().map(ToString::to_string));
        said.push(format!("in {} s; {}", fixed(found.wall, 1), file.display()));
        Ok(Ended { said, place: None, pin: None })
    }

    fn export(&self, exported: &Exported, reading: &Reading, monitor: &Monitor) -> Result<Ended, Error> {
        let Exported { pin, format, name, mechanism, unit } = exported;
        let edits = pin.edits();
        let now: Vec<String> = reading.edits.iter().map(ToString::to_string).collect();
        let read_again = if edits.iter().map(ToString::to_string).eq(now) {
            None
        } else {
            Some(Run::read_with(&self.file, [self.given.clone(), edits].concat(), monitor)?)
        };
        let run = read_again.as_ref().unwrap_or(&reading.run);
        let approach = run.problem().segment_moves.retract;
        let options = ExportOptions {
            mechanism: *mechanism,
            unit: unit.as_deref(),
            approach,
            ..ExportOptions::new(*format, name)
        };
        let program = run.export(self.folder.path().join(&pin.name).join("best-plan.csv"), &options, monitor)?;
        let folder = self.folder.path().join("programs").join(&pin.name);
        let written = program.write(&folder, Existing::Kept)?;
        let mut said: Vec<String> = written.files.iter().map(|file| file.display().to_string()).collect();
        said.extend(program.notes().iter().chain(&written.notes).map(|note| format!("note: {note}")));
        said.extend(program.warnings().iter().map(|warning| format!("warning: {warning}")));
        Ok(Ended { said, place: None, pin: None })
    }
}

fn infeasible(nothing: stead_placement::place::Infeasible) -> Error {
    Error::Infeasible(Box::new(nothing))
}

/// Runs a job on all processors but one, which is left to the part that is being moved.
fn on_spare_threads<T: Send>(job: impl FnOnce() -> T + Send) -> Result<T, String> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(processors.saturating_sub(1).max(1)).build();
    pool.map(|pool| pool.install(job)).map_err(|error| format!("the threads cannot be started: {error}"))
}
