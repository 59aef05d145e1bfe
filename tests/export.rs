//! `stead export` from outside: programs of the shipped plan, read back, and what is refused.

use crate::common::{Bench, Ended, RUN};

const PLAN: &str = "plan/best.csv";
const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const KRL: [&str; 5] = ["export", RUN, PLAN, "--format", "krl"];
/// As the comment of the shipped file says that the controller counts, with the base at the height of axis 2.
const CONTROLLER: &str = "\
    [controller]\nkind = 'kuka'\nsign = [-1, -1, -1, -1, -1, -1]\noffset_deg = [0, 0, -90, 0, 0, 0]\n\
    [root]\nxyz_mm = [0, 0, 750]\nabc_deg = [0, 0, 0]\n";

/// A bench with the shipped plan of the published case, and with these tables of the controller.
fn bench_with(controller: &str) -> Bench {
    let bench = Bench::new();
    bench.copy("results/caro-2013/best.csv", PLAN);
    let mut robot: toml::Table = bench.read(ROBOT).parse().unwrap();
    for name in ["controller", "root"] {
        robot.remove(name);
    }
    robot.extend(controller.parse::<toml::Table>().unwrap());
    bench.write(ROBOT, &toml::to_string(&robot).unwrap());
    bench
}

fn bench() -> Bench {
    bench_with(CONTROLLER)
}

fn export(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&KRL[..], &["--out", "p/PART"], more].concat())
}

fn check(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["export", RUN, PLAN, "--check", "p/PART.src"], more].concat())
}

