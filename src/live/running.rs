//! The long job that runs, one at a time, and those that have ended.

use super::requests::RequestError;
use crate::Monitor;
use crate::progress::{Described, locked};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;
use stead_certify::{Forecast, Outlook};
use stead_numerics::monitor::{Progress, StopHandle};

/// Jobs that have ended and are still told of.
const TOLD: usize = 16;

/// The job that runs and those that have ended.
#[derive(Debug, Default)]
pub(super) struct Jobs {
    list: Mutex<List>,
    /// The page of the placement that is scored now, and what stops it when the page moves on.
    whole: Mutex<Option<(String, StopHandle)>>,
}

#[derive(Debug, Default)]
struct List {
    begun: usize,
    running: Option<Running>,
    ended: VecDeque<Value>,
    is_closed: bool,
    thread: Option<JoinHandle<()>>,
}

/// What a job reported last, and when a certificate will be there as far as it can be told.
type Latest = (Progress, Option<Outlook>);

#[derive(Debug)]
struct Running {
    id: usize,
    name: &'static str,
    page: String,
    begun: Instant,
    stop: StopHandle,
    is_stopping: bool,
    latest: Arc<Mutex<Option<Latest>>>,
}

/// What a job comes to.
pub(super) struct Ended {
    /// In sentences.
    pub said: Vec<String>,
    /// A placement that pages may go to.
    pub place: Option<Value>,
    /// The name of the folder that keeps it.
    pub pin: Option<String>,
}

impl Jobs {
    /// A monitor for the placement of a page that is scored now.
    pub fn whole_begins(&self, page: &str) -> Monitor {
        let monitor = Monitor::silent().for_all_or_nothing();
        *locked(&self.whole) = Some((page.to_owned(), monitor.stop_handle()));
        monitor
    }

    /// A page has moved on: what is scored for it is not wanted any more.
    pub fn outdate(&self, page: &str) {
        if let Some((_, stop)) = locked(&self.whole).as_ref().filter(|(asked, _)| asked == page) {
            stop.stop();
        }
    }

    /// Stops what runs, and waits for what it keeps.
    pub fn close(&self) {
        let thread = {
            let mut list = locked(&self.list);
            list.is_closed = true;
            list.running.iter_mut().for_each(Running::stop);
            list.thread.take()
        };
        if let Some((_, stop)) = locked(&self.whole).as_ref() {
            stop.stop();
        }
        // A thread that has failed has nothing left to write.
        drop(thread.map(JoinHandle::join));
    }

    /// The job that runs and those that have ended, the last one last.
    pub fn state(&self) -> Value {
        let list = locked(&self.list);
        let running = list.running.as_ref().map(Running::entry);
        json!({ "running": running, "ended": list.ended })
    }

    /// Asks the job that runs to end with what it has.
    pub fn stop(&self) {
        locked(&self.list).running.iter_mut().for_each(Running::stop);
    }

    /// Begins a job of this name for a page; returns its number, and what it reports to.
    ///
    /// # Errors
    /// [`RequestError`] while another one runs, and when the session ends.
    pub fn begin(&self, name: &'static str, page: String) -> Result<(usize, Monitor), RequestError> {
        let mut list = locked(&self.list);
        if let Some(running) = &list.running {
            let problem = format!("waits: `{}` is running", running.name);
            return Err(RequestError::new("job", problem, "one job at a time: stop it, or wait until it has ended"));
        }
        if list.is_closed {
            return Err(RequestError::new("job", "cannot begin: the session ends", "another session"));
        }
        list.begun += 1;
        let latest: Arc<Mutex<Option<Latest>>> = Arc::default();
        let seen = Arc::clone(&latest);
        let (forecast, begun) = (Mutex::<Forecast>::default(), Instant::now());
        let monitor = Monitor::new(move |progress| {
            let outlook = locked(&forecast).add(progress, begun.elapsed());
            *locked(&seen) = Some((*progress, outlook));
        });
        let (id, stop) = (list.begun, monitor.stop_handle());
        list.running = Some(Running { id, name, page, begun, stop, is_stopping: false, latest });
        Ok((id, monitor))
    }

    /// The thread in which the job runs.
    pub fn runs_in(&self, thread: JoinHandle<()>) {
        locked(&self.list).thread = Some(thread);
    }

    /// What has become of the job.
    pub fn end(&self, ended: Result<Ended, String>) {
        let mut list = locked(&self.list);
        let Some(running) = list.running.take() else { return };
        let mut entry =
            json!({ "id": running.id, "name": running.name, "page": running.page, "was_stopped": running.is_stopping });
        match ended {
            Ok(Ended { said, place, pin }) => {
                entry["said"] = said.into();
                entry["place"] = place.unwrap_or_default();
                entry["pin"] = pin.into();
            }
            Err(error) => entry["error"] = error.into(),
        }
        list.ended.push_back(entry);
        if list.ended.len() > TOLD {
            list.ended.pop_front();
        }
    }
}

impl Running {
    fn stop(&mut self) {
        self.stop.stop();
        self.is_stopping = true;
    }

    fn entry(&self) -> Value {
        let described = locked(&self.latest).as_ref().map(|(progress, outlook)| Described::of(progress, *outlook));
        let (stage, steps, message) = described
            .map_or(("", None, String::new()), |described| (described.stage, described.steps, described.message));
        json!({
            "id": self.id,
            "name": self.name,
            "page": self.page,
            "seconds": self.begun.elapsed().as_secs(),
            "is_stopping": self.is_stopping,
            "stage": stage,
            "done": steps.map(|(done, _)| done),
            "total": steps.map(|(_, total)| total),
            "message": message,
        })
    }
}
