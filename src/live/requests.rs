//! What pages ask, read and checked: a body that says something else is refused with the field, what was found and what
//! is allowed.

use super::place::{FARTHEST_MM, Place, shown};
use serde_json::{Map, Value};
use stead_disk::quote::{GARBLED, garbles};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::AxisPositions;

/// Why a request is not answered: the field, what was found there and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct RequestError {
    /// The field of the body, or `body` where it cannot be read at all.
    pub field: String,
    message: String,
}

impl RequestError {
    pub(super) fn new(field: impl Into<String>, problem: impl Into<String>, allowed: impl Into<String>) -> Self {
        let (field, problem, allowed) = (field.into(), problem.into(), allowed.into());
        Self { message: format!("{field}: {problem}; allowed: {allowed}"), field }
    }

    /// One that says itself what is allowed, as those of files do.
    pub(super) fn of_file(field: &str, error: impl std::fmt::Display) -> Self {
        Self { field: field.to_owned(), message: error.to_string() }
    }
}

/// Turns of more than this are a slip. deg
const MOST_DEG: f64 = 3.6e5;
/// Characters of a name.
const LONGEST: usize = 200;

/// The body of a request.
#[derive(Debug)]
pub(super) struct Body(Map<String, Value>);

impl Body {
    /// Reads a JSON object.
    ///
    /// # Errors
    /// [`RequestError`] for anything else, with the field that the text breaks off at.
    pub fn read(bytes: &[u8]) -> Result<Self, RequestError> {
        match serde_json::from_slice(bytes) {
            Ok(Value::Object(entries)) => Ok(Self(entries)),
            Ok(_) => Err(RequestError::new("body", "is no JSON object", "an object with the fields of the request")),
            Err(cause) => {
                let field = last_field(bytes, cause.line(), cause.column());
                let problem = format!("is not readable as JSON: {cause}");
                Err(RequestError::new(field, problem, "JSON, numbers being finite"))
            }
        }
    }

    fn value(&self, field: &str) -> &Value {
        self.0.get(field).unwrap_or(&Value::Null)
    }

    /// A finite number of at most this size.
    pub fn number(&self, field: &str, most: f64) -> Result<f64, RequestError> {
        let value = self.value(field);
        let found = value.as_f64().filter(|found| found.abs() <= most);
        found.ok_or_else(|| {
            RequestError::new(
                field,
                format!("is no such number, found {value}"),
                format!("a number from -{most} to {most}"),
            )
        })
    }

    /// A text that is not empty and that reads as it is.
    pub fn text(&self, field: &str) -> Result<&str, RequestError> {
        let value = self.value(field);
        let text = value.as_str().filter(|text| !text.is_empty() && text.len() <= LONGEST).ok_or_else(|| {
            RequestError::new(field, format!("is no such text, found {value}"), format!("1 to {LONGEST} characters"))
        })?;
        if text.contains(garbles) {
            return Err(RequestError::new(field, GARBLED, "letters, digits, signs and blanks"));
        }
        Ok(text)
    }

    /// A whole number that is not negative.
    pub fn whole(&self, field: &str) -> Result<usize, RequestError> {
        let value = self.value(field);
        let found = value.as_u64().and_then(|found| usize::try_from(found).ok());
        found.ok_or_else(|| RequestError::new(field, format!("is no such number, found {value}"), "0, 1, 2 and so on"))
    }

    /// Texts, where there are any.
    pub fn texts(&self, field: &str) -> Result<Vec<String>, RequestError> {
        let value = self.value(field);
        let all = value.as_array().and_then(|all| all.iter().map(|one| one.as_str().map(str::to_owned)).collect());
        all.ok_or_else(|| {
            RequestError::new(field, format!("is no list of texts, found {value}"), "[\"PATH=VALUE\", ..]")
        })
    }

    /// Whether a switch is on; it is off where it is left out.
    pub fn is_on(&self, field: &str) -> Result<bool, RequestError> {
        match self.value(field) {
            Value::Null => Ok(false),
            Value::Bool(is_on) => Ok(*is_on),
            value => Err(RequestError::new(field, format!("is no switch, found {value}"), "true or false")),
        }
    }

    /// The page that asks.
    pub fn page(&self) -> Result<String, RequestError> {
        self.text("page").map(str::to_owned)
    }

    /// A placement with its setup: what is not said of the setup is as the problem has it.
    pub fn place(&self, problem: &Problem) -> Result<Place, RequestError> {
        let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|field| self.number(field, FARTHEST_MM));
        let placement = Placement::from_mm_deg([x?, y?, z?], self.number("yaw_deg", MOST_DEG)?);
        let mut entry = Value::Object(self.0.clone());
        if self.value("orientation").is_null()
            && let Some(orientation) = problem.orientation()
        {
            entry["orientation"] = orientation.name.clone().into();
        }
        if self.value("external_axes").is_null() {
            let resting = Place { placement, setup: problem.setup.clone() };
            entry["external_axes"] = resting.entry(problem)["external_axes"].clone();
        }
        let setup = stead_runs::setup_in(problem, &entry).map_err(|field| {
            let names: Vec<&str> = problem.orientations.iter().map(|known| known.name.as_str()).collect();
            let allowed = match field {
                "orientation" => names.join(", "),
                _ => "for_each, `path`, `segment` or `point`, and so many rows of positions of all axes".to_owned(),
            };
            RequestError::new(field, format!("is none of the run's, found {}", self.value(field)), allowed)
        })?;
        within_ranges(problem, &setup.positions)?;
        Ok(Place { placement, setup })
    }
}

