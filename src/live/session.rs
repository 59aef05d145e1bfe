//! A run that is tried out, and the folder that keeps what is found.

use super::edits;
use super::kept::{FILE, Kept, numbers_in};
use super::newest::{Newest, Outcome};
use super::pins::Pin;
use super::place::Place;
use super::reading::{Asked, Reading};
use super::requests::{Body, RequestError};
use super::running::Jobs;
use crate::files::FieldOverride;
use crate::{Error, Monitor, Run};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use stead_report::page::live::LivePage;
use stead_report::{Folder, document};

/// What a session begins with.
#[derive(Debug, Clone, Default)]
pub struct LiveOptions {
    /// The run file.
    pub file: PathBuf,
    /// Values in place of its own.
    pub values: Vec<FieldOverride>,
    /// A results folder of `stead place` and a case of it, with the placement to begin at: that of the last session in
    /// the same folder where there is none, else the middle of the cell.
    pub placement_of: Option<(PathBuf, u8)>,
}

/// A run that is tried out: what pages ask is answered, and what they keep is written into a folder that no other
/// process writes to in the meantime.
#[derive(Debug)]
pub struct Session {
    pub(super) file: PathBuf,
    pub(super) given: Vec<FieldOverride>,
    pub(super) folder: Folder,
    /// The values of the file without those that were changed in the session.
    stated: Value,
    known: Mutex<Known>,
    pub(super) previews: Newest<Asked, Value>,
    pub(super) wholes: Newest<Asked, Value>,
    pub(super) jobs: Jobs,
    notes: Vec<String>,
}

/// What changes in a session.
#[derive(Debug)]
pub(super) struct Known {
    pub reading: Arc<Reading>,
    /// Where the part stood at rest last.
    pub place: Place,
    pub pins: Vec<Pin>,
    /// The last number of each kind of what was written.
    pub numbers: Map<String, Value>,
}

impl Session {
    /// A session of a run as it was read from a file, with what an earlier one has left in the folder.
    ///
    /// # Errors
    /// As [`Run::set_up_as_in`].
    pub fn new(run: Run, options: LiveOptions, folder: Folder, monitor: &Monitor) -> Result<Self, Error> {
        let LiveOptions { file, values, placement_of } = options;
        if run.problem().lean.is_some() {
            let told = "a placement that is moved by hand is planned with the tool axis of the task";
            let allowed = "a run without [lean], or `stead place` and `stead score`";
            return Err(Error::Argument(format!("{told}, and the run has [lean]; allowed: {allowed}")));
        }
        let mut notes = Vec::new();
        let (kept, unreadable) = Kept::in_folder(&folder)?;
        notes.extend(unreadable);
        let edits = kept.edits();
        let stated = run.run.stated.clone();
        let mut reading = Reading::new(1, run, Vec::new());
        if !edits.is_empty() {
            let shown = edits.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            match Run::read_with(&file, [values.clone(), edits.clone()].concat(), monitor) {
                Ok(run) => {
                    notes.push(format!("values changed in the last session: {shown}"));
                    reading = Reading::new(1, run, edits);
                }
                Err(error) => notes.push(format!("the values of the last session are left out ({shown}): {error}")),
            }
        }
        let problem = reading.run.problem();
        let place = match placement_of {
            Some((results, case)) => {
                let (run, placement) = reading.run.clone().set_up_as_in(results, case)?;
                Place { placement, setup: run.problem().setup.clone() }
            }
            None => kept.place(problem).unwrap_or_else(|| Place::middle(problem)),
        };
        let pins = Pin::all_in(&folder, &kept);
        Ok(Self {
            file,
            given: values,
            folder,
            stated,
            known: Mutex::new(Known { reading: Arc::new(reading), place, pins, numbers: kept.numbers() }),
            previews: Newest::default(),
            wholes: Newest::default(),
            jobs: Jobs::default(),
            notes,
        })
    }

    /// The run as it is read now.
    pub fn run(&self) -> Run {
        self.known().reading.run.clone()
    }

