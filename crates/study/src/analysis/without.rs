//! Cases without a placement: how many, why, and the values of axes that they share.

use super::layouts::Layouts;
use crate::cases::{CaseStatus, Table};
use std::collections::HashMap;

/// A value of an axis, or a pair of values of two, that no case with a placement has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LostLevel {
    /// The axes, one or two, each with the value.
    pub values: Vec<[String; 2]>,
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
    /// Reasons with the number of their cases and the first of them, the most frequent first. Reasons that differ in
    /// numbers alone are one, in the words of its first case.
    pub reasons: Vec<(String, usize, String)>,
    /// Values of axes with no placement at all, and pairs of values of which neither is alone to blame.
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

/// Values without any placement, and then pairs that hold none of these. Of an axis of many numbers each value is
/// nearly alone and says nothing: only what two cases or more share is named.
fn lost(cases: &Layouts) -> Vec<LostLevel> {
    let varied = cases.varied();
    let is_placed: Vec<bool> =
        cases.all.iter().map(|layout| cases.status(layout)[0] == CaseStatus::Placed.word()).collect();
    let of = |axes: &[usize]| {
        let mut levels: Vec<(Vec<[String; 2]>, usize, bool)> = Vec::new();
        let mut places: HashMap<Vec<String>, usize> = HashMap::new();
        for (layout, is_placed) in cases.all.iter().zip(&is_placed) {
            let values: Vec<String> = axes.iter().map(|axis| layout.row[*axis].written()).collect();
            let place = *places.entry(values.clone()).or_insert(levels.len());
            if place == levels.len() {
                let names = axes.iter().map(|axis| cases.columns[*axis].name.clone());
                levels.push((names.zip(values).map(|(name, value)| [name, value]).collect(), 0, false));
            }
            let (_, count, any) = &mut levels[place];
            (*count, *any) = (*count + 1, *any || *is_placed);
        }
        let lost = levels.into_iter().filter(|(_, count, any)| *count > 1 && !any);
        lost.map(|(values, cases, _)| LostLevel { values, cases }).collect::<Vec<_>>()
    };
    let mut lost: Vec<LostLevel> = varied.iter().flat_map(|axis| of(&[*axis])).collect();
    let alone: Vec<[String; 2]> = lost.iter().flat_map(|lost| lost.values.clone()).collect();
    let pairs = varied.iter().enumerate().flat_map(|(k, b)| varied[..k].iter().map(|a| [*a, *b]));
    for pair in pairs {
        lost.extend(of(&pair).into_iter().filter(|lost| !lost.values.iter().any(|value| alone.contains(value))));
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
    use crate::cases::TableCell;

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
            table.rows[row][reason] = TableCell::Text(words.to_owned());
        }
        let found = failures(&table);
        assert_eq!((found.cases, found.infeasible, found.failed), (6, 3, 0));
        let reasons = [("joint 2 at -12.5 deg", 2, "2"), ("out of reach", 1, "6")];
        assert_eq!(found.reasons, reasons.map(|(reason, count, first)| (reason.to_owned(), count, first.to_owned())));
        assert_eq!(found.lost, [LostLevel { values: vec![["robot", "b"].map(str::to_owned)], cases: 2 }]);
    }

    #[test]
    fn a_pair_is_named_where_neither_value_is_alone_to_blame() {
        let mut cases = Vec::new();
        for (robot, height) in [("a", "1"), ("a", "2"), ("b", "1"), ("b", "2")] {
            for side in ["l", "r"] {
                let is_placed = (robot, height) != ("b", "2");
                cases.push((vec![robot, height, side], is_placed.then(|| vec![1.0])));
            }
        }
        let found = failures(&table(&["robot", "height", "side"], &["figure_mm"], &cases));
        let values = [["robot", "b"], ["height", "2"]].map(|value| value.map(str::to_owned)).to_vec();
        assert_eq!(found.lost, [LostLevel { values, cases: 2 }]);
    }
}
