//! Rows, limits, masses and notes of fixtures and of arms made of rows.

use super::arms::{Arm, about_z, any_rotation, pose};
use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

fn assert_row(imported: &ImportedRobot, k: usize, expected: (f64, f64, f64, f64, f64)) {
    let row = imported.rows[k - 1];
    let found = (row.alpha_deg, row.a_mm, row.d_mm, row.sign, row.offset_deg);
    assert_eq!(found, expected, "row {k} of {}", imported.name);
}

#[test]
fn the_rows_of_every_convention_are_the_urdf() {
    for (name, text) in FIXTURES {
        let imported = import(text).unwrap_or_else(|error| panic!("{error}"));
        let Deviation { position_mm, angle_deg } = imported.deviation;
        assert!(position_mm < 1e-9 && angle_deg < 1e-11, "{name}: {position_mm} mm, {angle_deg} deg");
        assert_eq!((imported.base_link.as_str(), imported.tip_link.as_str()), ("base_link", "tool0"));
        // What is written is what was compared.
        let robot = filled(&imported);
        for (joint, row) in robot.joints().iter().zip(&imported.rows) {
            assert_eq!((joint.a, joint.d), (row.a_mm / 1e3, row.d_mm / 1e3));
        }
    }
    let kuka = import(&fixture("kuka")).unwrap();
    assert_row(&kuka, 1, (0.0, 0.0, 675.0, -1.0, 0.0));
    assert_row(&kuka, 2, (-90.0, 350.0, 0.0, 1.0, 0.0));
    assert_row(&kuka, 3, (0.0, 1150.0, 0.0, 1.0, 90.0));
    assert_row(&kuka, 4, (-90.0, 41.0, -1000.0, 1.0, 0.0));
    assert_eq!(kuka.rows[5].d_mm, 215.0);
    assert_eq!(kuka.limits_deg[2], [-30.0, 245.0]);
    assert_eq!(kuka.max_speed_deg_per_s[0], Some(136.0));
    let fanuc = import(&fixture("fanuc")).unwrap();
    assert_eq!((fanuc.rows[2].alpha_deg, fanuc.rows[2].a_mm, fanuc.rows[3].a_mm), (180.0, 1120.0, 250.0));
    let staubli = import(&fixture("staubli")).unwrap();
    assert_row(&staubli, 2, (-90.0, 250.0, 0.0, 1.0, -90.0));
    assert_eq!((staubli.rows[3].a_mm, staubli.rows[3].d_mm, staubli.rows[5].d_mm), (0.0, 800.0, 194.0));
}

/// Arms with every combination of signs and twists, any offsets, base shifted, turned and mounted anyhow, joint frames
/// anywhere.
#[test]
fn rows_are_found_again_behind_any_signs_offsets_and_frames() {
    let mut random = ChaCha8Rng::seed_from_u64(16);
    for case in 0..256_u32 {
        let sign = |bit: u32| if case >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let rows = [
            (0.0, 0.0, 0.4),
            (90.0 * sign(6), 0.3 * sign(0), 0.0),
            (if sign(7) > 0.0 { 0.0 } else { 180.0 }, 0.9, if sign(1) > 0.0 { 0.0 } else { 0.07 }),
            (90.0 * sign(0), -0.05 * f64::from(case % 3), 0.8),
            (90.0 * sign(1), 0.0, 0.0),
            (90.0 * sign(2), 0.0, 0.15),
        ];
        let signs = std::array::from_fn(|k| sign(k as u32));
        let offsets = std::array::from_fn(|_| random.random_range(-PI..PI));
        let base = pose(about_z(random.random_range(-PI..PI)), [0.1, -0.2, 0.0]);
        let mounted = pose(any_rotation(&mut random), [1.0, 2.0, -0.5]);
        let arm = Arm { rows, offsets, signs, base, mounted };
        let text = arm.urdf(&mut random, 17);
        let imported = import(&text).unwrap_or_else(|error| panic!("{case}: {error}"));
        assert!(imported.deviation.position_mm < 1e-9 && imported.deviation.angle_deg < 1e-10, "{case}: {imported}");
        assert_eq!(imported.notes.iter().any(|note| note.contains("lateral offset")), sign(1) < 0.0);
        let robot = filled(&imported);
        for _ in 0..20 {
            let values: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.0..3.0));
            let theta = std::array::from_fn(|k| {
                let row = &imported.rows[k];
                row.sign * values[k] + row.offset_deg.to_radians()
            });
            let by_rows = imported.link_from_base.then(&robot.forward(&theta)).then(&imported.flange_from_tip);
            let expected = arm.frames(&values)[5];
            let off = (by_rows.translation - expected.translation).norm();
            assert!(off * 1e3 < 1e-9, "{case}: {off} m");
            assert!((by_rows.rotation - expected.rotation).norm() < 1e-12);
        }
    }
}

