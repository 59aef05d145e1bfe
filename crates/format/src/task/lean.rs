//! The columns of a task that say how far the tool may lean at each point.

use super::CsvTable;
use stead_disk::input::InputError;
use stead_disk::input::csv_table::Row;

/// Lead and tilt, from and to.
pub const LEAN: [&str; 4] = ["lead_min_deg", "lead_max_deg", "tilt_min_deg", "tilt_max_deg"];

/// How far the tool may lean at a point, as the task has it; none of what it does not say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointLean {
    /// Range of the lead. rad
    pub lead: Option<[f64; 2]>,
    /// Range of the tilt. rad
    pub tilt: Option<[f64; 2]>,
}

/// The numbers of these columns: each pair alone or both.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LeanColumns {
    lead: Option<[usize; 2]>,
    tilt: Option<[usize; 2]>,
}

impl LeanColumns {
    pub(super) fn find(table: &CsvTable<'_>, fail: &dyn Fn(&str, &str) -> InputError) -> Result<Self, InputError> {
        let pair = |names: [&'static str; 2]| match names.map(|name| table.column(name)) {
            [Some(min), Some(max)] => Ok(Some([min, max])),
            [None, None] => Ok(None),
            [min, _] => {
                let missing = names[usize::from(min.is_some())];
                Err(fail(missing, "missing column: the two ends of a range go together"))
            }
        };
        Ok(Self { lead: pair([LEAN[0], LEAN[1]])?, tilt: pair([LEAN[2], LEAN[3]])? })
    }

    pub(super) fn is_there(&self) -> bool {
        self.lead.is_some() || self.tilt.is_some()
    }

    pub(super) fn of(&self, row: &Row<'_>) -> Result<PointLean, InputError> {
        let range = |columns: Option<[usize; 2]>| {
            let Some([min, max]) = columns else { return Ok(None) };
            let [low, high] = [row.number(min)?, row.number(max)?];
            if low > high {
                let problem = format!("above the end of its range, {high}");
                return Err(row.fail(min, &problem, "at most the value of the column of the other end"));
            }
            Ok(Some([low.to_radians(), high.to_radians()]))
        };
        Ok(PointLean { lead: range(self.lead)?, tilt: range(self.tilt)? })
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse_csv;
    use super::PointLean;
    use std::path::Path;

    const HEADER: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z";

    fn read(columns: &str, row: &str) -> Result<Option<Vec<PointLean>>, String> {
        let text = format!("{HEADER}{columns}\n1,10,20,30,1,0,0,0,0,1{row}\n");
        parse_csv(Path::new("task.csv"), text.as_bytes()).map(|task| task.leans).map_err(|error| error.to_string())
    }

    #[test]
    fn ranges_are_read_in_pairs() {
        assert_eq!(read("", "").unwrap(), None);
        let tilt = read(",tilt_max_deg,tilt_min_deg", ",5,-10").unwrap().unwrap();
        assert_eq!(tilt, [PointLean { lead: None, tilt: Some([-10_f64.to_radians(), 5_f64.to_radians()]) }]);
        for (columns, row, parts) in [
            (",lead_min_deg", ",1", [":1:", "lead_max_deg", "go together"]),
            (",tilt_max_deg", ",1", [":1:", "tilt_min_deg", "go together"]),
            (",lead_min_deg,lead_max_deg", ",5,-5", [":2:", "lead_min_deg", "above the end of its range, -5"]),
            (",lead_min_deg,lead_max_deg", ",nan,5", [":2:", "lead_min_deg", "finite"]),
            (",lead_min_deg,lead_max_deg", ",0,inf", [":2:", "lead_max_deg", "finite"]),
        ] {
            let message = read(columns, row).unwrap_err();
            parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        }
    }
}