/// Refuses positions of external axes beyond their ranges.
fn within_ranges(problem: &Problem, positions: &AxisPositions) -> Result<(), RequestError> {
    let rows = match positions {
        AxisPositions::Same(row) => std::slice::from_ref(row),
        AxisPositions::PerSegment(rows) | AxisPositions::PerPoint(rows) => rows,
    };
    for row in rows {
        for (at, axis) in row.iter().zip(&problem.external_axes) {
            let [found, least, most] = [*at, axis.min, axis.max].map(|at| shown(axis, at));
            // What was rounded in a document may be a little beyond.
            if !(least - 1e-6..=most + 1e-6).contains(&found) {
                let problem = format!("{} is out of range, found {found}", axis.name);
                return Err(RequestError::new("external_axes", problem, format!("{least} to {most}")));
            }
        }
    }
    Ok(())
}

/// The last field that begins before a place of a text, or `body`.
fn last_field(bytes: &[u8], line: usize, column: usize) -> String {
    let text = String::from_utf8_lossy(bytes);
    let before: usize = text.lines().take(line.saturating_sub(1)).map(|line| line.len() + 1).sum();
    let end = (before + column).min(text.len());
    let read = text.char_indices().take_while(|(at, _)| *at < end).map(|(_, character)| character).collect::<String>();
    let named = read.rsplit_once(':').and_then(|(before, _)| before.trim_end().strip_suffix('"'));
    let name = named.and_then(|before| before.rsplit_once('"')).map(|(_, name)| name.to_owned());
    name.filter(|name| !name.is_empty() && name.len() <= LONGEST).unwrap_or_else(|| "body".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Run;

    fn refused(text: &str) -> String {
        let run = Run::read("configs/caro-2013.toml").unwrap();
        let read = Body::read(text.as_bytes()).and_then(|body| body.place(run.problem()));
        read.unwrap_err().to_string()
    }

    #[test]
    fn a_body_that_is_no_place_is_refused_with_its_field() {
        let place = |y: &str| format!("{{\"page\":\"a\",\"x_mm\":1,\"y_mm\":{y},\"z_mm\":3,\"yaw_deg\":4}}");
        for (text, parts) in [
            ("", &["body: is not readable as JSON", "; allowed: JSON"][..]),
            ("[1]", &["body: is no JSON object"]),
            (&place("NaN"), &["y_mm: is not readable as JSON", "numbers being finite"]),
            (&place("1e999"), &["y_mm: is not readable as JSON", "out of range"]),
            (&place("-Infinity"), &["y_mm: is not readable as JSON"]),
            (&place("null"), &["y_mm: is no such number, found null", "; allowed: a number from -1000000 to 1000000"]),
            (&place("\"2\""), &["y_mm: is no such number, found \"2\""]),
            (&place("1e9"), &["y_mm: is no such number, found 1000000000.0"]),
            ("{\"x_mm\":1,\"y_mm\":2,\"z_mm\":3}", &["yaw_deg: is no such number, found null"]),
        ] {
            let message = refused(text);
            assert!(parts.iter().all(|part| message.contains(part)), "{text}: {message}");
            assert!(!message.contains('\n'));
        }
        let run = Run::read("configs/caro-2013.toml").unwrap();
        let found = Body::read(place("-1700.5").as_bytes()).unwrap().place(run.problem()).unwrap();
        assert_eq!(found.placement.y, -1.7005);
    }

    #[test]
    fn setups_are_those_of_the_run() {
        let run = Run::read("configs/tilting-table.toml").unwrap();
        let problem = run.problem();
        let place = |more: &str| {
            let text = format!("{{\"x_mm\":1700,\"y_mm\":0,\"z_mm\":700,\"yaw_deg\":0{more}}}");
            Body::read(text.as_bytes()).unwrap().place(problem)
        };
        let plain = place("").unwrap();
        assert_eq!(plain.setup, problem.setup);
        let entry = plain.entry(problem);
        assert_eq!(Place::of_entry(problem, &entry), Some(plain));
        let unknown = place(",\"orientation\":\"nowhere\"").unwrap_err().to_string();
        assert!(unknown.contains("orientation: is none of the run's, found \"nowhere\"; allowed: flat"), "{unknown}");
        let rows = |row: &str| place(&format!(",\"external_axes\":{{\"for_each\":\"path\",\"positions\":[{row}]}}"));
        let far = rows("[9999]").unwrap_err().to_string();
        assert!(far.contains("is out of range, found 9999") || far.contains("external_axes"), "{far}");
        assert!(rows("[null]").is_err() && rows("[1,2,3,4]").is_err());
    }
}
