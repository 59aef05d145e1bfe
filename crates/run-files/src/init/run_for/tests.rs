//! The run file from robots, tasks and what lies beside them.

use super::*;
use crate::run::read_run;
use stead_model::robot::PostureWord;

#[test]
fn the_run_is_read_and_names_its_files_from_its_own_folder() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("tasks")).unwrap();
    let task = folder.join("tasks/part.csv");
    std::fs::write(&task, include_str!("../task.csv")).unwrap();
    let out = folder.join("runs/run.toml");
    init_run(Path::new("name:kuka-kr500"), &task, &out, Existing::Kept).unwrap();
    let text = std::fs::read_to_string(&out).unwrap();
    assert!(text.contains("robot = \"name:kuka-kr500\"\ntask = \"../tasks/part.csv\"\n"), "{text}");
    assert!(!text.contains("[forces]"));
    let run = read_run(&out).unwrap();
    // The cell is in front of the arm, above the floor, within reach.
    let [x, _, z] = run.problem.cell.position;
    assert!(x.min > 1.0 && x.max < run.problem.robot.geometry().reach() && z.min > 0.0);
    // Nor is the path reached over the back of the arm.
    let allowed: Vec<_> =
        run.problem.postures.allowed().map(|posture| run.problem.robot.posture_words(posture)).collect();
    assert!(allowed.len() == 4 && allowed.iter().all(|words| words.has(PostureWord::Front)), "{allowed:?}");
    let message = init_run(Path::new("name:kuka-kr500"), &task, &out, Existing::Kept).unwrap_err().to_string();
    assert!(message.contains("run.toml: is there already"), "{message}");
}

#[test]
fn shapes_beside_the_robot_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("part.csv"), include_str!("../task.csv")).unwrap();
    std::fs::write(at("arm.toml"), shipped::by_name("kuka-kr500").unwrap()).unwrap();
    let made = |out: &str| {
        std::fs::create_dir_all(at("runs")).unwrap();
        init_run(&at("arm.toml"), &at("part.csv"), &at(out), Existing::Kept).unwrap();
        (std::fs::read_to_string(at(out)).unwrap(), read_run(&at(out)).unwrap())
    };
    let (text, run) = made("runs/without.toml");
    assert!(!text.contains("\nsurroundings"));
    assert!(run.notes.iter().any(|note| note.starts_with("collisions were not checked: nothing stands around")));
    let shape = "[[shape]]\nname = 'forearm'\nattached = 'link_3'\ncapsule_mm = { radius = 80, length = 300 }\n";
    std::fs::write(at("arm-cell.toml"), shape).unwrap();
    let (text, run) = made("runs/with.toml");
    assert!(text.contains("\nsurroundings = \"../arm-cell.toml\""), "{text}");
    assert_eq!(run.problem.scene.as_ref().map(|scene| scene.surroundings().shapes().len()), Some(1));
    // Nothing but the arm itself is among the shapes.
    assert!(run.notes.iter().any(|note| note.starts_with("collisions were not checked but between parts of the arm")));
    // With a table in the cell it is not said.
    let table = "[[shape]]\nname = 'table'\nattached = 'base'\nbox_mm = [1000, 1000, 100]\nxyz_mm = [2000, 0, -500]\n";
    std::fs::write(at("arm-cell.toml"), format!("{shape}{table}")).unwrap();
    assert!(
        !read_run(&at("runs/with.toml")).unwrap().notes.iter().any(|note| note.contains("collisions were not checked"))
    );
}

#[test]
fn a_robot_without_stiffness_and_one_with_its_base_above_the_floor_are_minded() {
    let folder = tempfile::tempdir().unwrap();
    let task = folder.path().join("part.csv");
    std::fs::write(&task, include_str!("../task.csv")).unwrap();
    let made = |robot: &str, name: &str| {
        let out = folder.path().join(name);
        init_run(Path::new(robot), &task, &out, Existing::Kept).unwrap();
        std::fs::read_to_string(out).unwrap()
    };
    let abb = made("name:abb-irb6640-235", "a.toml");
    assert!(abb.contains("states no joint stiffness"), "{abb}");
    let out = folder.path().join("a.toml");
    assert!(read_run(&out).unwrap_err().to_string().contains("stiffness_like in the run file"));
    std::fs::write(&out, abb.replace("# stiffness_like", "stiffness_like")).unwrap();
    let run = read_run(&out).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(run.problem.robot.stiffness_like(), Some("KUKA KR 270 R2700"));
    // The rows of this arm begin 750 mm above the floor.
    assert!(made("name:kuka-kr270-2", "b.toml").contains("z_mm = [-340.0, 330.0]"));
}

