//! The table `[output]` of a run file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is made beside the plans.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputTable {
    /// Whether the deflection over path point and beta is mapped, as tables and pictures; `true` where left out.
    pub maps: Option<bool>,
}

impl OutputTable {
    pub(super) fn maps(&self) -> bool {
        self.maps.unwrap_or(true)
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, assert_refused, read_text as read};

    #[test]
    fn maps_are_made_unless_they_are_not_wanted() {
        assert!(read(RUN).unwrap().maps && read(&format!("{RUN}[output]\n")).unwrap().maps);
        assert!(!read(&format!("{RUN}[output]\nmaps = false\n")).unwrap().maps);
        let parts = ["run.toml:7: output.maps: ", "found 'no'", "; allowed: true or false"];
        assert_refused("[cell]", "[output]\nmaps = 'no'\n[cell]", &parts);
    }
}
