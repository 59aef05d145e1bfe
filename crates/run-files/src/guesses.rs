//! Values of a file that are guesses, by their keys.

use std::collections::BTreeMap;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_numerics::message::Note;

/// More guessed keys of one table than this are counted in few words.
const NAMED: usize = 2;

/// What a result rests on where values of its file are guesses: the names are keys of the file, with the tables that
/// they are in (`stock.depth_mm`), or whole tables.
///
/// # Errors
/// [`InputError`] for a name that is no key which the file states, and for one that is there twice.
pub(crate) fn guesses(names: &[String], root: &Place<'_>) -> Result<Option<Note>, InputError> {
    let at = root.key("guesses");
    for (place, name) in names.iter().enumerate() {
        let is_key = !name.is_empty() && name.split('.').fold(root.clone(), |at, key| at.key(key)).is_given();
        if !is_key {
            let allowed = "a key that this file states, with its table, as \"stock.depth_mm\"";
            return Err(at.element(place + 1).error("is no key of this file", allowed));
        }
        if names[..place].contains(name) {
            return Err(at.element(place + 1).error("is there twice", "each key once"));
        }
    }
    Ok((!names.is_empty()).then(|| {
        let text = format!(
            "guesses: {}; replace each by the figure of your cell, and take its name out of `guesses`",
            names.join(", ")
        );
        Note::rests_on(format!("guesses: {}", few_words(names)), text)
    }))
}

/// The names, those of a table that has many of them counted.
fn few_words(names: &[String]) -> String {
    let table = |name: &str| name.split_once('.').map_or(String::new(), |(table, _)| table.to_owned());
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    names.iter().for_each(|name| *counts.entry(table(name)).or_default() += 1);
    let mut words: Vec<String> = Vec::new();
    for name in names {
        let of = table(name);
        let count = counts.get(&of).copied().unwrap_or_default();
        let word = if of.is_empty() || count <= NAMED { name.clone() } else { format!("{of} ({count} keys)") };
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, read_text};
    use stead_numerics::message::{Note, NoteGroup};

    #[test]
    fn guesses_are_keys_of_the_file_and_results_rest_on_them() {
        let with = |guesses: &str| format!("guesses = {guesses}\n{RUN}");
        let run = read_text(&with("['spindle', 'cell.x_mm', 'cell.y_mm', 'cell.z_mm']")).unwrap();
        let note = run.notes.iter().find(|note| note.group() == NoteGroup::RestsOn).unwrap();
        assert_eq!(Note::shorts(&run.notes, NoteGroup::RestsOn)[0], "guesses: spindle, cell (3 keys)");
        assert!(note.starts_with("guesses: spindle, cell.x_mm, cell.y_mm, cell.z_mm; replace each"), "{note}");
        assert!(read_text(&with("[]")).unwrap().notes.iter().all(|note| !note.contains("guess")));
        for (guesses, problem) in [
            ("['stock.depth_mm']", "is no key of this file"),
            ("['cell.width_mm']", "is no key of this file"),
            ("['']", "is blank"),
            ("['spindle', 'cell', 'spindle']", "is there twice"),
        ] {
            let error = read_text(&with(guesses)).unwrap_err().to_string();
            assert!(error.contains(problem) && error.contains("guesses"), "{error}");
        }
    }
}
