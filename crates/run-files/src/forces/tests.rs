use super::*;
use stead_cell::Solid;
use stead_model::robot::Pose;

/// A run on one straight cut of a block, `[stock]` on line 2.
const TEXT: &str = "path = 'part.csv'
[stock]
box_mm = [80, 26, 20]
xyz_mm = [40, 17, -10]
[tool]
cutter_diameter_mm = 16
flute_length_mm = 30
teeth = 4
kt_mpa = 800
kr = 0.4
kte_n_per_mm = 20
kre_n_per_mm = 20
[cut]
spindle_rpm = 6000
";

const PATH: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,feed_mm_per_s
1,-20,0,-5,1,0,0,0,0,1,20
1,0,0,-5,1,0,0,0,0,1,20
1,60,0,-5,1,0,0,0,0,1,20
";

const PROGRAM: &str = "%\nG90 G21 G17\nT1 M6\nS6000 M3\nG0 X-20 Y0 Z50\nG0 Z-5\nG1 X60 F1200\nG0 Z50\nG0 X-20 Y-4\nG0 Z-5\nG1 X60\nG0 Z50\nM30\n%\n";

/// The form of stock and its pose.
fn solid(stock: &Stock) -> (Solid, Pose<f64>) {
    match stock {
        Stock::Solid { solid, pose } => (solid.clone(), *pose),
        Stock::Path(_) => panic!("a form"),
    }
}

/// A cube of 20 mm, with or without its top.
fn cube(is_closed: bool) -> String {
    let mut text = String::from("v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 20\nv 20 0 20\nv 20 20 20\nv 0 20 20\n");
    text.push_str("f 1 4 3\nf 1 3 2\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n");
    if is_closed {
        text.push_str("f 5 6 7\nf 5 7 8\n");
    }
    text
}

fn read(text: &str) -> Result<ForcesRun, InputError> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("part.csv", PATH);
    write("bare.csv", &PATH.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect::<String>());
    write("part.nc", PROGRAM);
    write("cube.obj", &cube(true));
    write("open.obj", &cube(false));
    write("forces.toml", text);
    read_forces(&folder.path().join("forces.toml"))
}

#[test]
fn a_file_becomes_what_is_to_be_cut() {
    let run = read(TEXT).unwrap();
    let ForcesProblem { stock, before, operation, finished_part, cell, memory } = &run.problem;
    let (stock, pose) = solid(stock);
    assert!(matches!(stock, Solid::Box(edges) if (edges.x - 0.08).abs() < 1e-12));
    assert!((pose.translation.y - 0.017).abs() < 1e-12);
    assert!(before.is_empty() && finished_part.is_none() && cell.is_none());
    assert_eq!((*memory, operation.spindle_speed), (2e9, 100.0));
    assert_eq!((operation.mill.flute_length, operation.mill.corner_radius, operation.mill.taper), (0.03, 0.0, 0.0));
    assert!(operation.mill.is_centre_cutting && operation.path.feed(1) == Some(0.02));
    assert_eq!(run.inputs.iter().map(|input| input.role).collect::<Vec<_>>(), ["config", "path"]);
    let shaped = "corner_radius_mm = 2\ntaper_deg = 3\ncentre_cutting = false\nholder_mm = [[30, 16], [40, 50]]\nteeth";
    let mill = read(&TEXT.replace("teeth", shaped)).unwrap().problem.operation.mill;
    assert_eq!((mill.corner_radius, mill.is_centre_cutting, mill.holder.len()), (0.002, false, 2));
    assert!((mill.taper.to_degrees() - 3.0).abs() < 1e-12);
}

#[test]
fn a_program_brings_its_rapid_moves_and_its_spindle_speed() {
    let text = TEXT.replace("part.csv", "part.nc").replace("[cut]\nspindle_rpm = 6000\n", "");
    let run = read(&text).unwrap();
    let rapids: Vec<Vec<[f64; 3]>> = run
        .problem
        .operation
        .rapids
        .iter()
        .map(|rapids| rapids.iter().map(|at| (at.position * 1e3).into()).collect())
        .collect();
    assert_eq!(rapids.len(), 3);
    assert_eq!(rapids[0], [[-20.0, 0.0, 50.0]]);
    assert_eq!(rapids[1], [[60.0, 0.0, 50.0], [-20.0, -4.0, 50.0]]);
    assert_eq!(rapids[2], [[60.0, -4.0, 50.0]]);
    assert!((run.problem.operation.spindle_speed - 100.0).abs() < 1e-9);
    assert!(run.notes.iter().any(|note| note.contains("6000 1/min")), "{:?}", run.notes);
}

