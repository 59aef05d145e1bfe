//! The table `[output]` of a run file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is made beside the plans.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct OutputTable {
    /// Whether the deflection over path point and beta is mapped, as tables and pictures; `true` where left out.
    pub maps: Option<bool>,
    /// Whether a page that shows the run in a browser is left, `report.html`, with `page-data.json`; `true` where left
    /// out.
    pub page: Option<bool>,
}

impl OutputTable {
    pub(super) fn maps(&self) -> bool {
        self.maps.unwrap_or(true)
    }

    pub(super) fn page(&self) -> bool {
        self.page.unwrap_or(true)
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, assert_refused, read_text as read};

    #[test]
    fn a_page_is_left_unless_it_is_not_wanted() {
        assert!(read(RUN).unwrap().page && read(&format!("{RUN}[output]\nmaps = false\n")).unwrap().page);
        assert!(!read(&format!("{RUN}[output]\npage = false\n")).unwrap().page);
        let parts = ["run.toml:7: output.page: ", "found 1", "; allowed: true or false"];
        assert_refused("[cell]", "[output]\npage = 1\n[cell]", &parts);
    }

    #[test]
    fn maps_are_made_unless_they_are_not_wanted() {
        assert!(read(RUN).unwrap().maps && read(&format!("{RUN}[output]\n")).unwrap().maps);
        assert!(!read(&format!("{RUN}[output]\nmaps = false\n")).unwrap().maps);
        let parts = ["run.toml:7: output.maps: ", "found 'no'", "; allowed: true or false"];
        assert_refused("[cell]", "[output]\nmaps = 'no'\n[cell]", &parts);
    }
}