    /// What should be known of how the session begins, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The folder that keeps what is found.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(super) fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn reading(&self) -> Arc<Reading> {
        Arc::clone(&self.known().reading)
    }

    /// Ends the session: jobs end with what they have, and keep it.
    pub fn close(&self) {
        self.previews.close();
        self.wholes.close();
        self.jobs.close();
    }

    /// The page as it is opened, with what is known of the placement by then.
    ///
    /// # Errors
    /// [`Error::Output`]: the page cannot be made.
    pub fn page(&self) -> Result<Vec<u8>, Error> {
        let (reading, place) = {
            let known = self.known();
            (Arc::clone(&known.reading), known.place.clone())
        };
        let page = LivePage::new(reading.run.problem(), &reading.context);
        let shown = self.preview_at(&reading, &place, &page)?;
        let title = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let live = json!({
            "place": place.entry(reading.run.problem()),
            "orientations": reading.run.problem().orientations.iter().map(|one| &one.name).collect::<Vec<_>>(),
            "stated": reading.run.run.stated,
            "stated_in_file": self.stated,
            "state": self.state(),
            "has_maps": reading.run.run.maps,
            "has_page": reading.run.run.page,
            "points": reading.run.problem().task.points().len(),
        });
        Ok(page.html(&title, shown.as_ref(), &live)?)
    }

    /// What changes while pages look on: the version of the run, the job that runs, those that have ended, and the
    /// placements kept.
    pub fn state(&self) -> Value {
        let known = self.known();
        json!({
            "version": known.reading.version,
            "edits": known.reading.edits.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "folder": self.folder.path().display().to_string(),
            "pins": known.pins.iter().map(Pin::entry).collect::<Vec<_>>(),
            "jobs": self.jobs.state(),
        })
    }

    /// What a placement comes to, on the grid of the run and along a long path on some of its points: for a part that
    /// is being moved.
    ///
    /// # Errors
    /// [`RequestError`] for a request that says no placement.
    pub fn preview(&self, body: &[u8]) -> Result<Value, RequestError> {
        let (page, asked) = self.asked(body)?;
        self.jobs.outdate(&page);
        received(&self.previews.ask(page, asked))
    }

    /// All that `stead score` states of a placement: for a part at rest.
    ///
    /// # Errors
    /// As [`preview`](Self::preview).
    pub fn whole(&self, body: &[u8]) -> Result<Value, RequestError> {
        let (page, asked) = self.asked(body)?;
        {
            let mut known = self.known();
            known.place = asked.place.clone();
        }
        let _ = self.keep_state();
        self.jobs.outdate(&page);
        received(&self.wholes.ask(page, asked))
    }

    fn asked(&self, body: &[u8]) -> Result<(String, Asked), RequestError> {
        let body = Body::read(body)?;
        let reading = self.reading();
        let place = body.place(reading.run.problem())?;
        Ok((body.page()?, Asked { id: body.whole("id")?, place, reading }))
    }

    /// Reads the run again with other values in place of its own; those of an earlier change no longer count.
    ///
    /// # Errors
    /// [`RequestError`] in the words of the file's own checks; the run stays as it was.
    pub fn edit(&self, body: &[u8]) -> Result<Value, RequestError> {
        let body = Body::read(body)?;
        let edits = body.texts("edits")?;
        let edits = edits.iter().map(|text| edits::allowed(text)).collect::<Result<Vec<_>, _>>()?;
        let values = [self.given.clone(), edits.clone()].concat();
        let run = Run::read_with(&self.file, values, &Monitor::silent())
            .map_err(|error| RequestError::of_file("edits", error))?;
        {
            let mut known = self.known();
            let version = known.reading.version + 1;
            let entry = known.place.entry(known.reading.run.problem());
            if let Some(place) = Place::of_entry(run.problem(), &entry) {
                known.place = place;
            } else {
                known.place.setup = run.problem().setup.clone();
            }
            known.reading = Arc::new(Reading::new(version, run, edits));
        }
        let _ = self.keep_state();
        Ok(self.state())
    }

    /// Writes the run file with the values of now as a new file beside it; on request its cell then holds the placement
    /// alone.
    ///
    /// # Errors
    /// [`RequestError`] for a name that is none, a file that is there, and values that no run file can hold.
    pub fn save(&self, body: &[u8]) -> Result<Value, RequestError> {
        let body = Body::read(body)?;
        let reading = self.reading();
        let place = if body.is_on("is_placement")? { Some(body.place(reading.run.problem())?) } else { None };
        let file = edits::save(&self.file, &self.given, &reading, body.text("name")?, place.as_ref())?;
        Ok(json!({ "file": file.display().to_string() }))
    }

    /// Writes what is to be there again when the folder is opened by another session. That it cannot be written is
    /// returned, and said when a placement is kept.
    pub(super) fn keep_state(&self) -> Option<String> {
        let written = self.folder.write(FILE, &document::bytes(&self.known().kept()));
        written.err().map(|error| format!("warning: a later session will not know names and changed values: {error}"))
    }

    /// The number of the next file or folder with such a name: none that there is, and none that there was, so that
    /// what has been written down of one stays true of it.
    pub(super) fn next_number(&self, before: &str, behind: &str) -> u64 {
        let there = numbers_in(self.folder(), before, behind).last().copied().unwrap_or(0);
        let number = {
            let mut known = self.known();
            let was = known.numbers.get(before).and_then(Value::as_u64).unwrap_or(0);
            let number = there.max(was).saturating_add(1);
            known.numbers.insert(before.to_owned(), number.into());
            number
        };
        // What follows says it.
        let _ = self.keep_state();
        number
    }
}

impl Known {
    fn kept(&self) -> Value {
        json!({
            "place": self.place.entry(self.reading.run.problem()),
            "edits": self.reading.edits.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "pins": self.pins.iter().map(Pin::kept).collect::<Vec<_>>(),
            "numbers": self.numbers,
        })
    }
}

/// What became of a request.
fn received(outcome: &std::sync::mpsc::Receiver<Outcome<Value>>) -> Result<Value, RequestError> {
    match outcome.recv() {
        Ok(Outcome::Answered(answer)) => Ok(answer),
        Ok(Outcome::Superseded) => Ok(json!({ "is_superseded": true })),
        Ok(Outcome::Refused) | Err(_) => {
            Err(RequestError::new("page", "is not answered: the session ends, or too many pages ask", "fewer pages"))
        }
    }
}
