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
    /// What was made of files, by all that it depends on.
    made: Known<String, dyn Any + Send + Sync>,
}

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

    /// What takes long to make of files, by a key that states all that it depends on: made once.
    ///
    /// # Errors
    /// Those of the function that makes it.
    pub fn made<T: Any + Send + Sync, E>(&self, key: String, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let Some(shared) = &self.0 else { return make().map(Arc::new) };
        if let Some(known) = locked(&shared.made).get(&key).cloned().and_then(|known| known.downcast().ok()) {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        locked(&shared.made).insert(key, made.clone());
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

/// What a mutex guards: nothing in it is ever half made.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_long_is_made_once_for_a_key() {
        let count = std::cell::Cell::new(0);
        let make = || {
            count.set(count.get() + 1);
            Ok::<_, ()>(count.get())
        };
        let shared = Sources::shared();
        let known = [("a", 1), ("a", 1), ("b", 2), ("a", 1)];
        assert!(known.iter().all(|(key, made)| *shared.clone().made(key.to_string(), make).unwrap() == *made));
        // From the disk everything is made anew.
        assert_eq!(*Sources::disk().made("a".to_owned(), make).unwrap(), 3);
    }
}
