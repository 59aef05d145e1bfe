//! Where files come from: the disk, or what was read from it once for many runs.

use crate::mesh::{MeshUnit, read_mesh};
use crate::task::{Imported, parse_csv};
use std::any::Any;
use std::collections::HashMap;
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use stead_cell::TriangleMesh;
use stead_disk::files;
use stead_disk::input::InputError;
use stead_model::robot::Robot;

/// Where files come from. Clones share what was read.
#[derive(Debug, Clone, Default)]
pub struct Sources(Option<Arc<Shared>>);

#[derive(Debug, Default)]
struct Shared {
    files: Known<PathBuf, [u8]>,
    /// Robots of files without values put in place of theirs, and whether with what motion needs.
    robots: Known<(PathBuf, Option<bool>), Robot>,
    tasks: Known<PathBuf, Imported>,
    meshes: Known<(PathBuf, MeshUnit), TriangleMesh>,
    /// What was made of files, by all that it depends on; a slot is locked while it is filled.
    made: Mutex<HashMap<String, Arc<Slot>>>,
}

/// Place of something that takes long to make.
type Slot = Mutex<Option<Arc<dyn Any + Send + Sync>>>;

/// What was read or made once, by its key.
type Known<K, T> = Mutex<HashMap<K, Arc<T>>>;

impl Sources {
    /// Files are read from the disk whenever they are needed.
    pub fn disk() -> Self {
        Self(None)
    }

    /// Every file is read and parsed once: all runs see the same bytes, whatever becomes of the file.
    pub fn shared() -> Self {
        Self(Some(Arc::default()))
    }

    /// The bytes of a file.
    pub(crate) fn read(&self, file: &Path) -> std::io::Result<Arc<[u8]>> {
        let Some(shared) = &self.0 else { return files::read(file).map(Arc::from) };
        once(&shared.files, file.to_owned(), || files::read(file).map(Arc::from))
    }

    /// The robot of a file, read by a function for this kind of use; anew where values of the file were replaced.
    pub fn robot(
        &self,
        file: &Path,
        is_overridden: bool,
        kind: Option<bool>,
        read: impl FnOnce() -> Result<Robot, InputError>,
    ) -> Result<Robot, InputError> {
        let Some(shared) = self.0.as_ref().filter(|_| !is_overridden) else { return read() };
        let robot = once(&shared.robots, (file.to_owned(), kind), || read().map(Arc::new))?;
        Ok(Robot::clone(&robot))
    }

    /// The tool path of a task file.
    pub fn task(&self, file: &Path, bytes: &[u8]) -> Result<Imported, InputError> {
        let Some(shared) = &self.0 else { return parse_csv(file, bytes) };
        let task = once(&shared.tasks, file.to_owned(), || parse_csv(file, bytes).map(Arc::new))?;
        Ok(Imported::clone(&task))
    }

    /// The triangles of a mesh file.
    pub(crate) fn mesh(&self, file: &Path, bytes: &[u8], unit: MeshUnit) -> Result<Arc<TriangleMesh>, InputError> {
        let read = || read_mesh(file, bytes, unit).map(Arc::new);
        let Some(shared) = &self.0 else { return read() };
        once(&shared.meshes, (file.to_owned(), unit), read)
    }

    /// What takes long to make of files, by a key that states all that it depends on: made once, however many threads
    /// ask for it at a time; the later ones wait for the first.
    ///
    /// # Errors
    /// Those of the function that makes it.
    pub fn made<T: Any + Send + Sync, E: Send>(
        &self,
        key: String,
        make: impl FnOnce() -> Result<T, E> + Send,
    ) -> Result<Arc<T>, E> {
        let Some(shared) = &self.0 else { return make().map(Arc::new) };
        let slot = locked(&shared.made).entry(key).or_default().clone();
        let mut slot = locked(&slot);
        if let Some(known) = slot.clone().and_then(|known| known.downcast().ok()) {
            return Ok(known);
        }
        let made = Arc::new(apart(make)?);
        *slot = Some(made.clone());
        Ok(made)
    }

    /// Offers a task under the name of a file that is not on the disk.
    pub fn offer(&self, file: &Path, bytes: Vec<u8>, task: Imported) {
        if let Some(shared) = &self.0 {
            locked(&shared.files).insert(file.to_owned(), bytes.into());
            locked(&shared.tasks).insert(file.to_owned(), Arc::new(task));
        }
    }
}

/// What is known under a key, or is made now. It may be made twice, by two threads, to the same value.
fn once<K: Hash + Eq, T: Clone, E>(
    map: &Mutex<HashMap<K, T>>,
    key: K,
    make: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    if let Some(known) = locked(map).get(&key) {
        return Ok(known.clone());
    }
    let made = make()?;
    Ok(locked(map).entry(key).or_insert(made).clone())
}

/// Does something on as many threads as the pool has, but on others. A thread of the pool that waits for its part of
/// the work takes up other work meanwhile, which may be what waits for this.
fn apart<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(rayon::current_num_threads()).build() else {
        return work();
    };
    // A thread of no pool does nothing else while it waits.
    std::thread::scope(|scope| match scope.spawn(|| pool.install(work)).join() {
        Ok(done) => done,
        Err(panic) => std::panic::resume_unwind(panic),
    })
}

/// What a mutex guards: nothing in it is ever half made.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn what_takes_long_is_made_once_for_a_key() {
        let count = AtomicUsize::new(0);
        let make = || Ok::<_, ()>(count.fetch_add(1, Ordering::Relaxed) + 1);
        let shared = Sources::shared();
        let known = [("a", 1), ("a", 1), ("b", 2), ("a", 1)];
        assert!(known.iter().all(|(key, made)| *shared.clone().made(key.to_string(), make).unwrap() == *made));
        // From the disk everything is made anew.
        assert_eq!(*Sources::disk().made("a".to_owned(), make).unwrap(), 3);
        // What could not be made is tried again.
        assert_eq!(shared.made("c".to_owned(), || Err::<usize, _>("no")), Err("no"));
        assert_eq!(*shared.made("c".to_owned(), make).unwrap(), 4);
    }

    /// Many cases on few threads, made in parallel themselves: none waits for itself.
    #[test]
    fn what_many_threads_ask_for_at_a_time_is_made_once() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let (shared, count) = (Sources::shared(), AtomicUsize::new(0));
        let make = || {
            count.fetch_add(1, Ordering::Relaxed);
            let part = |k: u64| {
                std::thread::sleep(std::time::Duration::from_millis(5));
                k
            };
            Ok::<u64, ()>((0..8).into_par_iter().map(part).sum())
        };
        let case = |case: u64| shared.made((case % 3).to_string(), make).map(|sum| *sum);
        let found: Vec<Result<u64, ()>> = pool.install(|| (0..24).into_par_iter().map(case).collect());
        assert_eq!((found, count.into_inner()), (vec![Ok(28); 24], 3));
    }
}