#[test]
fn the_height_of_the_cell_is_that_of_a_table_or_a_floor_among_the_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // The lowest point of the path is 30 mm below the origin.
    std::fs::write(at("part.csv"), include_str!("../task.csv").replace("1,0,0,0,1,0,0", "1,0,0,-30,1,0,0")).unwrap();
    std::fs::write(at("arm.toml"), shipped::by_name("kuka-kr500").unwrap()).unwrap();
    let heights = |cell: &str| {
        std::fs::write(at("arm-cell.toml"), cell).unwrap();
        init_run(&at("arm.toml"), &at("part.csv"), &at("run.toml"), Existing::Replaced).unwrap();
        let text = std::fs::read_to_string(at("run.toml")).unwrap();
        read_run(&at("run.toml")).unwrap_or_else(|error| panic!("{error}"));
        text.lines().find(|line| line.starts_with("z_mm")).unwrap().to_owned()
    };
    let link = "[[shape]]\nname = 'forearm'\nattached = 'link_3'\ncapsule_mm = { radius = 80, length = 300 }\n";
    let shape = |name: &str, size: &str, place: &str| {
        format!("[[shape]]\nname = '{name}'\nattached = 'base'\nbox_mm = {size}\nxyz_mm = {place}\n")
    };
    let base = shape("base link", "[800, 800, 400]", "[0, 0, 200]");
    let wall = shape("wall", "[20, 4000, 3000]", "[2000, 0, 0]");
    let floor = shape("slab", "[9000, 9000, 100]", "[0, 0, -250]");
    let table = shape("table", "[1000, 1200, 60]", "[1900, 0, 470]");
    // A foot, a link and a wall give no height.
    assert!(heights(&format!("{link}{base}{wall}")).contains("the foot of the robot"));
    let above = heights(&format!("{link}{base}{floor}"));
    assert!(above.contains("# above the floor, which is taken at -200 mm, \"slab\""), "{above}");
    let zone = "[[keep_out]]\nname = 'below'\npoints = ['tool']\nhalf_space = { xyz_mm = [0, 0, -600], normal = [0, 0, -1] }\n";
    assert!(heights(&format!("{link}{zone}")).contains("taken at -600 mm, \"below\""));
    let on = heights(&format!("{link}{base}{wall}{floor}{table}"));
    assert!(on.starts_with("z_mm = [530.0, ") && on.contains("on \"table\" of the surroundings, 500 mm"), "{on}");
}

#[test]
fn the_cutter_beside_the_task_is_taken_and_with_its_cut_gives_the_forces() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let program = "UNITS/MM\nTLDATA/MILL,16.,0.,60.,0.,0.\nSPINDL/RPM,9000,CLW\nFEDRAT/MMPM,1800\nGOTO/0,0,0\nGOTO/60,0,0\nFINI\n";
    std::fs::write(at("part.cls"), program).unwrap();
    let path = stead_format::cam::import_path(&at("part.cls"), &stead_format::cam::ReadSettings::default()).unwrap();
    path.write(&at("part.csv"), Existing::Kept).unwrap();
    let made = || {
        init_run(Path::new("name:kuka-kr500"), &at("part.csv"), &at("run.toml"), Existing::Replaced).unwrap();
        let run = read_run(&at("run.toml")).unwrap_or_else(|error| panic!("{error}"));
        (std::fs::read_to_string(at("run.toml")).unwrap(), run)
    };
    let (text, guessed) = made();
    assert!(
        text.contains("\ncutter_diameter_mm = 16.0 ")
            && text.contains("\ndepth_mm = 4.0 ")
            && text.contains("one level, so its depth is not in the path"),
        "{text}"
    );
    assert!(!text.contains("\n[forces]") && text.contains("\nspindle_rpm = 9000.0 "), "{text}");
    assert!(guessed.notes.iter().any(|note| note.contains("removes of [stock]")), "{:?}", guessed.notes);
    assert!(text.contains("\nfeed_mm_per_s = 30.0 ") && text.contains("whose own feeds count: 30.0 to 30.0"), "{text}");
    assert!(!text.contains("The cutter of part.cls"), "{text}");
    // All of it taken in, as the user would.
    let tool = std::fs::read_to_string(at("part-tool.toml")).unwrap();
    let keys = ["milling", "radial", "axial", "feed_per"];
    let tool = keys.iter().fold(tool, |text, key| text.replace(&format!("# {key}"), key));
    std::fs::write(at("part-tool.toml"), tool).unwrap();
    let (text, cut) = made();
    assert!(!text.contains("\n[forces]") && !text.contains("\n[stock]"), "{text}");
    assert!(cut.problem.task.loads()[1].wrench.force.norm() > 1.0 && cut.problem.task != guessed.problem.task);
    std::fs::write(at("part-tool.toml"), "[tool]\ncutter_diameter_mm = 0\n").unwrap();
    let refused = init_run(Path::new("name:kuka-kr500"), &at("part.csv"), &at("run.toml"), Existing::Replaced);
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("part-tool.toml:2: tool.cutter_diameter_mm: "), "{message}");
}
