//! Programs of a mounted arm with a rail and a tilted turntable, the part turned: written in every form and read back.

use super::bench::{ARMS, Bench};
use crate::program::{ExportOptions, ProgramFormat};

pub const TABLES: &str = "[mount]
xyz_mm = [100, -50, 200]
rpy_deg = [8, -5, 20]
[[external_axis]]
name = 'rail'
kind = 'rail'
carries = 'robot'
direction = [1, 2, 0.5]
range_mm = [-500, 500]
use = 'indexed'
[[external_axis]]
name = 'table'
kind = 'turntable'
carries = 'workpiece'
axis = [0.2, 0, 1]
xyz_mm = [1500, 0, 500]
range_deg = [-90, 90]
use = 'indexed'
";

fn bench(name: &str) -> Bench {
    Bench::with(name, TABLES, |point| vec![0.01 * point as f64 - 0.04, 0.1 - 0.02 * point as f64])
}

#[test]
fn programs_with_external_axes_bring_the_tool_where_the_plan_has_it() {
    for (name, _, format) in ARMS {
        let bench = bench(name);
        for (format, folder) in [(format, "maker"), (ProgramFormat::Csv, "table")] {
            let program = bench.export(&ExportOptions { format, ..bench.options() }).unwrap();
            let main = bench.written(&program, folder);
            let found = bench.check(&main).unwrap();
            assert!(found.is_sound(), "{name} {format:?}: {found:?}");
            assert!(found.position.unwrap().value < 0.005);
        }
    }
}

#[test]
fn an_axis_that_is_elsewhere_is_found() {
    for (name, from, to) in [("kuka", "E2 ", "E2 9"), ("fanuc", "E1= ", "E1= 9"), ("abb", "[[", "[[")] {
        let bench = bench(name);
        let mut program = bench.export(&bench.options()).unwrap();
        let part = program.files.last_mut().unwrap();
        if name == "abb" {
            // The second external axis of the last target.
            let at = part.text.rfind(",9E9,9E9,9E9,9E9]").unwrap();
            let before = part.text[..at].rfind(',').unwrap();
            part.text.replace_range(before + 1..at, "77.7000");
        } else {
            assert!(part.text.contains(from), "{}", part.text);
            part.text = part.text.replacen(from, to, 1);
        }
        let main = bench.written(&program, "changed");
        match bench.check(&main) {
            Ok(found) => {
                assert!(!found.is_sound() && found.mismatch.unwrap().contains("external axis E"), "{name}")
            }
            Err(error) => panic!("{name}: {error}"),
        }
    }
}
