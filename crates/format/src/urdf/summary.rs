//! What was understood of a URDF, for people.

use super::xml::one_line;
use super::{ImportedRobot, POSTURES};
use std::fmt::{self, Display};

impl Display for ImportedRobot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: from link {} to link {}\n", self.name, self.base_link, self.tip_link)?;
        writeln!(
            f,
            "joint   alpha deg         a mm         d mm      min deg      max deg    deg/s  angle of the row"
        )?;
        for (k, row) in self.rows.iter().enumerate() {
            let ([min, max], speed) = (self.limits_deg[k], self.max_speed_deg_per_s[k]);
            let speed = speed.map_or("-".to_owned(), |speed| format!("{speed:.1}"));
            let [alpha, a, d] = [row.alpha_deg, row.a_mm, row.d_mm];
            let angle = self.angle(k);
            writeln!(f, "{:<5} {alpha:>11.1} {a:>12.3} {d:>12.3} {min:>12.3} {max:>12.3} {speed:>8}  {angle}", k + 1)?;
        }
        let base = self.link_from_base.translation * 1e3;
        writeln!(f, "\nbase of the rows in link {}: {:.3}, {:.3}, {:.3} mm", self.base_link, base.x, base.y, base.z)?;
        writeln!(
            f,
            "rows against the URDF, over {POSTURES} random postures: at most {:.1e} mm, {:.1e} deg",
            self.deviation.position_mm, self.deviation.angle_deg
        )
    }
}

impl ImportedRobot {
    /// The angle of a row in terms of that of the URDF: `theta_2 = -q(joint_2) - 90`.
    pub(super) fn angle(&self, k: usize) -> String {
        let row = &self.rows[k];
        let sign = if row.sign < 0.0 { "-" } else { "" };
        let offset = match row.offset_deg {
            0.0 => String::new(),
            offset if offset < 0.0 => format!(" - {} deg", -offset),
            offset => format!(" + {offset} deg"),
        };
        let name = one_line(&self.joints[k]);
        format!("theta_{} = {sign}q({name}){offset}", k + 1)
    }
}
