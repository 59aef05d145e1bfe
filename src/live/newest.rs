//! Requests of which the newest counts: of every page at most one waits, and an older one gives way to it.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Pages that may wait at once; more are turned away.
const PAGES: usize = 64;

/// What becomes of a request.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome<A> {
    /// It was answered.
    Answered(A),
    /// A newer one of the same page has taken its place: nothing was computed.
    Superseded,
    /// Too many pages wait, or the session ends.
    Refused,
}

/// A request on its way, and where its answer goes.
#[derive(Debug)]
pub(super) struct Waiting<Q, A> {
    /// The page that asks.
    pub page: String,
    /// What it asks.
    pub asked: Q,
    answer: Sender<Outcome<A>>,
}

impl<Q, A> Waiting<Q, A> {
    /// Answers it. A page that has gone away is no error.
    pub fn answer(self, outcome: Outcome<A>) {
        let _ = self.answer.send(outcome);
    }
}

/// Those that wait, in the order in which their pages began to.
#[derive(Debug)]
pub(super) struct Newest<Q, A> {
    queue: Mutex<Queue<Q, A>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Queue<Q, A> {
    waiting: VecDeque<Waiting<Q, A>>,
    is_closed: bool,
}

impl<Q, A> Default for Newest<Q, A> {
    fn default() -> Self {
        Self { queue: Mutex::new(Queue { waiting: VecDeque::new(), is_closed: false }), changed: Condvar::new() }
    }
}

impl<Q, A> Newest<Q, A> {
    /// Puts a request in, in the place of an older one of the same page; its outcome arrives where this returns.
    pub fn ask(&self, page: String, asked: Q) -> Receiver<Outcome<A>> {
        let (answer, outcome) = channel();
        let new = Waiting { page, asked, answer };
        let mut queue = self.locked();
        match queue.waiting.iter().position(|waiting| waiting.page == new.page) {
            Some(place) => std::mem::replace(&mut queue.waiting[place], new).answer(Outcome::Superseded),
            None if queue.is_closed || queue.waiting.len() >= PAGES => new.answer(Outcome::Refused),
            None => queue.waiting.push_back(new),
        }
        self.changed.notify_all();
        outcome
    }

    /// The one whose page has waited longest; none when the session ends.
    pub fn next(&self) -> Option<Waiting<Q, A>> {
        let mut queue = self.locked();
        loop {
            if queue.is_closed {
                return None;
            }
            match queue.waiting.pop_front() {
                Some(next) => return Some(next),
                None => queue = self.changed.wait(queue).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    /// Ends the session: nothing is answered any more.
    pub fn close(&self) {
        let mut queue = self.locked();
        queue.is_closed = true;
        queue.waiting.drain(..).for_each(|waiting| waiting.answer(Outcome::Refused));
        self.changed.notify_all();
    }

    fn locked(&self) -> MutexGuard<'_, Queue<Q, A>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_page_the_newest_is_answered_and_pages_take_turns() {
        let newest: Newest<u32, u32> = Newest::default();
        let asked: Vec<_> = (0..500).map(|k| newest.ask("a".to_owned(), k)).collect();
        let other = newest.ask("b".to_owned(), 7);
        let (last, older) = asked.split_last().unwrap();
        assert!(older.iter().all(|outcome| outcome.recv().unwrap() == Outcome::Superseded));
        for (page, expected) in [("a", 499), ("b", 7)] {
            let next = newest.next().unwrap();
            assert_eq!((next.page.as_str(), next.asked), (page, expected));
            let asked = next.asked;
            next.answer(Outcome::Answered(asked + 1));
        }
        assert_eq!(last.recv().unwrap(), Outcome::Answered(500));
        assert_eq!(other.recv().unwrap(), Outcome::Answered(8));
    }

    #[test]
    fn too_many_pages_are_turned_away_and_so_is_everyone_at_the_end() {
        let newest: Newest<(), ()> = Newest::default();
        let asked: Vec<_> = (0..=PAGES).map(|k| newest.ask(k.to_string(), ())).collect();
        assert_eq!(asked[PAGES].recv().unwrap(), Outcome::Refused);
        newest.close();
        assert!(asked.iter().take(PAGES).all(|outcome| outcome.recv().unwrap() == Outcome::Refused));
        assert_eq!(newest.ask("late".to_owned(), ()).recv().unwrap(), Outcome::Refused);
        assert!(newest.next().is_none());
    }
}
