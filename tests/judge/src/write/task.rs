//! The tool path of a run.

use super::Writer;
use nalgebra::Vector3;
use std::fmt::Write as _;

/// The columns of a part that yields.
const PART: &str =
    ",part_xx_um_per_n,part_yy_um_per_n,part_zz_um_per_n,part_xy_um_per_n,part_xz_um_per_n,part_yz_um_per_n";

impl Writer<'_> {
    /// The tool path, about the origin of the part, some 120 mm wide.
    pub(super) fn task(&mut self) -> String {
        struct Step {
            segment: usize,
            place: Vector3<f64>,
            feed: Vector3<f64>,
            axis: Vector3<f64>,
            scored: bool,
        }
        let mut steps: Vec<Step> = Vec::new();
        let mut add = |segment: usize, place: Vector3<f64>, feed: Vector3<f64>, axis: Vector3<f64>| {
            steps.push(Step { segment, place, feed: feed.normalize(), axis: axis.normalize(), scored: true });
        };
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        match self.of("path") {
            "raster" => (0..5).for_each(|k| add(1, x * (25.0 * f64::from(k) - 50.0) - y * 20.0, x, z)),
            "contour" => (0..4).for_each(|k| add(1, x * (20.0 * f64::from(k) - 60.0), x, z)),
            "tilted" => (0..5).for_each(|k| {
                let k = f64::from(k);
                add(1, x * (20.0 * k - 50.0) + z * k * k, x, z + x * (0.06 * k - 0.1) + y * 0.15);
            }),
            _ => (0..7).for_each(|k| {
                add(1, x * (15.0 * f64::from(k) - 50.0) + y * f64::from(k * k), x + y * 0.1 * f64::from(k), z)
            }),
        }
        match self.of("path") {
            "raster" => (0..5).for_each(|k| add(2, x * (50.0 - 25.0 * f64::from(k)) + y * 20.0, -x, z)),
            "contour" => {
                (0..4).for_each(|k| add(2, y * (20.0 * f64::from(k)), y, z));
                (0..5).for_each(|k| {
                    let angle = f64::from(k) * 0.35;
                    add(
                        3,
                        (x * (angle.cos() - 1.0) + y * angle.sin()) * 50.0 + y * 60.0,
                        y * angle.cos() - x * angle.sin(),
                        z,
                    );
                });
            }
            "tilted" => (0..4).for_each(|k| add(2, y * (20.0 * f64::from(k)) - z * 5.0, y, z - y * 0.2)),
            _ => {}
        }
        match self.of("unscored") {
            "plunge" => {
                let mut at = 0;
                while at < steps.len() {
                    if at == 0 || steps[at].segment != steps[at - 1].segment {
                        for height in [10.0, 20.0] {
                            let first = &steps[at];
                            let place = first.place + first.axis * height;
                            let above = Step {
                                segment: first.segment,
                                place,
                                feed: first.feed,
                                axis: first.axis,
                                scored: false,
                            };
                            steps.insert(at, above);
                        }
                        at += 2;
                    }
                    at += 1;
                }
            }
            "turn in place" => {
                if let Some(last) = steps.last() {
                    let (segment, place, feed) = (last.segment, last.place, last.feed);
                    let aside = last.axis.cross(&feed);
                    let axis = (last.axis + aside * 0.12).normalize();
                    steps.push(Step { segment, place, feed, axis, scored: false });
                    steps.push(Step { segment, place: place + feed * 15.0, feed, axis, scored: true });
                }
            }
            _ => {}
        }
        let load = self.of("load");
        let (has_forces, has_moments) = (matches!(load, "task" | "moments"), load == "moments");
        let has_part = self.of("part yields") == "columns";
        let has_leans = self.of("lean") == "bull plane";
        let (has_feeds, has_scored) = (self.of("feeds") == "task", self.of("unscored") != "none");
        let mut text =
            "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,normal_x,normal_y,normal_z".to_owned();
        for (is_there, names) in [
            (has_forces, ",force_x_n,force_y_n,force_z_n"),
            (has_moments, ",moment_x_nm,moment_y_nm,moment_z_nm"),
            (has_feeds, ",feed_mm_per_s"),
            (has_part, PART),
            (has_leans, ",lead_min_deg,lead_max_deg,tilt_min_deg,tilt_max_deg"),
            (has_scored, ",scored"),
        ] {
            text.push_str(if is_there { names } else { "" });
        }
        text.push('\n');
        for (number, step) in steps.iter().enumerate() {
            let normal = (step.axis + step.feed.cross(&step.axis) * 0.5).normalize();
            let mut numbers: Vec<f64> =
                [step.place, step.feed, step.axis, normal].iter().flat_map(|v| [v.x, v.y, v.z]).collect();
            if has_forces {
                numbers.extend([-120.0, 80.0, 60.0].map(|force| force * self.random.between(0.5, 1.5)));
            }
            if has_moments {
                numbers.extend([3.0, -2.0, 1.0].map(|moment| moment * self.random.between(0.5, 1.5)));
            }
            if has_feeds {
                numbers.push(self.random.between(15.0, 45.0).round());
            }
            if has_part {
                numbers.extend(self.part_columns());
            }
            if has_leans {
                let narrow = if number % 2 == 0 { [2.0, 8.0, -3.0, 3.0] } else { [3.0, 6.0, -2.0, 1.0] };
                numbers.extend(if step.scored { narrow } else { [0.0; 4] });
            }
            let words: Vec<String> = numbers.iter().map(|number| format!("{number:.9}")).collect();
            let _ = write!(text, "{},{}", step.segment, words.join(","));
            let _ = writeln!(
                text,
                "{}",
                if !has_scored {
                    ""
                } else if step.scored {
                    ",1"
                } else {
                    ",0"
                }
            );
        }
        text
    }
}
