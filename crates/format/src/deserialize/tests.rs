use crate::scalars::{Whole, Word, words};
use crate::shapes::{Array, Interval, List, Matrix, Vector};
use crate::testing::{assert_parts, read_field as read, read_table};
use crate::units::{Mm, Number, Positive};
use serde::Deserialize;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Left,
}

words!(Side: "left" => Side::Left);

/// A table with two keys.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    v: Option<Number>,
    w: Option<Number>,
}

fn number(text: &str) -> Result<f64, String> {
    read::<Number>(text).map(|number| number.written())
}

#[test]
fn numbers_are_taken_as_written() {
    assert_eq!(number("v = 3"), Ok(3.0));
    assert_eq!(number("v = -1_000.5e-1"), Ok(-100.05));
    assert_eq!(number("v = 0x10"), Ok(16.0));
    assert_eq!(
        read::<Whole<0, { u64::MAX }>>("v = 9223372036854775807").map(|whole| whole.get()),
        Ok(9223372036854775807)
    );
    assert_eq!(read("v = true"), Ok(true));
    assert_eq!(read::<Option<Number>>("w = 1"), Ok(None));
}

#[test]
fn each_kind_refuses_what_it_is_not() {
    for bad in ["'1'", "nan", "-inf", "1e999", "true", "[1]", "99999999999999999999", "2026-01-01"] {
        let found = format!("found {bad}");
        assert_parts(number(&format!("v = {bad}")), "3: a.v", &[&found, "a finite number"]);
    }
    assert_parts(read::<Mm<Positive>>("v = 0"), "3: a.v", &["out of range", "found 0;", "above 0"]);
    assert_parts(read::<Whole<0, 9>>("v = 3.0"), "3: a.v", &["whole", "found 3.0", "from 0 to 9"]);
    assert_parts(read::<Whole<0, 9>>("v = -3"), "3: a.v", &["out of range", "found -3", "from 0 to 9"]);
    assert_parts(read::<String>("v = 1"), "3: a.v", &["not a text", "found 1;"]);
    assert_parts(read::<String>("v = ' '"), "3: a.v", &["blank", "found ' '"]);
    assert_parts(read::<bool>("v = 0"), "3: a.v", &["found 0;", "true or false"]);
    assert_parts(read::<Word<Side>>("v = 'lft'"), "3: a.v", &["unknown", "found 'lft'", "\"left\""]);
    assert_parts(read::<Word<Side>>("v = 7"), "3: a.v", &["not a text", "found 7", "\"left\""]);
    assert_parts(read::<Table>("v = 2"), "3: a.v", &["not a table", "found 2", "[a.v]"]);
}

#[test]
fn a_missing_key_is_located_at_its_table() {
    assert_parts(number("w = 1"), "2: a.v", &["is missing", "a finite number"]);
}

#[test]
fn the_first_unknown_key_is_refused_with_the_nearest() {
    let read = read_table::<Table>("v = 1\nww = 2\na = 3");
    assert_parts(read, "4: a.ww", &["nearest known one: w", "found 2", "v, w"]);
}

#[test]
fn arrays_are_taken_as_written() {
    assert_eq!(read::<Interval<Number>>("v = [1, 1]").map(Interval::si), Ok([1.0, 1.0]));
    let matrix = read::<Matrix>("v = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]").map(|matrix| matrix.matrix());
    assert_eq!(matrix.map(|m| m[(0, 1)]), Ok(-1.0));
    assert_eq!(read::<Vec<Table>>("v = [{}, {}]").map(|rows| rows.len()), Ok(2));
}

#[test]
fn each_kind_of_array_refuses_what_it_is_not() {
    let interval = read::<Interval<Number>>;
    assert_parts(interval("v = [2, 1]"), "3: a.v", &["lower end above", "found [2, 1]", "min not"]);
    assert_parts(interval("v = [2]"), "3: a.v", &["1 elements and not 2", "found [2]"]);
    assert_parts(interval("v = 2"), "3: a.v", &["not an array", "found 2"]);
    assert_parts(read::<Vector<Number>>("v = [1,\n 2,\n nan]"), "5: a.v[3]", &["finite", "found nan"]);
    assert_parts(read::<Matrix>("v = [[1, 2, 3], [4, 5], [6, 7, 8]]"), "3: a.v[2]", &["found [4, 5]"]);
    assert_parts(read::<Vec<Table>>("v = [{}, 2]"), "3: a.v[2]", &["not a table", "found 2"]);
    assert_parts(read::<Vec<Table>>("v = {}"), "3: a.v", &["not an array of tables", "found {}"]);
    let positive = read::<List<Number<Positive>>>;
    assert_parts(positive("v = []"), "3: a.v", &["is empty", "found []", "above 0"]);
    assert_parts(positive("v = 1"), "3: a.v", &["not an array", "found 1;", "above 0"]);
    assert_parts(positive("v = [1, 0]"), "3: a.v[2]", &["out of range", "found 0;", "above 0"]);
    assert_parts(read::<Array<Number, 2>>("v = [1, 2, 3]"), "3: a.v", &["3 elements and not 2", "two finite numbers"]);
}
