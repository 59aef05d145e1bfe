//! Fields that hold several values: vectors, intervals, matrices, rows of tables.

use super::reader::{Field, Table};
use crate::input::InputError;
use nalgebra::{Matrix3, Vector3};
use toml::Spanned;
use toml::de::DeValue;

impl<'a> Field<'a> {
    /// Whether the value is an array.
    pub fn is_array(&self) -> bool {
        matches!(self.value.map(Spanned::get_ref), Some(DeValue::Array(_)))
    }

    /// An array of `N` finite numbers that all pass a test; `allowed` says what the array must be.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array; a single wrong number is located itself.
    pub fn numbers_where<const N: usize>(
        &self,
        allowed: &str,
        test: impl Fn(f64) -> bool,
    ) -> Result<[f64; N], InputError> {
        let rows: [Field<'a>; N] = self.elements(allowed)?;
        let mut numbers = [0.0; N];
        for (slot, row) in numbers.iter_mut().zip(rows) {
            *slot = row.number_where(allowed, &test)?;
        }
        Ok(numbers)
    }

    /// A vector of three finite numbers.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array.
    pub fn vector3(&self) -> Result<Vector3<f64>, InputError> {
        self.numbers_where("three finite numbers [x, y, z]", |_| true).map(Vector3::from)
    }

    /// Two finite numbers that pass a test, the first not above the second.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array.
    pub fn interval_where(&self, allowed: &str, test: impl Fn(f64) -> bool) -> Result<[f64; 2], InputError> {
        let ends: [f64; 2] = self.numbers_where(allowed, test)?;
        if ends[0] > ends[1] {
            return Err(self.error("has its lower end above its upper end", allowed));
        }
        Ok(ends)
    }

    /// As [`Field::interval_where`], the first number below the second.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array.
    pub fn wide_interval_where(&self, allowed: &str, test: impl Fn(f64) -> bool) -> Result<[f64; 2], InputError> {
        let ends = self.interval_where(allowed, test)?;
        if ends[0] < ends[1] { Ok(ends) } else { Err(self.error("has no width", allowed)) }
    }

    /// Two finite numbers, the first not above the second.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array.
    pub fn interval(&self) -> Result<[f64; 2], InputError> {
        self.interval_where("two finite numbers [min, max] with min not above max", |_| true)
    }

    /// A matrix of three rows of three finite numbers.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array.
    pub fn matrix3(&self) -> Result<Matrix3<f64>, InputError> {
        let allowed = "three rows of three finite numbers [[a, b, c], [d, e, f], [g, h, i]]";
        let rows: [Field<'a>; 3] = self.elements(allowed)?;
        let mut matrix = Matrix3::zeros();
        for (index, row) in rows.iter().enumerate() {
            let row: [f64; 3] = row.numbers_where(allowed, |_| true)?;
            matrix.set_row(index, &row.into());
        }
        Ok(matrix)
    }

    /// An array of tables, as many as there are.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no array of tables.
    pub fn tables(&self) -> Result<Vec<Table<'a>>, InputError> {
        let allowed = format!("tables [[{}]]", self.path);
        let DeValue::Array(array) = self.required(&allowed)? else {
            return Err(self.error("is not an array of tables", allowed));
        };
        array.iter().enumerate().map(|(index, value)| self.row(index, value).table()).collect()
    }

    /// The elements of an array, as many as there are but at least one.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no array or an empty one.
    pub fn list(&self, allowed: &str) -> Result<Vec<Field<'a>>, InputError> {
        let DeValue::Array(array) = self.required(allowed)? else {
            return Err(self.error("is not an array", allowed));
        };
        if array.is_empty() {
            return Err(self.error("is empty", allowed));
        }
        Ok(array.iter().enumerate().map(|(index, value)| self.row(index, value)).collect())
    }

    /// As many finite numbers as there are, at least one, that all pass a test.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such array; a single wrong number is located itself.
    pub fn numbers(&self, allowed: &str, test: impl Fn(f64) -> bool) -> Result<Vec<f64>, InputError> {
        self.list(allowed)?.iter().map(|element| element.number_where(allowed, &test)).collect()
    }

    /// The elements of an array of length `N`, named `path[1]` to `path[N]`.
    fn elements<const N: usize>(&self, allowed: &str) -> Result<[Field<'a>; N], InputError> {
        let DeValue::Array(array) = self.required(allowed)? else {
            return Err(self.error("is not an array", allowed));
        };
        match <&[Spanned<DeValue<'a>>; N]>::try_from(&array[..]) {
            Ok(values) => Ok(std::array::from_fn(|index| self.row(index, &values[index]))),
            Err(_) => Err(self.error(format!("has {} elements and not {N}", array.len()), allowed)),
        }
    }

    /// The element of an array at an index from 0, named by its number from 1.
    fn row(&self, index: usize, value: &'a Spanned<DeValue<'a>>) -> Field<'a> {
        let path = format!("{}[{}]", self.path, index + 1);
        Field { file: self.file, path, parent_line: self.line(), value: Some(value) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_parts, read_field as read};

    #[test]
    fn arrays_are_taken_as_written() {
        assert_eq!(read("v = [1, 1]", |v| v.interval()), Ok([1.0, 1.0]));
        assert_eq!(read("v = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]", |v| v.matrix3()).map(|m| m[(0, 1)]), Ok(-1.0));
        assert_eq!(read("v = [{}, {}]", |v| v.tables().map(|rows| rows.len())), Ok(2));
    }

    #[test]
    fn each_kind_refuses_what_it_is_not() {
        assert_parts(read("v = [2, 1]", |v| v.interval()), "3: a.v", &["lower end above", "found [2, 1]", "min not"]);
        assert_parts(read("v = [2]", |v| v.interval()), "3: a.v", &["1 elements and not 2", "found [2]"]);
        assert_parts(read("v = 2", |v| v.interval()), "3: a.v", &["not an array", "found 2"]);
        assert_parts(read("v = [1,\n 2,\n nan]", |v| v.vector3()), "5: a.v[3]", &["finite", "found nan"]);
        assert_parts(read("v = [[1, 2, 3], [4, 5], [6, 7, 8]]", |v| v.matrix3()), "3: a.v[2]", &["found [4, 5]"]);
        assert_parts(read("v = [{}, 2]", |v| v.tables().map(drop)), "3: a.v[2]", &["not a table", "found 2"]);
        assert_parts(read("v = {}", |v| v.tables().map(drop)), "3: a.v", &["not an array of tables", "found {}"]);
        let positive = |v: &crate::reader::Field<'_>| v.numbers("numbers above 0", |n| n > 0.0).map(drop);
        assert_parts(read("v = []", positive), "3: a.v", &["is empty", "found []", "above 0"]);
        assert_parts(read("v = 1", positive), "3: a.v", &["not an array", "found 1;", "above 0"]);
        assert_parts(read("v = [1, 0]", positive), "3: a.v[2]", &["out of range", "found 0;", "above 0"]);
    }
}
