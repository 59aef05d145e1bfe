//! A place in a TOML file where a value is, or would be: what errors are located by.

use crate::quantity::Expects;
use crate::toml_file::TomlFile;
use stead_disk::input::InputError;
use stead_model::plausibility;
use toml::Spanned;
use toml::de::DeValue;

/// A key of a table or an element of an array, with its value if there is one.
#[derive(Debug, Clone)]
pub struct Place<'a> {
    pub(crate) file: &'a TomlFile,
    /// `cell.x_mm`, `joints[3].min_deg`; nothing for the table that the whole file is.
    pub(crate) path: String,
    /// Where the table or array begins that the value is in, or would be in.
    pub(crate) parent: usize,
    /// What stands there; nothing where the key is left out.
    pub value: Option<&'a Spanned<DeValue<'a>>>,
}

impl<'a> Place<'a> {
    pub(crate) fn root(file: &'a TomlFile, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self { file, path: String::new(), parent: 0, value: Some(value) }
    }

    /// A key of the table that is here.
    pub fn key(&self, key: &str) -> Self {
        let value = self.value.and_then(|value| value.get_ref().as_table()).and_then(|table| table.get(key));
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Self { file: self.file, path, parent: self.byte(), value }
    }

    /// An element of the array that is here, counted from 1.
    pub fn element(&self, number: usize) -> Self {
        let array = self.value.and_then(|value| value.get_ref().as_array());
        let value = array.and_then(|array| array.get(number.wrapping_sub(1)));
        Self { file: self.file, path: format!("{}[{number}]", self.path), parent: self.byte(), value }
    }

    /// Whether the file has a value here.
    pub fn is_given(&self) -> bool {
        self.value.is_some()
    }

    /// Line of the value, or of the table that lacks it, from 1.
    pub fn line(&self) -> usize {
        self.file.line(self.byte())
    }

    /// Where in the text the value begins, or the table that lacks it.
    fn byte(&self) -> usize {
        match self.value {
            Some(_) if self.path.is_empty() => 0,
            Some(value) => value.span().start,
            None => self.parent,
        }
    }

    /// The value as written, on one line; nothing where there is none.
    pub fn written(&self) -> String {
        self.value.map(|value| self.file.quote(value.span())).unwrap_or_default()
    }

    /// An error here, with the value found.
    pub fn error(&self, problem: impl Into<String>, allowed: impl Into<String>) -> InputError {
        let error = self.file.locate(InputError::new(self.file.file(), problem).in_field(&self.path), self.byte());
        error.found_if(self.value.map(|_| self.written())).allowed(allowed)
    }

    /// An error about a value that is not here.
    pub fn missing(&self, allowed: impl Into<String>) -> InputError {
        self.error("is missing", allowed)
    }

    /// The value of a key of the table that is here, which the type of the table leaves optional but its use does not.
    ///
    /// # Errors
    /// [`InputError`] at the table when there is none.
    pub fn require<T: Expects>(&self, key: &str, value: Option<T>) -> Result<T, InputError> {
        value.ok_or_else(|| self.key(key).missing(T::expected()))
    }

    /// Numbers here, and in what is here, whose keys say that they are in degrees and that look like radians: in
    /// sentences, with `prefix` before their keys.
    pub fn radians(&self, prefix: &str) -> Vec<String> {
        let mut notes = Vec::new();
        self.find_radians(prefix, false, &mut notes);
        notes
    }

    fn find_radians(&self, prefix: &str, is_angle: bool, notes: &mut Vec<String>) {
        let Some(value) = self.value.map(Spanned::get_ref) else { return };
        if let Some(array) = value.as_array() {
            (1..=array.len()).for_each(|number| self.element(number).find_radians(prefix, is_angle, notes));
        } else if let Some(table) = value.as_table() {
            for (key, _) in table {
                let name: &str = key.get_ref();
                self.key(name).find_radians(prefix, name.ends_with("_deg"), notes);
            }
        } else if let Some(degrees) = number(value).filter(|_| is_angle) {
            notes.extend(plausibility::angle(&format!("{prefix}{}", self.path), degrees));
        }
    }

    /// An error about a number that is here, but not among those that the rest of the file allows.
    pub fn out_of_range(&self, allowed: impl Into<String>) -> InputError {
        self.error("is out of range", allowed)
    }
}

/// The finite number that a value holds, whole or not.
pub(crate) fn number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Float(float) => float.as_str().parse().ok()?,
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok()? as f64,
        _ => return None,
    };
    f64::is_finite(number).then_some(number)
}

/// The value of an optional key of a table that is needed all the same: `required!(place of the table, table.key)`.
#[macro_export]
macro_rules! required {
    ($place:expr, $table:ident.$key:ident) => {
        $place.require(stringify!($key), $table.$key)
    };
}
pub use crate::required;

#[cfg(test)]
mod tests {
    use crate::toml_file::TomlFile;

    #[test]
    fn angles_that_look_like_radians_are_found_wherever_they_stand() {
        let text = "a_deg = 1.5708\nb_mm = 3.14\nc_deg = [0, 90]\nd_deg_per_mm = 3.14\n[cell]\nyaw_deg = [-3.14, 3]\n\
                    [[shape]]\nabc_deg = [0, 180, 6.283]\n[joints]\nwidth_deg = [[3.1416]]\n";
        let file = TomlFile::new("a.toml".as_ref(), text.as_bytes().to_vec()).unwrap();
        let document = file.parse().unwrap();
        let mut notes = document.root().radians("robot.");
        notes.sort();
        let starts = [
            "robot.a_deg is 1.5708, which is pi/2: ",
            "robot.cell.yaw_deg[1] is -3.14, which is -pi: ",
            "robot.joints.width_deg[1][1] is 3.1416",
            "robot.shape[1].abc_deg[3] is 6.283, which is 2 pi: ",
        ];
        assert_eq!(notes.len(), starts.len(), "{notes:?}");
        assert!(notes.iter().zip(starts).all(|(note, start)| note.starts_with(start)), "{notes:?}");
    }
}
