//! From a URDF to a program and back: the moves of a program through the URDF's own joint origins and axes.

use super::bench::{ARMS, Bench};
use crate::{ExportOptions, Program, ProgramFormat};
use nalgebra::{Rotation3, Vector3};
use stead_format::urdf::tip_at;
use stead_model::robot::Pose;
use stead_numerics::rotation::rotation_vector;

/// The numbers of a line, in their order.
fn numbers(line: &str) -> Vec<f64> {
    let words = line.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    words.filter(|word| word.contains('.')).map(|word| word.parse().unwrap()).collect()
}

/// `Rz(z) Ry(y) Rx(x)` in mm and deg, by nalgebra.
fn pose([x, y, z]: [f64; 3], [about_z, about_y, about_x]: [f64; 3]) -> Pose<f64> {
    let [c, b, a] = [about_x, about_y, about_z].map(f64::to_radians);
    Pose { rotation: *Rotation3::from_euler_angles(c, b, a).matrix(), translation: Vector3::new(x, y, z) / 1e3 }
}

fn of_quaternion(n: &[f64]) -> Pose<f64> {
    let quaternion = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(n[3], n[4], n[5], n[6]));
    let rotation = *quaternion.to_rotation_matrix().matrix();
    Pose { rotation, translation: Vector3::new(n[0], n[1], n[2]) / 1e3 }
}

/// Joint angles of joint moves (deg), and flange poses of linear moves in the robot root, as an operator would read
/// them.
fn moves(program: &Program) -> (Vec<[f64; 6]>, Vec<Pose<f64>>) {
    let (main, part) = (&program.files[0].text, &program.files[1].text);
    let line = |text: &str, start: &str| text.lines().find(|line| line.trim().starts_with(start)).unwrap().to_owned();
    let six = |line: &str| <[f64; 6]>::try_from(&numbers(line)[..6]).unwrap();
    let by_abc = |n: &[f64]| pose([n[0], n[1], n[2]], [n[3], n[4], n[5]]);
    let by_wpr = |n: &[f64]| pose([n[0], n[1], n[2]], [n[5], n[4], n[3]]);
    let (base, tool): (Pose<f64>, Pose<f64>);
    let (mut joints, mut lines) = (Vec::new(), Vec::new());
    match program.format {
        ProgramFormat::Krl => {
            let frame = |start: &str| by_abc(&numbers(line(part, start).split_once("FRAME").unwrap().1));
            (base, tool) = (frame("$BASE"), frame("$TOOL"));
            for text in part.lines() {
                match text.split(' ').next() {
                    // Behind the names A1 to A6.
                    Some("PTP") => joints.push(six(text)),
                    Some("LIN") => lines.push(by_abc(&numbers(text))),
                    _ => {}
                }
            }
        }
        ProgramFormat::Rapid => {
            (base, tool) = (
                of_quaternion(&numbers(&line(main, "PERS wobjdata"))),
                of_quaternion(&numbers(&line(main, "PERS tooldata"))),
            );
            for text in part.lines().map(str::trim) {
                if text.starts_with("MoveAbsJ") {
                    joints.push(six(text));
                } else if text.starts_with("MoveL") {
                    lines.push(of_quaternion(&numbers(text)));
                }
            }
        }
        _ => {
            let frame = |name: &str| {
                let remarks = part.lines().filter(|line| line.contains(&format!("!{name} 9 ")));
                by_wpr(&remarks.map(|line| numbers(line)[0]).collect::<Vec<_>>())
            };
            (base, tool) = (frame("UFRAME"), frame("UTOOL"));
            let positions = part.split("/POS").nth(1).unwrap().split("};").filter(|text| text.contains("P["));
            for text in positions {
                let values = numbers(text.split("CONFIG").last().unwrap());
                if text.contains("J1=") {
                    joints.push(values[..6].try_into().unwrap());
                } else {
                    lines.push(by_wpr(&values));
                }
            }
        }
    }
    let flanges = lines.iter().map(|line| base.then(line).then(&tool.inverse())).collect();
    (joints, flanges)
}

#[test]
fn the_moves_of_a_program_are_the_task_through_the_urdf() {
    for (name, text, format) in ARMS {
        let bench = Bench::new(name);
        let program = bench.export(&bench.options()).unwrap();
        let (joints, flanges) = moves(&program);
        assert_eq!((joints.len(), flanges.len()), (4, 14), "{name}");
        let problem = &bench.run.problem;
        let (plan, _) = stead_runs::plan::read_plan(&bench.plan, problem).unwrap();
        // The tool on the URDF's flange, in its base link.
        let tool = |degrees: &[f64; 6]| {
            let mut values = degrees.map(f64::to_radians);
            // Fanuc counts axis 3 against the horizontal, a URDF against the link before.
            values[2] += if format == ProgramFormat::Fanuc { values[1] } else { 0.0 };
            let flange = tip_at(text, &values).then(&bench.imported.flange_from_tip.inverse());
            flange.then(&problem.spindle.flange_from_tool)
        };
        let root_from_base = &bench.imported.link_from_base;
        let target = |point: usize, back: f64| {
            let mut tool = root_from_base.then(&plan.points[point].base_from_tool);
            tool.translation -= tool.rotation.column(2) * back;
            tool
        };
        let near = |found: &Pose<f64>, wanted: &Pose<f64>, place: &str| {
            let off_mm = (found.translation - wanted.translation).norm() * 1e3;
            let off_deg = rotation_vector(&(found.rotation.transpose() * wanted.rotation)).norm().to_degrees();
            assert!(off_mm < 0.01 && off_deg < 0.01, "{name}, {place}: {off_mm} mm, {off_deg} deg");
        };
        // The angles of every move stand in the table.
        let table = bench.export(&ExportOptions::new(ProgramFormat::Csv, "T")).unwrap();
        let rows: Vec<Vec<&str>> = table.files[0].text.lines().skip(1).map(|row| row.split(',').collect()).collect();
        let (mut next_joint, mut next_line) = (0, 0);
        for (segment, range) in problem.task.segments().iter().enumerate() {
            let start = target(range.start, 0.05);
            near(&tool(&joints[next_joint]), &start, &format!("joint move to segment {}", segment + 1));
            let goals = range.clone().map(|point| target(point, 0.0)).chain([target(range.end - 1, 0.05)]);
            for goal in goals {
                let place = format!("line {next_line} in segment {}", segment + 1);
                near(&flanges[next_line].then(&problem.spindle.flange_from_tool), &goal, &place);
                let row = &rows[next_joint + next_line + 1];
                let angles: [f64; 6] = std::array::from_fn(|axis| row[13 + axis].parse().unwrap());
                near(&tool(&angles), &goal, &format!("angles of {place}"));
                next_line += 1;
            }
            next_joint += 1;
        }
    }
}
