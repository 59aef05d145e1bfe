//! Figures of the maker's data sheet other than the kinematics.

use super::{Robot, RobotError};
use serde::Serialize;

/// Figures of the data sheet, where known; no computation of stiffness or kinematics depends on them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct DataSheet {
    /// Rated payload. kg
    pub payload: Option<f64>,
    /// Working radius: the largest distance of the wrist centre from axis 1. m
    pub working_radius: Option<f64>,
    /// Price. EUR
    pub price: Option<f64>,
}

impl Robot {
    /// The figures of the data sheet, where known.
    pub fn data_sheet(&self) -> &DataSheet {
        &self.data_sheet
    }

    /// The same arm with these figures.
    ///
    /// # Errors
    /// [`RobotError::DataSheet`] for a figure that is not finite and above zero.
    pub fn with_data_sheet(mut self, data_sheet: DataSheet) -> Result<Self, RobotError> {
        let figures = [
            ("payload", data_sheet.payload),
            ("working_radius", data_sheet.working_radius),
            ("price", data_sheet.price),
        ];
        for (field, value) in figures {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(RobotError::DataSheet { field, value });
            }
        }
        self.data_sheet = data_sheet;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::kr270;
    use super::*;

    #[test]
    fn figures_are_kept_and_checked() {
        assert_eq!(*kr270().data_sheet(), DataSheet::default());
        let sheet = DataSheet { payload: Some(270.0), working_radius: None, price: Some(1e5) };
        let robot = kr270().with_data_sheet(sheet).unwrap();
        assert_eq!(*robot.with_compliances([1e-6; 6]).unwrap().data_sheet(), sheet);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = kr270().with_data_sheet(DataSheet { working_radius: Some(value), ..sheet }).unwrap_err();
            assert!(matches!(error, RobotError::DataSheet { field: "working_radius", .. }));
        }
    }
}