#[test]
fn limits_are_those_of_the_urdf_through_sign_and_offset() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let rows =
        [(0.0, 0.0, 0.4), (90.0, 0.3, 0.0), (0.0, 0.9, 0.0), (-90.0, 0.05, 0.8), (90.0, 0.0, 0.0), (-90.0, 0.0, 0.1)];
    let signs = [-1.0, 1.0, -1.0, -1.0, 1.0, -1.0];
    let arm = Arm {
        rows,
        offsets: [0.3, 1.0, -1.0, 0.2, 0.1, 2.0],
        signs,
        base: Pose::identity(),
        mounted: Pose::identity(),
    };
    let imported = import(&arm.urdf(&mut random, 17)).unwrap();
    for (k, row) in imported.rows.iter().enumerate() {
        let ends = [-2.0, 2.5].map(|q: f64| row.sign * q.to_degrees() + row.offset_deg);
        let [min, max] = imported.limits_deg[k];
        assert!((min - ends[0].min(ends[1])).abs() < 1e-8 && (max - ends[0].max(ends[1])).abs() < 1e-8);
    }
}

#[test]
fn rounded_numbers_are_taken_with_what_they_cost() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let rows =
        [(0.0, 0.0, 0.4), (90.0, 0.3, 0.0), (0.0, 0.9, 0.0), (-90.0, 0.05, 0.8), (90.0, 0.0, 0.0), (-90.0, 0.0, 0.1)];
    let arm = Arm { rows, offsets: [0.3; 6], signs: [1.0; 6], base: Pose::identity(), mounted: Pose::identity() };
    let six = import(&arm.urdf(&mut random, 6)).unwrap();
    assert!((1e-5..0.02).contains(&six.deviation.position_mm), "{six}");
    let is_noted = |robot: &ImportedRobot| robot.notes.iter().any(|note| note.contains("rounded"));
    assert!(!is_noted(&six));
    assert!(six.text.contains(&format!("{:.1e} mm", six.deviation.position_mm)));
    // A joint turned by 1e-4 rad is taken and noted, by 1e-3 rad it is not.
    let tilted = |angle: &str| {
        import(&fixture("abb").replacen("<axis xyz=\"0 1 0\"/>", &format!("<axis xyz=\"{angle} 1 0\"/>"), 1))
    };
    let noted = tilted("0.0001").unwrap();
    assert!((0.1..0.5).contains(&noted.deviation.position_mm) && is_noted(&noted), "{noted}");
    let refused = tilted("0.001").unwrap_err().to_string();
    assert!(
        refused.contains("link \"tool0\": is up to ") && refused.contains("within 0.5 mm and 0.1 deg"),
        "{refused}"
    );
}

/// Frames named `flange` often have their x axis along axis 6: the frame of the last row has z there all the same.
#[test]
fn axis_6_points_out_of_the_flange() {
    for tip in ["tool0", "flange"] {
        let options = ImportOptions { tip_link: Some(tip), ..ImportOptions::default() };
        let kuka = import_robot_text(Path::new("arm.urdf"), &fixture("kuka"), &options).unwrap();
        assert_eq!((kuka.rows[5].d_mm, kuka.rows[5].sign), (215.0, -1.0), "{tip}");
        assert!(kuka.deviation.position_mm < 1e-9);
        assert_eq!(kuka.notes.iter().any(|note| note.contains("is turned against")), tip == "flange");
    }
}

#[test]
fn side_chains_are_named_and_left_out() {
    let abb = import(&fixture("abb")).unwrap();
    let note = abb.notes.iter().find(|note| note.contains("not in the chain")).unwrap();
    assert!(note.contains("\"joint_cylinder\", \"joint_piston\"") && note.contains("parallelogram"), "{note}");
}

