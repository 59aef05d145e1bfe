//! Bodies in `page-data.json`.

use super::packed::base64;
use super::shapes::{BodyFrame, BodyMesh};

records! {
    /// A body that is drawn.
    pub struct BodyData from mesh: &BodyMesh {
        let ends = |k: usize| {
            let values = mesh.positions.iter().map(|position| f64::from(position[k]));
            let (low, high) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            if low.is_finite() { (low, high) } else { (0.0, 0.0) }
        };
        let sides = [ends(0), ends(1), ends(2)];
        let middle = sides.map(|(low, high)| (low + high) / 2.0);
        let step = (sides.iter().map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max) / 32767.0).max(1e-12);
        let quantised = |position: &[f32; 3]| {
            [0, 1, 2].map(|k| ((f64::from(position[k]) - middle[k]) / step).round() as i16).map(i16::to_le_bytes)
        };
        let positions: Vec<u8> = mesh.positions.iter().flat_map(quantised).flatten().collect();
        let is_wide = mesh.positions.len() > usize::from(u16::MAX);
        let corners = mesh.triangles.iter().flatten();
        let triangles: Vec<u8> = if is_wide {
            corners.flat_map(|corner| corner.to_le_bytes()).collect()
        } else {
            corners.flat_map(|corner| (*corner as u16).to_le_bytes()).collect()
        };
    } with {
        /// Its name.
        name: String = mesh.name.to_string(),
        /// What it moves with.
        frame: String = frame(mesh.frame),
        /// Red, green and blue, from 0 to 1.
        color: [f64; 3] = mesh.color.map(|part| (f64::from(part) * 1e3).round() / 1e3),
        /// Whether it only illustrates: no shape of the run.
        is_illustration: bool = mesh.is_illustration,
        /// Middle of its corners. mm
        middle_mm: [f64; 3] = middle.map(|value| value * 1e3),
        /// Corners are in steps of this from the middle. mm
        mm_per_step: f64 = step * 1e3,
        /// Corners as whole numbers of 16 bits.
        positions: String = base64(&positions),
        /// Whether the numbers of corners have 32 bits in place of 16.
        wide: bool = is_wide,
        /// Numbers of corners of triangles.
        triangles: String = base64(&triangles),
    }
}

fn frame(frame: BodyFrame) -> String {
    match frame {
        BodyFrame::Base => "base".to_owned(),
        BodyFrame::Link(number) => format!("link_{number}"),
        BodyFrame::Tool => "tool".to_owned(),
        BodyFrame::Workpiece => "workpiece".to_owned(),
        BodyFrame::Cell => "cell".to_owned(),
        BodyFrame::Axis(number) => format!("axis_{}", number + 1),
    }
}
