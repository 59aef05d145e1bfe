//! Cases without a placement: how many, why, and the values of axes that they share.

use super::layouts::{Layouts, text};
use crate::cases::{CaseStatus, Table};

/// A value of an axis that no case with a placement has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LostLevel {
    /// The axis.
    pub axis: String,
    /// The value.
    pub level: String,
    /// How many cases have it.
    pub cases: usize,
}

/// Cases without a placement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failures {
    /// All cases of the study.
    pub cases: usize,
    /// Those where no placement satisfies the constraints.
    pub infeasible: usize,
    /// Those whose job failed.
    pub failed: usize,
    /// Reasons with the number of their cases and the first of them, the most frequent first. Reasons that differ in numbers alone are
    /// one, in the words of its first case.
    pub reasons: Vec<(String, usize, String)>,
    /// Values of axes with no placement at all.
    pub lost: Vec<LostLevel>,
}

impl Failures {
    /// All cases without a placement.
    pub fn count(&self) -> usize {
        self.infeasible + self.failed
    }
}

/// The cases without a placement of a table of results.
pub fn failures(table: &Table) -> Failures {
    let cases = Layouts::cases(table);
    let mut found =
        Failures { cases: cases.all.len(), infeasible: 0, failed: 0, reasons: Vec::new(), lost: Vec::new() };
    let mut kinds: Vec<String> = Vec::new();
    for layout in &cases.all {
        let [status, reason] = cases.status(layout);
        match status.as_str() {
            word if word == CaseStatus::Placed.word() => continue,
            word if word == CaseStatus::Infeasible.word() => found.infeasible += 1,
            _ => found.failed += 1,
        }
        let kind = without_numbers(&reason);
        let first = layout.cases.first().map_or_else(String::new, ToString::to_string);
        match kinds.iter().position(|known| *known == kind) {
            Some(place) => found.reasons[place].1 += 1,
            None => {
                kinds.push(kind);
                found.reasons.push((reason, 1, first));
            }
        }
    }
    found.reasons.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
    if found.count() < found.cases {
        found.lost = lost(&cases);
    }
    found
}

fn lost(cases: &Layouts) -> Vec<LostLevel> {
    let mut lost = Vec::new();
    for axis in cases.varied() {
        let mut levels: Vec<(String, usize, bool)> = Vec::new();
        for layout in &cases.all {
            let level = text(&layout.row[axis]);
            let is_placed = cases.status(layout)[0] == CaseStatus::Placed.word();
            match levels.iter_mut().find(|(known, ..)| *known == level) {
                Some((_, count, placed)) => (*count, *placed) = (*count + 1, *placed || is_placed),
                None => levels.push((level, 1, is_placed)),
            }
        }
        // Of an axis of many numbers each value is alone, and says nothing.
        let alone = levels.iter().filter(|(_, count, _)| *count == 1).count();
        if 2 * alone > levels.len() && levels.len() > 4 {
            continue;
        }
        let axis = &cases.columns[axis].name;
        let of = |(level, cases, _)| LostLevel { axis: axis.clone(), level, cases };
        lost.extend(levels.into_iter().filter(|(.., placed)| !placed).map(of));
    }
    lost
}

/// A reason with one sign in place of each number.
fn without_numbers(reason: &str) -> String {
    let mut kind = String::with_capacity(reason.len());
    let mut letters = reason.chars().peekable();
    while let Some(letter) = letters.next() {
        let begins = letter.is_ascii_digit() || (letter == '-' && letters.peek().is_some_and(char::is_ascii_digit));
        if !begins {
            kind.push(letter);
            continue;
        }
        while letters.next_if(|next| next.is_ascii_digit() || matches!(next, '.' | '%')).is_some() {}
        kind.push('#');
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::super::testing::table;
    use super::*;
    use crate::cases::Cell;

    #[test]
    fn reasons_are_counted_and_values_without_any_placement_are_named() {
        let case = |robot, height, value: Option<f64>| (vec![robot, height], value.map(|value| vec![value]));
        let cases = [
            case("a", "1", Some(1.0)),
            case("b", "1", None),
            case("a", "2", Some(2.0)),
            case("b", "2", None),
            case("c", "1", Some(1.0)),
            case("c", "2", None),
        ];
        let mut table = table(&["robot", "height"], &["figure_mm"], &cases);
        let reason = table.column("reason").unwrap();
        for (row, words) in [(1, "joint 2 at -12.5 deg"), (3, "joint 2 at 7 deg"), (5, "out of reach")] {
            table.rows[row][reason] = Cell::Text(words.to_owned());
        }
        let found = failures(&table);
        assert_eq!((found.cases, found.infeasible, found.failed), (6, 3, 0));
        let reasons = [("joint 2 at -12.5 deg", 2, "2"), ("out of reach", 1, "6")];
        assert_eq!(found.reasons, reasons.map(|(reason, count, first)| (reason.to_owned(), count, first.to_owned())));
        assert_eq!(found.lost, [LostLevel { axis: "robot".to_owned(), level: "b".to_owned(), cases: 2 }]);
    }
}
