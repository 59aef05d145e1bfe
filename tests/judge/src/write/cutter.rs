//! The cutter and the stock of a run.

use super::Writer;

/// The stock about the path and the speed of the spindle.
pub(super) const STOCK: &str =
    "\n[stock]\nallowance_mm = [6.0, 6.0, 3.0]\ncell_mm = 0.7\n\n[cut]\nspindle_rpm = 8000.0\n";

impl Writer<'_> {
    /// The table of the cutter.
    pub(super) fn tool(&self) -> String {
        let mut text = String::new();
        let (tool, load) = (self.of("tool"), self.of("load"));
        if tool == "none" {
            return text;
        }
        text.push_str("\n[tool]\ncutter_diameter_mm = 16.0\n");
        if matches!(load, "conventional" | "climb" | "stock") {
            text.push_str(
                "teeth = 3\nrotation = \"counterclockwise\"\nkt_mpa = 800.0\nkr = 0.4\nkte_n_per_mm = 20.0\nkre_n_per_mm = 15.0\n",
            );
        }
        match self.of("lean") {
            "ball" => text.push_str("corner_radius_mm = 8.0\n"),
            "bull plane" => text.push_str("corner_radius_mm = 2.0\n"),
            _ => {}
        }
        if load == "stock" {
            text.push_str("ka_mpa = 90.0\ncorner_radius_mm = 2.0\ntaper_deg = 3.0\n");
        }
        if load == "stock" || tool == "holder" {
            text.push_str("flute_length_mm = 30.0\n");
        }
        if tool == "holder" {
            text.push_str("holder_mm = [[25.0, 16.0], [40.0, 50.0]]\n");
        }
        text
    }
}