#[test]
fn stock_may_be_a_cylinder_a_mesh_or_about_the_path() {
    let with = |stock: &str| read(&TEXT.replace("box_mm = [80, 26, 20]\nxyz_mm = [40, 17, -10]", stock)).unwrap();
    let cylinder = with("cylinder_mm = { radius = 30, length = 20 }\nxyz_mm = [0, 0, -10]").problem.stock;
    assert_eq!(solid(&cylinder).0, Solid::Cylinder { radius: 0.03, length: 0.02 });
    let mesh = with("mesh = 'cube.obj'");
    assert!(matches!(solid(&mesh.problem.stock).0, Solid::Mesh(_)) && mesh.inputs.last().unwrap().role == "mesh");
    let about = with("allowance_mm = [10, 20, 2]").problem.stock;
    let (about, pose) = solid(&about);
    let [low, high] = about.extent_at(&pose).map(|end| end * 1e3);
    for (found, is) in low.iter().chain(high.iter()).zip([-30.0, -20.0, -5.0, 70.0, 20.0, -3.0]) {
        assert!((found - is).abs() < 1e-9, "{low} {high}");
    }
}

#[test]
fn stock_may_be_what_the_path_passes_over() {
    let with = |stock: &str| read(&TEXT.replace("box_mm = [80, 26, 20]\nxyz_mm = [40, 17, -10]", stock));
    for (keys, is) in [
        ("depth_mm = 4", [Some(4e-3), None]),
        ("layer_mm = 0.5", [None, Some(5e-4)]),
        ("layer_mm = 0.5\ndepth_mm = 12", [Some(12e-3), Some(5e-4)]),
    ] {
        let [depth, layer] = is;
        assert_eq!(with(keys).unwrap().problem.stock, Stock::Path(PathStock { depth, layer }), "{keys}");
    }
    for (keys, parts) in [
        ("depth_mm = 0", &["stock.depth_mm: ", "found 0;"][..]),
        ("depth_mm = 3\nallowance_mm = [1, 1, 1]", &["stock.depth_mm: is a second form beside allowance_mm"]),
        ("layer_mm = 3\nbox_mm = [1, 1, 1]", &["stock.layer_mm: is a second form beside box_mm"]),
        ("depth_mm = 3\nxyz_mm = [1, 1, 1]", &["stock.xyz_mm: is there with stock that lies about the path"]),
        ("layer_mm = 8", &["stock.layer_mm: is out of range", "found 8;", "below half the diameter, 8 mm"]),
    ] {
        let error = with(keys).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn numbers_of_another_unit_are_noted() {
    let notes = |from: &str, to: &str| read(&TEXT.replace(from, to)).unwrap().notes;
    assert!(!notes("", "").iter().any(|note| note.contains("are usual")));
    for (from, to, said) in [
        ("spindle_rpm = 6000", "spindle_rpm = 60", "cut.spindle_rpm is 60.0 1/min"),
        ("kte_n_per_mm = 20", "kte_n_per_mm = 20000", "tool.kte_n_per_mm is 20000 N/mm"),
        ("kr = 0.4", "kr = 40", "tool.kr is 40.0 times kt_mpa"),
        ("box_mm", "cell_mm = 3\nbox_mm", "stock.cell_mm is 3.00 mm"),
        ("box_mm = [80, 26, 20]\nxyz_mm = [40, 17, -10]", "depth_mm = 40", "stock.depth_mm is 40.0 mm"),
    ] {
        let notes = notes(from, to);
        assert!(notes.iter().any(|note| note.starts_with(said)), "{to}: {notes:?}");
    }
}

#[test]
fn published_coefficients_take_the_place_of_those_of_the_tool() {
    let bare = TEXT.replace("kt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n", "");
    let run = read(&format!("material = 'aluminium-7075'\n{bare}")).unwrap();
    assert_eq!(run.problem.operation.mill.cutter.coefficients().tangential, 767.01e6);
    assert!(run.notes.iter().any(|note| note.contains("published ones for aluminium-7075 with")), "{:?}", run.notes);
    let run = read(&format!("material = 'aluminium-7075-hss'\n{bare}")).unwrap();
    let coefficients = run.problem.operation.mill.cutter.coefficients();
    assert_eq!((coefficients.axial, coefficients.radial_edge), (323.33e6, 11.314e3));
    assert!(run.notes.iter().any(|note| note.contains("high-speed steel")), "{:?}", run.notes);
}

#[test]
fn operations_before_are_those_of_other_paths() {
    let tool = "[before.tool]\ncutter_diameter_mm = 20\nflute_length_mm = 40\nteeth = 2\n";
    let run = read(&format!("{TEXT}[[before]]\npath = 'part.nc'\n{tool}")).unwrap();
    assert_eq!((run.problem.before.len(), run.problem.before[0].path.segments().len()), (1, 2));
    // Its shape alone counts, so that it needs no teeth.
    let bare = read(&format!("{TEXT}[[before]]\npath = 'part.nc'\n{}", tool.replace("teeth = 2\n", ""))).unwrap();
    assert_eq!(bare.problem.before[0].mill.profile(), run.problem.before[0].mill.profile());
    let error = read(&format!("{TEXT}[[before]]\npath = 'part.csv'\n{tool}")).unwrap_err().to_string();
    assert!(error.contains("before[1].path: is the path of the operation itself"), "{error}");
}

#[test]
fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
    for (from, to, parts) in [
        ("box_mm = [80, 26, 20]\n", "", &[":2: stock.box_mm: has no form", "allowance_mm"][..]),
        ("box_mm", "mesh = 'cube.obj'\nbox_mm", &["stock.mesh: is a second form beside box_mm"]),
        ("box_mm = [80, 26, 20]", "mesh = 'open.obj'", &[":3: stock.mesh: is not closed", "found 'open.obj'"]),
        ("box_mm = [80, 26, 20]", "allowance_mm = [1, 1, 1]", &["stock.xyz_mm: is there with stock that lies"]),
        ("box_mm = [80, 26, 20]\nxyz_mm = [40, 17, -10]", "allowance_mm = [1, 0, 1]", &["leaves a box of"]),
        ("box_mm", "unit = 'm'\nbox_mm", &["stock.unit: is for a mesh file"]),
        ("flute_length_mm = 30\n", "", &["tool.flute_length_mm: is missing"]),
        ("teeth = 4", "teeth = 4\ncorner_radius_mm = 9", &["tool.corner_radius_mm: is out of range", "found 9;"]),
        ("teeth = 4", "teeth = 4\ntaper_deg = 60", &["tool.taper_deg: ", "found 60;"]),
        ("kte_n_per_mm = 20\n", "", &["tool.kte_n_per_mm: is missing"]),
        (
            "kt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n",
            "",
            &["tool.kt_mpa: is missing", "material"],
        ),
        ("path =", "material = 'aluminium-7075'\npath =", &["tool.kt_mpa: is given beside material"]),
        ("spindle_rpm = 6000", "axial_depth_mm = 5", &["cut.axial_depth_mm: is given, and the path and the stock"]),
        ("[cut]\nspindle_rpm = 6000\n", "", &["cut.spindle_rpm: is missing", "the speed of the spindle"]),
        ("rpm = 6000", "rpm = 6000\nfeed_per_tooth_mm = 0.1", &["cut.feed_per_tooth_mm: is given, and the path has"]),
        ("part.csv", "bare.csv", &["cut.feed_per_tooth_mm: is missing", "the path has no feeds"]),
        ("part.csv", "none.csv", &[":1: path: names a file that cannot be read"]),
        ("[stock]", "[stok]", &["stok"]),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let message = read(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
    let bare = read(&TEXT.replace("part.csv", "bare.csv").replace("6000", "6000\nfeed_per_tooth_mm = 0.05"));
    assert!((bare.unwrap().problem.operation.path.feed(1).unwrap() - 0.02).abs() < 1e-12);
}

#[test]
fn what_the_job_finds_is_told_at_its_place() {
    let run = read(&TEXT.replace("[40, 17, -10]", "[40, 17, 1000]")).unwrap();
    let error = stead_removal::forces::forces(&run.problem, &stead_numerics::monitor::Monitor::silent()).unwrap_err();
    let message = run.located(&error).to_string();
    assert!(
        message.contains(":2: stock: the path never touches the stock; allowed: stock that the path cuts"),
        "{message}"
    );
}