/// A closed linkage beside axes 2 and 3, as ros-industrial's description of the M-900iA has it: passive joints on the
/// upper arm and on the forearm that follow joint 3.
#[test]
fn passive_joints_that_follow_joint_3_are_a_parallelogram() {
    let passive = |name: &str, parent: &str, follows: &str| {
        format!(
            "<link name='{name}'/><joint name='p{name}' type='continuous'><origin xyz='0 0.1 0'/><parent link='{parent}'/>\
             <child link='{name}'/><axis xyz='0 1 0'/><mimic joint='{follows}' multiplier='-1'/></joint>\n"
        )
    };
    let with = |joints: &[String]| {
        let text = fixture("fanuc").replace("</robot>", &format!("{}</robot>", joints.concat()));
        import(&text).unwrap()
    };
    let crank = passive("crank", "link_2", "joint_3");
    let rod = passive("rod", "link_3", "joint_3");
    let linked = with(&[crank.clone(), rod.clone()]);
    let note = linked.notes.iter().find(|note| note.contains("linkage = true")).unwrap();
    assert!(
        note.contains("joints \"pcrank\", \"prod\" follow joint \"joint_3\"") && note.contains("data sheet"),
        "{note}"
    );
    assert!(!linked.notes.iter().any(|note| note.contains("not in the chain")));
    let robot = filled(&linked);
    assert!(robot.has_linkage() && robot.geometry().fold == -1.0);
    let [min, max] = robot.sums();
    let sum = robot.sum_range().unwrap();
    assert!((sum.min - min).abs() < 1e-9 && (sum.max - max).abs() < 1e-9);
    // One of them alone is none, and neither is what follows another joint.
    for joints in
        [vec![crank], vec![rod.clone()], vec![passive("a", "link_1", "joint_2"), passive("b", "link_2", "joint_2")]]
    {
        let other = with(&joints);
        assert!(!other.text.contains("axes_2_3") && other.notes.iter().any(|note| note.contains("not in the chain")));
    }
    // The crank may hang on the link before axis 2.
    assert!(filled(&with(&[passive("crank", "link_1", "joint_3"), rod])).has_linkage());
}

#[test]
fn masses_are_those_of_the_urdf_in_the_frames_of_the_rows() {
    let staubli = import(&fixture("staubli")).unwrap();
    let bodies = staubli.bodies.unwrap();
    assert_eq!(bodies.map(|body| body.mass()), [300.0, 220.0, 120.0, 60.0, 20.0, 5.0]);
    // Potential energy at random postures, from the rows and from the links.
    let robot = filled(&staubli);
    let urdf = Urdf::parse(Path::new("arm.urdf"), fixture("staubli")).unwrap();
    let chain = Chain::new(&urdf, &Tree::new(&urdf).unwrap(), None, None).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..50 {
        let values: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.0..3.0));
        let mut frame = staubli.link_from_base;
        for k in 0..6 {
            let row = &staubli.rows[k];
            let theta = row.sign * values[k] + row.offset_deg.to_radians();
            frame = frame.then(&robot.rows()[k]).then(&pose(about_z(theta), [0.0; 3]));
            let last = chain.path.iter().position(|joint| *joint == chain.moving[k]).unwrap();
            let link = forward::link_at(&urdf, &chain, &values, last);
            let body = urdf.links[urdf.joints[chain.moving[k]].child].inertial.unwrap().unwrap().placed(&link);
            let by_row = bodies[k].placed(&frame);
            assert!((by_row.centre() - body.centre()).norm() < 1e-12);
            assert!((by_row.inertia() - body.inertia()).norm() < 1e-10);
        }
    }
    assert!(staubli.text.contains("# mass_kg = 300.0\n") && staubli.text.contains("# damping_nms_per_rad = ?"));
    assert!(import(&fixture("kuka")).unwrap().bodies.is_none());
}

#[test]
fn stiffness_of_another_arm_is_taken_with_its_source() {
    let options = ImportOptions { stiffness_like: Some("kuka-kr270-2"), ..ImportOptions::default() };
    let imported = import_robot_text(Path::new("arm.urdf"), &fixture("kuka"), &options).unwrap();
    let file = TomlFile::new(Path::new("arm.toml"), imported.text.clone().into_bytes()).unwrap();
    let robot = robot_from(&file).unwrap();
    assert_eq!(robot.compliances_at(&[0.0; 6])[1], 1e-6 / 3.32);
    assert!(imported.text.contains("NOT of this arm") && imported.text.contains("Caro et al. 2013, Table II"));
    assert!(imported.notes[0].contains("does not predict millimetres"));
}

#[test]
fn a_file_without_stiffness_is_refused_with_the_ways_to_it() {
    let text = import(&fixture("kuka")).unwrap().text;
    let file = TomlFile::new(Path::new("arm.toml"), text.into_bytes()).unwrap();
    let message = robot_from(&file).unwrap_err().to_string();
    for part in ["joints[1].stiffness_mnm_per_rad: is missing", "identify plan", "--stiffness-like"] {
        assert!(message.contains(part), "{part} in {message}");
    }
    assert_eq!(message.lines().count(), 1);
}

#[test]
fn meshes_are_looked_for_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("urdf/arm.urdf");
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(&file, fixture("kuka")).unwrap();
    let there = folder.path().join("meshes/visual");
    std::fs::create_dir_all(&there).unwrap();
    std::fs::write(there.join("link_1.stl"), "").unwrap();
    let options = ImportOptions { check_meshes: true, ..ImportOptions::default() };
    let notes = import_robot(&file, &options).unwrap().notes;
    let missing = notes.iter().filter(|note| note.contains("is not found")).count();
    assert_eq!((missing, notes.iter().any(|note| note.contains("link_1.stl"))), (6, false), "{notes:?}");
}
