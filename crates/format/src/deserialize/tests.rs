//! Values of each kind, as the key `v` on line 3 of a table `[a]` on line 2.

use crate::quantity::Quantity;
use crate::scalars::{Whole, Word, words};
use crate::shapes::{Interval, List, Matrix, Span, Vector};
use crate::testing::assert_parts;
use crate::toml_file::TomlFile;
use crate::units::{Number, Positive};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Root<T> {
    a: Table<T>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table<T> {
    v: T,
    w: Option<Number>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Empty {}

words!(bool: "left" => true, "right" => false);

fn file(value: &str) -> TomlFile {
    TomlFile::new(Path::new("f.toml"), format!("# first\n[a]\n{value}\n").into_bytes()).unwrap()
}

fn read<T: DeserializeOwned>(value: &str) -> Result<T, String> {
    let file = file(value);
    let document = file.parse().unwrap();
    document.read::<Root<T>>().map(|root| root.a.v).map_err(|error| error.to_string())
}

#[test]
fn numbers_are_taken_as_written() {
    let number = |text: &str| read::<Number>(text).map(Quantity::written);
    assert_eq!(number("v = 3"), Ok(3.0));
    assert_eq!(number("v = -1_000.5e-1"), Ok(-100.05));
    assert_eq!(number("v = 0x10"), Ok(16.0));
    assert_eq!(read::<Whole<0, { u64::MAX }>>("v = 9223372036854775807").map(Whole::get), Ok(9223372036854775807));
    assert_eq!(read::<bool>("v = true"), Ok(true));
    assert_eq!(read::<Word<bool>>("v = 'right'"), Ok(Word::from(false)));
    assert_eq!(read::<Option<Number>>("w = 1"), Ok(None));
    let file = file("v = 1\nw = 2");
    let document = file.parse().unwrap();
    let w = document.read::<Root<Number>>().unwrap().a.w;
    assert_eq!((w.map(Quantity::written), document.at("a.w").line()), (Some(2.0), 4));
}

#[test]
fn each_kind_refuses_what_it_is_not() {
    for bad in ["'1'", "nan", "-inf", "1e999", "true", "[1]", "99999999999999999999", "2026-01-01"] {
        let found = format!("found {bad}");
        assert_parts(read::<Number>(&format!("v = {bad}")), "3: a.v", &[&found, "a finite number"]);
    }
    assert_parts(read::<Number<Positive>>("v = 0"), "3: a.v", &["out of range", "found 0;", "above 0"]);
    assert_parts(read::<Whole<0, 9>>("v = 3.0"), "3: a.v", &["whole", "found 3.0", "from 0 to 9"]);
    assert_parts(read::<Whole<0, 9>>("v = -3"), "3: a.v", &["out of range", "found -3", "from 0 to 9"]);
    assert_parts(read::<String>("v = 1"), "3: a.v", &["not a text", "found 1;"]);
    assert_parts(read::<String>("v = ' '"), "3: a.v", &["blank", "found ' '"]);
    assert_parts(read::<bool>("v = 0"), "3: a.v", &["found 0;", "true or false"]);
    assert_parts(read::<Word<bool>>("v = 'lft'"), "3: a.v", &["unknown", "found 'lft'", "\"left\""]);
    assert_parts(read::<Word<bool>>("v = 7"), "3: a.v", &["not a text", "found 7", "\"left\""]);
    assert_parts(read::<Empty>("v = 2"), "3: a.v", &["not a table", "found 2", "[a.v]"]);
}

#[test]
fn a_missing_key_is_located_at_its_table() {
    assert_parts(read::<Number>("w = 1"), "2: a.v", &["is missing", "a finite number"]);
    assert_parts(read::<Interval<Number>>("w = 1"), "2: a.v", &["is missing", "[min, max]"]);
    assert_parts(read::<Word<bool>>("w = 1"), "2: a.v", &["is missing", "\"left\" or \"right\""]);
    assert_parts(read::<Empty>("w = 1"), "2: a.v", &["is missing", "[a.v]"]);
    assert_parts(read::<Vec<Empty>>("w = 1"), "2: a.v", &["is missing", "[[a.v]]"]);
}

#[test]
fn the_first_unknown_key_is_refused_with_the_nearest() {
    let text = "v = 1\nww = 2\na = 3";
    assert_parts(read::<Number>(text), "4: a.ww", &["nearest known one: w", "found 2", "v, w"]);
}

#[test]
fn a_named_file_that_is_not_there_is_located_at_the_name() {
    let file = file("v = 'nowhere/x.csv'");
    let result = file.parse().unwrap().at("a.v").named_file().map_err(|error| error.to_string());
    assert_parts(result, "3: a.v", &["nowhere/x.csv", "found 'nowhere/x.csv'", "cannot be read"]);
}

#[test]
fn arrays_are_taken_as_written() {
    assert_eq!(read::<Interval<Number>>("v = [1, 1]").map(Interval::si), Ok([1.0, 1.0]));
    assert_eq!(read::<Matrix>("v = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]").map(|m| m.matrix()[(0, 1)]), Ok(-1.0));
    assert_eq!(read::<Vec<Empty>>("v = [{}, {}]").map(|rows| rows.len()), Ok(2));
}

#[test]
fn each_array_refuses_what_it_is_not() {
    let pair = |text: &str| read::<Interval<Number>>(text);
    assert_parts(pair("v = [2, 1]"), "3: a.v", &["lower end above", "found [2, 1]", "min not"]);
    assert_parts(pair("v = [2]"), "3: a.v", &["1 elements and not 2", "found [2]"]);
    assert_parts(pair("v = 2"), "3: a.v", &["not an array", "found 2"]);
    assert_parts(read::<Span<Number>>("v = [1, 1]"), "3: a.v", &["no width", "found [1, 1]", "the first below"]);
    assert_parts(read::<Vector<Number>>("v = [1,\n 2,\n nan]"), "5: a.v[3]", &["finite", "found nan", "[x, y, z]"]);
    assert_parts(read::<Matrix>("v = [[1, 2, 3], [4, 5], [6, 7, 8]]"), "3: a.v[2]", &["found [4, 5]", "three rows"]);
    assert_parts(read::<Vec<Empty>>("v = [{}, 2]"), "3: a.v[2]", &["not a table", "found 2"]);
    assert_parts(read::<Vec<Empty>>("v = {}"), "3: a.v", &["not an array of tables", "found {}"]);
    let positive = |text: &str| read::<List<Number<Positive>>>(text);
    assert_parts(positive("v = []"), "3: a.v", &["is empty", "found []", "above 0"]);
    assert_parts(positive("v = 1"), "3: a.v", &["not an array", "found 1;", "above 0"]);
    assert_parts(positive("v = [1, 0]"), "3: a.v[2]", &["out of range", "found 0;", "above 0"]);
}
