//! What yields beside the joints about their axes.

use super::{Writer, list};
use nalgebra::{DMatrix, Matrix3};
use toml::{Table, Value};

impl Writer<'_> {
    /// What the springs of a robot file stand for, and from where they were measured.
    pub(super) fn model(&self, table: &mut Table) {
        let model = match self.of("springs") {
            "axes" => "axes",
            "axial part" => "axial_part",
            "full" | "full pairs" => "full",
            _ => "",
        };
        let from = match self.of("base") {
            "none" => "floor",
            "alike" => "base",
            _ => "",
        };
        for (key, word) in [("stiffness_model", model), ("stiffness_measured_from", from)] {
            if !word.is_empty() {
                table.insert(key.to_owned(), Value::from(word));
            }
        }
    }

    /// Springs normal to the axis of a row, in one of the ways in which rows state them.
    pub(super) fn normal_springs(&mut self, row: &mut Table, j: usize, softer: f64) {
        let mut soft =
            |scale: f64| [0.3, 0.2, 0.3, 0.9, 0.8, 1.2][j.min(5)] * scale * softer * self.random.between(0.5, 1.5);
        let (x, y) = (soft(1.0), soft(0.7));
        let mut put = |key: &str, value: Value| {
            row.insert(key.to_owned(), value);
        };
        match self.of("springs") {
            "full" => put("orthogonal_compliance_urad_per_nm", Value::from(x)),
            "left out" => put("orthogonal_stiffness_mnm_per_rad", Value::from(1.0 / x)),
            "full pairs" => {
                match j {
                    1 => put("orthogonal_stiffness_mnm_per_rad", Value::from(vec![1.0 / x, 1.0 / y])),
                    2 => put("orthogonal_compliance_urad_per_nm", Value::from(vec![x, 0.0])),
                    _ => put("orthogonal_compliance_urad_per_nm", Value::from(vec![x, y])),
                }
                put("bearing_mm", Value::from([-300.0, 40.0, -30.0, -420.0, 25.0, -60.0][j.min(5)]));
            }
            _ => {}
        }
    }

    /// The covariance of a spring normal to an axis joins that of others.
    pub(super) fn uncertain(&self) -> Vec<String> {
        let mut names = vec!["joints[1].compliance_urad_per_nm", "joints[3].compliance_urad_per_nm"];
        if self.of("springs").starts_with("full") {
            names[1] = "joints[4].orthogonal_compliance_urad_per_nm[2]";
        }
        names.into_iter().map(str::to_owned).collect()
    }

    /// A symmetric matrix without a negative eigenvalue, of entries of about a size.
    fn semidefinite(&mut self, count: usize, size: f64) -> DMatrix<f64> {
        let root = DMatrix::from_fn(count, count, |_, _| self.random.between(-1.0, 1.0));
        let mut all = &root * root.transpose() * size;
        all.fill_lower_triangle_with_upper_triangle();
        all
    }

    /// Base, mount, holder and tool: lines of the table of the spindle, and tables of their own.
    pub(super) fn matrices(&mut self) -> [String; 2] {
        let (mut spindle, mut tables) = (String::new(), String::new());
        let of_spindle = self.of("spindle yields");
        if matches!(of_spindle, "mount" | "both") {
            spindle += &format!("\nmount_matrix = {}", rows(&self.semidefinite(6, 0.02)));
        }
        if matches!(of_spindle, "tip" | "both") {
            spindle += &format!("\ntip_um_per_n = {}", rows(&self.semidefinite(3, 0.03)));
        }
        match self.of("base") {
            "alike" => {
                let [a, b, e, g, k, t, u] = [0.02, 0.01, 0.004, 0.01, 0.002, 0.06, 0.05];
                let all = [
                    [a, 0.0, 0.0, e, g, 0.0],
                    [0.0, a, 0.0, -g, e, 0.0],
                    [0.0, 0.0, b, 0.0, 0.0, k],
                    [e, -g, 0.0, t, 0.0, 0.0],
                    [g, e, 0.0, 0.0, t, 0.0],
                    [0.0, 0.0, k, 0.0, 0.0, u],
                ];
                let all = DMatrix::from_row_slice(6, 6, all.as_flattened());
                tables += &format!("\n[base_compliance]\nmatrix = {}\n", rows(&all));
            }
            "unlike" => {
                let all = rows(&self.semidefinite(6, 0.02));
                tables += &format!("\n[base_compliance]\npoint_mm = [80.0, -120.0, -500.0]\nmatrix = {all}\n");
            }
            _ => {}
        }
        if self.of("part yields") == "table" {
            tables += &format!("\n[part_compliance]\num_per_n = {}\n", rows(&self.semidefinite(3, 0.05)));
        }
        [spindle, tables]
    }

    /// The compliance of the part at a point, as the columns of a task have it: xx, yy, zz, xy, xz, yz.
    pub(super) fn part_columns(&mut self) -> [f64; 6] {
        let all = self.semidefinite(3, 0.05);
        // What the columns state is rounded, and still no negative eigenvalue.
        let all =
            Matrix3::from_fn(|row, column| (all[(row, column)] * 1e6).round() * 1e-6) + Matrix3::identity() * 1e-5;
        [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| all[at])
    }
}

fn rows(matrix: &DMatrix<f64>) -> String {
    let rows: Vec<String> = matrix.row_iter().map(|row| list(row.iter().copied())).collect();
    format!("[{}]", rows.join(", "))
}