#[test]
fn a_program_is_written_with_its_frames_and_read_back() {
    let bench = bench();
    let ended = export(&bench, &["--max-moves", "70"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for part in [
        "PART: krl for KUKA KR270-2\n5 segments, 115 moves (5 to joint angles, 110 on lines) in 2 parts\n",
        "  $BASE    X 0.0284  Y -1640.0000  Z 536.0000  A 78.96",
        "  $TOOL    X 0.0000  Y 0.0000  Z 454.0000  A 90.000000  B 0.000000  C 45.000000 ",
        "written:\n  p/PART.src\n  p/PART_01.src\n  p/PART_02.src\n",
    ] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    assert_eq!(bench.names("p"), ["PART.src", "PART_01.src", "PART_02.src"]);

    let read = check(&bench, &[]);
    assert_eq!(read.code, Some(0), "{}", read.stderr);
    assert!(read.stdout.contains("p/PART.src: 115 moves read back, 5 to joint angles; the plan asks for 115\n"));
    let document = check(&bench, &["--json"]).json();
    assert_eq!((&document["sound"], &document["mismatch"]), (&true.into(), &serde_json::Value::Null));
    assert!(document["position_mm"]["value"].as_f64().unwrap() < 0.003, "{document}");
    assert_eq!(document["inputs"].as_array().unwrap().len(), 5);

    let json = bench.stead(&[&KRL[..], &["--out", "q/PART", "--json"]].concat()).json();
    assert_eq!((&json["linear_moves"], &json["parts"]), (&110.into(), &1.into()));
    assert!((json["frames"][1]["abc_deg"][0].as_f64().unwrap() - 90.0).abs() < 1e-6);
}

#[test]
fn a_program_that_was_changed_is_not_that_of_the_plan() {
    let bench = bench();
    assert_eq!(export(&bench, &[]).code, Some(0));
    bench.replace("p/PART_01.src", "LIN {X -192.000,Y 390.400", "LIN {X -192.000,Y 390.450");
    let changed = check(&bench, &[]);
    assert_eq!(changed.code, Some(1));
    assert!(changed.stdout.contains("largest deviation in position: 0.05"), "{}", changed.stdout);
    assert!(changed.stdout.contains("(segment 1, point 1)"), "{}", changed.stdout);
    changed.assert_says(&["error: p/PART.src: is not the program of this plan within 0.01 mm and 0.01 deg; allowed: "]);
    let line = bench.replace("p/PART_01.src", "LIN {X -192.000,Y 390.450", "CIRC {X -192.000,Y 390.450");
    let not_understood = check(&bench, &[]);
    assert_eq!((not_understood.code, not_understood.stdout.as_str()), (Some(2), ""));
    not_understood.assert_says(&[&format!("PART_01.src:{line}: is not understood"), "; allowed: "]);
    let other = bench.stead(&["export", RUN, PLAN, "--check", "p/PART_01.src", "--approach-mm", "40"]);
    assert_eq!(other.code, Some(2), "{}", other.stdout);
}

#[test]
fn a_corrected_path_is_followed() {
    let bench = bench();
    bench.copy("configs/compensate-caro-2013.toml", "configs/compensate.toml");
    bench.replace("configs/compensate.toml", "caro-2013.toml", "run.toml");
    bench.replace("configs/compensate.toml", "../results/caro-2013/best.csv", "../plan/best.csv");
    assert_eq!(bench.stead(&["compensate", "configs/compensate.toml", "--out", "comp"]).code, Some(0));
    let corrected = ["--corrected", "comp/corrected-path.csv"];
    let ended = export(&bench, &corrected);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let sound = check(&bench, &corrected);
    assert_eq!(sound.code, Some(0), "{}{}", sound.stdout, sound.stderr);
    // It is another path than the plan's.
    assert_eq!(check(&bench, &[]).code, Some(1));

    // A point that could not be corrected.
    let text = bench.read("comp/corrected-path.csv");
    let row = text.lines().find(|line| line.starts_with("7,")).unwrap();
    let kept = row.replace(",corrected", ",a joint limit");
    bench.write("mine/path.csv", &text.replace(row, &kept));
    let more = ["--corrected", "mine/path.csv"];
    let before = bench.tree("");
    let refused = bench.stead(&[&KRL[..], &["--out", "r/PART"], &more].concat());
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    refused.assert_says(&["mine/path.csv:9: status: this point could not be corrected", "--uncorrected-as-planned"]);
    assert_eq!(bench.tree(""), before);
    let more = [&more[..], &["--uncorrected-as-planned"]].concat();
    let ended = bench.stead(&[&KRL[..], &["--out", "r/PART"], &more].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("1 point as planned"), "{}", ended.stdout);
    let sound = bench.stead(&[&["export", RUN, PLAN, "--check", "r/PART.src"], &more[..]].concat());
    assert_eq!(sound.code, Some(0), "{}{}", sound.stdout, sound.stderr);

    // Of another plan, cut off, changed.
    for (from, to, parts) in [
        (row.to_owned(), row.replacen("7,1,", "8,1,", 1), "point: is not that of the plan here"),
        (text.lines().last().unwrap().to_owned(), String::new(), "ends before the plan"),
        (row.to_owned(), format!("{row}\n{row}"), "point: is not that of the plan here"),
        ("target_x_mm".to_owned(), "target_u_mm".to_owned(), "target_x_mm: missing column"),
    ] {
        bench.write("mine/other.csv", &text.replacen(&from, &to, 1));
        let refused = bench.stead(&[&KRL[..], &["--out", "s/PART", "--corrected", "mine/other.csv"]].concat());
        assert_eq!(refused.code, Some(2), "{parts}");
        refused.assert_says(&["mine/other.csv:", parts, "; allowed: "]);
        assert!(!bench.path("s").exists());
    }
}

#[test]
fn a_correction_may_use_up_the_margin_that_the_plan_keeps_from_joint_limits() {
    // Joint 1 of the plan goes up to 104.2999 deg, and corrected to 104.337 deg, at point 61.
    let bench = bench();
    bench.replace(ROBOT, "max_deg = 185.0", "max_deg = 104.4");
    bench.replace(RUN, "min_inverse_condition = 0.2", "min_inverse_condition = 0.2\njoint_margin_deg = 0.1");
    bench.copy("configs/compensate-caro-2013.toml", "configs/compensate.toml");
    bench.replace("configs/compensate.toml", "caro-2013.toml", "run.toml");
    bench.replace("configs/compensate.toml", "../results/caro-2013/best.csv", "../plan/best.csv");
    let ended = bench.stead(&["compensate", "configs/compensate.toml", "--all-or-nothing", "--out", "comp", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(ended.json()["not_corrected"], serde_json::json!([]));
    let corrected = ["--corrected", "comp/corrected-path.csv"];
    let ended = export(&bench, &corrected);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let sound = check(&bench, &corrected);
    assert_eq!(sound.code, Some(0), "{}{}", sound.stdout, sound.stderr);
}

#[test]
fn what_is_refused_leaves_nothing_behind() {
    let bench = bench();
    let row = bench.read(PLAN).lines().nth(8).unwrap().to_owned();
    bench.write("other/moved.csv", &bench.read(PLAN).replace(&row, &row.replacen(',', ",9", 1)));
    bench.write("p/THERE_01.src", "mine");
    let before = bench.tree("");
    let refused = |arguments: &[&str], parts: &[&str]| {
        let ended = bench.stead(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}: {}", ended.stderr);
        ended.assert_says(parts);
        assert_eq!(ended.said().lines().filter(|line| line.starts_with("error: ")).count(), 1, "{}", ended.stderr);
        assert_eq!(bench.tree(""), before, "{arguments:?}");
    };
    let with = |more: &'static [&'static str]| [&KRL[..], more].concat();
    refused(
        &["export", RUN, "other/moved.csv", "--format", "krl", "--out", "p/PART"],
        &["other/moved.csv:9: ", "; allowed: "],
    );
    refused(&["export", RUN, "none.csv", "--format", "krl", "--out", "p/PART"], &["none.csv: cannot be read"]);
    refused(
        &with(&["--out", "p/A_NAME_THAT_IS_TOO_LONG"]),
        &["--out: 'A_NAME_THAT_IS_TOO_LONG' is 23 characters long", "up to 21"],
    );
    refused(&with(&["--out", "p/1PART"]), &["--out: '1PART' does not begin with a letter"]);
    refused(&with(&["--out", "p/PART.src"]), &["--out: 'PART.src' has other characters"]);
    refused(&with(&["--out", ".."]), &["--out: '' does not begin with a letter"]);
    refused(&with(&["--out", "p/THERE"]), &["p/THERE_01.src: is there already, and is left as it is"]);
    refused(
        &["export", RUN, PLAN, "--format", "fanuc", "--out", "p/PART"],
        &["--format: fanuc is not for", "allowed: krl, csv"],
    );
    refused(
        &with(&["--out", "p/PART", "--approach-mm", "-1"]),
        &["--approach-mm: is out of range", "a number from 0 to 1000"],
    );
    refused(&with(&["--out", "p/PART", "--max-moves", "0"]), &["--max-moves: is out of range"]);
    refused(&with(&["--out", "p/PART", "--spindle-on", "a\nb"]), &["--spindle-on: is no statement", "'a\\nb'"]);
    let unreached = bench.stead(&with(&["--out", "p/PART", "--approach-mm", "1000"]));
    assert_eq!((unreached.code, unreached.stdout.as_str()), (Some(1), ""));
    unreached.assert_says(&["error: point 0, ", " mm back along the tool axis before its segment: ", "--approach-mm"]);
    assert_eq!(bench.tree(""), before);
    for (arguments, part) in [
        (&["export", RUN, PLAN, "--out", "p/PART"][..], "--format"),
        (&["export", RUN, PLAN, "--format", "krl"], "--out"),
        (&["export", RUN, PLAN, "--format", "apt", "--out", "p/PART"], "krl, rapid, fanuc, csv"),
        (&["export", RUN, PLAN, "--check", "p/X.src", "--out", "p/PART"], "cannot be used with"),
        (&["export", RUN, PLAN, "--format", "krl", "--out", "p/PART", "--uncorrected-as-planned"], "--corrected"),
    ] {
        let ended = bench.stead(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        ended.assert_says(&[part]);
    }
    assert_eq!(bench.tree(""), before);
}

#[test]
fn a_robot_without_a_controller_gets_a_table() {
    let bench = bench_with("");
    let before = bench.tree("");
    let refused = export(&bench, &[]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    let parts = [
        "error: robots/kuka-kr270-2.toml: controller: is missing, and a program in krl needs it; allowed: ",
        "--format csv",
    ];
    refused.assert_says(&parts);
    assert_eq!(bench.tree(""), before);
    let table = bench.stead(&["export", RUN, PLAN, "--format", "csv", "--out", "p/PART"]);
    assert_eq!(table.code, Some(0), "{}", table.stderr);
    table.assert_says(&["note: the robot file has no [root]"]);
    assert!(!table.stdout.contains("frames at the controller"));
    let sound = bench.stead(&["export", RUN, PLAN, "--check", "p/PART.csv"]);
    assert_eq!(sound.code, Some(0), "{}", sound.stderr);
}

/// A spindle, and what stands around it, for the end of a run file.
fn among(shapes: &str) -> Bench {
    let bench = bench();
    let spindle = "[[shape]]\nname = 'spindle'\nattached = 'flange'\ncylinder_mm = { radius = 85.0, length = 420.0 }\n\
                   xyz_mm = [-275.772, 0.0, 408.228]\nrpy_deg = [0.0, 45.0, 0.0]\n";
    let run = bench.read(RUN);
    bench.write(RUN, &format!("{run}\n{spindle}{shapes}"));
    bench
}

#[test]
fn among_surroundings_the_moves_between_segments_are_free_ways() {
    // In the way from segment 2 to segment 3, and from 4 to 5.
    let bench =
        among("[[shape]]\nname = 'post'\nattached = 'base'\nbox_mm = [200, 200, 1700]\nxyz_mm = [300, -1850, 450]\n");
    let ended = export(&bench, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!ended.stderr.contains("warning: "), "{}", ended.stderr);
    assert!(ended.stdout.contains("116 moves (6 to joint angles, 110 on lines)"), "{}", ended.stdout);
    let part = bench.read("p/PART_01.src");
    // A joint move round the post, and one to the retracted point; after segment 4 a higher lift.
    let (_, way) = part.split_once("\n; segment 3, by a free way\n").unwrap();
    let words: Vec<&str> = way.lines().filter(|line| !line.starts_with(';')).map(|line| &line[..3]).take(3).collect();
    assert_eq!(words, ["PTP", "PTP", "LIN"]);
    let (before, _) = part.split_once("\n; segment 5, by a free way\n").unwrap();
    assert!(before.lines().last().unwrap().starts_with("LIN {X 208.000,Y 8.000,Z 250.000,"), "{before}");
    let read = check(&bench, &[]);
    assert_eq!(read.code, Some(0), "{}{}", read.stdout, read.stderr);
    assert!(read.stdout.contains("116 moves read back, 6 to joint angles; the plan asks for 116\n"), "{}", read.stdout);

    // A via point that was changed: elsewhere than planned, and through the post.
    let (via, rest) = way.split_once("PTP {").map(|(_, rest)| rest.split_once('}').unwrap()).unwrap();
    let (direct, _) = rest.split_once("PTP {").map(|(_, rest)| rest.split_once('}').unwrap()).unwrap();
    bench.replace("p/PART_01.src", via, direct);
    let document = bench.stead(&["export", RUN, PLAN, "--check", "p/PART.src", "--json"]).json();
    assert_eq!(document["sound"], serde_json::Value::from(false));
    assert_eq!(
        (&document["hits"][0]["pair"], &document["hits"][0]["segment"]),
        (&"spindle and post".into(), &3.into())
    );
}

#[test]
fn a_move_without_a_free_way_is_refused_or_a_warning_a_comment_and_found() {
    let bench = among(
        "[[keep_out]]\nname = 'lid'\npoints = ['tool']\nhalf_space = { xyz_mm = [0, 0, 600], normal = [0, 0, 1] }\n",
    );
    let wanted = |a, b| {
        format!("NOT FREE: the move from segment {a} to segment {b} hits (tool and lid), and no free way was found")
    };
    let refused = export(&bench, &[]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""), "{}", refused.stderr);
    refused.assert_says(&[&wanted(2, 3), "--allow-blocked-moves"]);
    assert!(!bench.path("p").exists());

    let ended = export(&bench, &["--allow-blocked-moves"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let warnings: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert_eq!(warnings, [wanted(2, 3), wanted(4, 5)].map(|line| format!("warning: {line}")));
    let part = bench.read("p/PART_01.src");
    assert!(part.contains("; segment 3\n; NOT FREE: this move hits\n; - tool\n; - lid\n; start: "), "{part}");
    assert!(part.contains("; segment 4, by a free way\n"), "{part}");
    let read = check(&bench, &[]);
    assert_eq!(read.code, Some(1), "{}", read.stdout);
    assert!(read.stdout.contains(" hits: tool and lid (segment 3)\n"), "{}", read.stdout);
    read.assert_says(&["error: p/PART.src: 2 moves hit what stands around; allowed: "]);

    let table =
        bench.stead(&["export", RUN, PLAN, "--format", "csv", "--out", "t/PART", "--json", "--allow-blocked-moves"]);
    assert_eq!(table.json()["warnings"].as_array().unwrap().len(), 2);
    let text = bench.read("t/PART.csv");
    assert!(text.lines().next().unwrap().ends_with(",hits"), "{text}");
    assert_eq!(text.lines().filter(|line| line.ends_with(",,\"tool and lid\"")).count(), 2);
}

/// A plan whose joint 6 is a whole turn farther from a point on, which no line of the tool brings about.
#[test]
fn a_line_that_the_arm_cannot_follow_is_refused_or_a_warning_a_comment_and_found() {
    let bench = bench();
    let mut rows: Vec<Vec<String>> =
        bench.read(PLAN).lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    let column = |name: &str| rows[0].iter().position(|column| column == name).unwrap();
    let (angle, turn) = (column("theta6_deg"), column("turn_6"));
    for row in &mut rows[11..22] {
        row[angle] = format!("{:.4}", row[angle].parse::<f64>().unwrap() + 360.0);
        row[turn] = "0".to_owned();
    }
    let text: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    bench.write(PLAN, &(text.join("\n") + "\n"));
    let reason = "joint 6 would go the other way round than planned, and end a whole turn off";
    let told = format!("NOT FREE: the arm cannot follow the straight move of the tool to point 10 ({reason})");
    let refused = export(&bench, &[]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""), "{}", refused.stderr);
    refused.assert_says(&[&told, "--allow-blocked-moves"]);
    assert!(!bench.path("p").exists());

    let ended = export(&bench, &["--allow-blocked-moves"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let warnings: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert_eq!(warnings, [format!("warning: {told}")]);
    let part = bench.read("p/PART_01.src");
    assert_eq!(part.matches(&format!("; NOT FREE: the arm cannot follow this move\n; - {reason}\nLIN ")).count(), 1);
    let read = check(&bench, &[]);
    assert_eq!(read.code, Some(1), "{}", read.stdout);
    let marked = 1 + part.lines().position(|line| line == "; NOT FREE: the arm cannot follow this move").unwrap() + 2;
    let line = format!("p/PART_01.src:{marked} the arm cannot follow: {reason} (segment 1)\n");
    assert!(read.stdout.contains(&line), "{line} in {}", read.stdout);
    read.assert_says(&["error: p/PART.src: 1 move between path points cannot be followed by the arm; allowed: "]);
    let document = check(&bench, &["--json"]).json();
    assert_eq!(
        (&document["unfollowed"][0]["point"], &document["unfollowed"][0]["since"]),
        (&10.into(), &reason.into())
    );

    let table = bench.stead(&["export", RUN, PLAN, "--format", "csv", "--out", "t/PART", "--allow-blocked-moves"]);
    assert_eq!(table.code, Some(0), "{}", table.stderr);
    let text = bench.read("t/PART.csv");
    assert!(text.lines().next().unwrap().ends_with(",unfollowed"), "{text}");
    assert_eq!(text.lines().filter(|line| line.ends_with(&format!(",\"{reason}\""))).count(), 1);
}
