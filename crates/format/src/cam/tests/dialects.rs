//! What differs from one CAM system to another.

use super::*;

fn in_format(format: CamFormat) -> ReadSettings {
    ReadSettings { format: Some(format), ..settings() }
}

#[test]
fn a_dialect_is_told_from_the_whole_file_whatever_blanks_and_letter_case() {
    let cut = "UNITS/MM\nFEDRAT/600,MMPM\nGOTO/0,0,0\nGOTO/9,0,0\n";
    for (line, format) in [
        ("TOOL PATH/A,TOOL,B", CamFormat::Nx),
        ("tldata / MILL,5,0,20,0,0", CamFormat::Nx),
        ("MSYS/0,0,0,1,0,0,0,1,0", CamFormat::Nx),
        ("CSI_SET_FLUTE_LENGTH / 20", CamFormat::Solidworks),
        ("INSERT/[HOLDER=ER16] 10MM", CamFormat::Solidworks),
        ("RAPID /", CamFormat::Solidworks),
        ("$$-> MFGNO / A", CamFormat::Creo),
        ("$$*          Pro/CLfile  Version 4.0", CamFormat::Creo),
        ("$$     CATIA APT VERSION 1.0", CamFormat::Catia),
        ("MODE / MILL", CamFormat::Autodesk),
        ("APPLY/ TURN", CamFormat::Autodesk),
        ("A1) MCSYS/ NUM, 1, POINT, 0, 0, 0, VECTOR, 1, 0, 0, VECTOR, 0, 1, 0", CamFormat::Autodesk),
        ("CSI_TOOL_PATH/TOP", CamFormat::Camplete),
        ("MODE/MILL\nMCS/1,0,0,0,1,0,0,0,1,0,0,0", CamFormat::Camplete),
        ("$$ a comment", CamFormat::Apt),
        ("RAPID", CamFormat::Apt),
    ] {
        // At the end of a long file too.
        let padding = "COOLNT/ON\n".repeat(3000);
        for text in [format!("{line}\n{cut}FINI\n"), format!("{cut}{padding}{line}\nGOTO/9,9,0\nFINI\n")] {
            let read = program(&text, &settings()).unwrap_or_else(|e| panic!("{line}: {e}"));
            assert_eq!(read.format, format, "{line}");
            assert!(task(&text, &settings()).1.to_string().starts_with(&format!("format    {}\n", format.word())));
        }
        let stated = program(&format!("{line}\n{cut}FINI\n"), &in_format(CamFormat::Apt)).unwrap();
        assert_eq!(stated.format, CamFormat::Apt);
    }
    // What both have is of the system whose words they are.
    let nx = program(&format!("$$ from a CATIA model\nTOOL PATH/A,TOOL,B\nRAPID/\n{cut}FINI\n"), &settings()).unwrap();
    assert_eq!(nx.format, CamFormat::Nx);
}

#[test]
fn three_numbers_behind_a_tilted_axis_hold_it_or_stand_upright_by_the_dialect() {
    let text = "UNITS/MM\nMULTAX/ON\nFEDRAT/600,MMPM\nGOTO/0,0,0,0.6,0,0.8\nGOTO/9,0,0,0.6,0,0.8\nMULTAX/OFF\nGOTO/9,9,0\nFINI\n";
    for (format, is_held) in [
        (CamFormat::Nx, true),
        (CamFormat::Solidworks, true),
        (CamFormat::Catia, true),
        (CamFormat::Creo, false),
        (CamFormat::Autodesk, false),
        (CamFormat::Camplete, false),
    ] {
        let read = program(text, &in_format(format)).unwrap();
        assert_eq!((read.moves[2].axis - Vector3::z()).norm() > 0.1, is_held, "{format:?}");
    }
    refused(text, &settings(), ":7: GOTO", &["three numbers behind MULTAX/OFF", "--format catia"]);
    assert!(program(&text.replace("MULTAX/OFF\n", ""), &settings()).is_ok());
}

#[test]
fn words_that_nobody_knows_are_noted_with_their_lines_and_refused_with_three_numbers() {
    let cut = "FEDRAT/600,MMPM\nGOTO/0,0,0\nGOTO/9,0,0\nFINI\n";
    let known = format!("UNITS/MM\nQUILLX/3,ON\nOPTIMA\nQUILLX/OFF\nCSI_NEW/1,2,3,4\n{cut}");
    let said = task(&known, &settings()).1.to_string();
    for part in ["OPTIMA (line 3)", "QUILLX (lines 2, 4)"] {
        assert!(said.contains(&format!("not known, taken not to move the tool: {part}")), "{said}");
    }
    assert!(said.contains("words passed over: CSI_NEW (line 5)"), "{said}");
    let many = format!("UNITS/MM\n{}{cut}", "OPTIMA\n".repeat(9));
    assert!(task(&many, &settings()).1.to_string().contains("OPTIMA (9 times, first in lines 2, 3, 4, 5, 6)"));
    let moving = format!("UNITS/MM\nSWEEPX/1,2,3\n{cut}");
    refused(&moving, &settings(), ":2: SWEEPX", &["may move the tool", "--ignore SWEEPX"]);
    let ignoring = |word: &str| ReadSettings { ignore: vec![word.to_owned()], ..settings() };
    let said = task(&moving, &ignoring("sweepx")).1.to_string();
    assert!(said.contains("SWEEPX passed over, as asked (--ignore) (line 2)"), "{said}");
    let transformed = format!("UNITS/MM\nTRACUT/NOMORE\n{cut}");
    refused(&transformed, &settings(), ":2: TRACUT", &["a transformation", "--ignore TRACUT"]);
    assert!(task(&transformed, &ignoring("TRACUT")).1.to_string().contains("TRACUT passed over"));
    let all = "UNITS/MM\nFEDRAT/600,MMPM\nFROM/0,0,9\nRAPID\nGOTO/0,0,0\nCIRCLE/5,0,0,0,0,1\nGOTO/10,0,0\nFINI\n";
    for (word, line) in [("GOTO", 5), ("circle", 6), ("RAPID", 4), ("FROM", 3), ("FINI", 8)] {
        let place = format!(":{line}: {}", word.to_uppercase());
        refused(all, &ignoring(word), &place, &["of the path itself", "do not move the tool"]);
    }
}

#[test]
fn comments_go_on_over_lines_and_take_no_move_with_them() {
    let text = "$$* Pro/CLfile\n$$-> CUTTER / $\n 14.0\n$$-> MFGNO / $\n A $ $$ more\n B\nUNITS / MM\nFEDRAT / 600, MMPM\n\
                GOTO / 0, 0, 0\n$$ five $\nGOTO / 9, $ $$ behind\n$$ between\n 0, 0\n$$ 5 $$\nGOTO / 9, 9, 0\nFINI\n";
    let read = program(text, &settings()).unwrap();
    assert_eq!(read.moves.iter().map(|one| one.line).collect::<Vec<_>>(), [9, 11, 15]);
    assert_eq!(read.tools_from[0].1.diameter, Some(0.014));
}

/// Places of a program in mm.
fn places(text: &str, settings: &ReadSettings) -> Vec<Vector3<f64>> {
    program(text, settings).unwrap_or_else(|e| panic!("{e}")).moves.iter().map(|one| one.position * 1e3).collect()
}

#[test]
fn points_of_creo_go_on_along_their_arc_and_helices_rise_up_to_a_turn() {
    let creo = in_format(CamFormat::Creo);
    let on = |goto: &str| {
        format!("UNITS/MM\nFEDRAT/600,MMPM\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\n{goto}\nGOTO/-10,-20,0\nFINI\n")
    };
    let radii = |text: &str| {
        let places = places(text, &creo);
        places[..places.len() - 1].iter().map(|place| (place.xy().norm() - 10.0).abs()).fold(0.0, f64::max)
    };
    for goto in [
        "GOTO/0,10,0\nGOTO/-10,0,0\nGOTO/0,-10,0",
        "GOTO/0,10,0,-10,0,0,0,-10,0",
        "GOTO/0,10,0,-10,0,0",
        "GOTO/0,10,0,0,0,1\nGOTO/-10,0,0",
        "GOTO/0,10,2\nGOTO/-10,0,4",
    ] {
        assert!(radii(&on(goto)) < 1e-9, "{goto}");
    }
    // A statement in between, another radius, another rise: straight on.
    for goto in ["GOTO/0,10,0\nFEDRAT/500,MMPM\nGOTO/-10,0,0", "GOTO/0,10,0\nGOTO/0,10,5\nGOTO/-10,0,5"] {
        let moves = program(&on(goto), &creo).unwrap().moves;
        let end = moves.iter().position(|one| one.position.x < -9.9e-3).unwrap();
        assert!(!moves[end].is_fixed, "{goto}");
    }
    let turn = places(&on("GOTO/10,0,-3"), &creo);
    assert!(turn.len() > 30 && turn.iter().any(|place| place.x < -9.9 && (place.z + 1.5).abs() < 0.1));
    refused(&on("GOTO/0,10,2"), &settings(), ":5: GOTO", &["out of its plane"]);
    refused(&on("GOTO/0,10,0,1,1"), &creo, ":5: GOTO", &["5 numbers"]);
}

#[test]
fn arcs_by_angle_by_tangent_and_by_radius() {
    let start = "UNITS/MM\nFEDRAT/600,MMPM\nGOTO/-5,0,0\nGOTO/0,0,0\n";
    let length = |arc: &str, settings: &ReadSettings| {
        let places = places(&format!("{start}{arc}\nFINI\n"), settings);
        places[1..].windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>()
    };
    let quarter = 5.0 * std::f64::consts::PI;
    for (arc, quarters) in [
        ("MOVARC/0,10,0,0,0,1,10,ANGLE,90\nGOTO/10,10,0", 1.0),
        ("MOVARC/0,10,0,0,0,-1,10,ANGLE,270\nGOTO/10,10,0", 3.0),
        // An angle that fits one way alone decides.
        ("MOVARC/0,10,0,0,0,1,10,ANGLE,270\nGOTO/10,10,0", 3.0),
        ("MOVARC/CENTER,0,10,0,AXIS,0,0,1,RADIUS,10\nGOTO/10,10,0", 1.0),
        ("MOVARC/0,10,0,0,0,1,10,ANGLE,360\nGOTO/0,0,0", 4.0),
        ("INDIRV/1,0,0\nTLON,GOFWD/ (CIRCLE/0,10,0,$\n10),ON,(LINE/0,10,0,10,10,0)", 1.0),
        ("INDIRV/-1,0,0\nTLON,GOFWD/(CIRCLE/0,10,0,10),ON,2,INTOF,(LINE/0,10,0,10,10,0)", 3.0),
    ] {
        let found = length(arc, &settings());
        assert!((found / (quarter * quarters) - 1.0).abs() < 2e-3, "{arc}: {found}");
    }
    let camplete = in_format(CamFormat::Camplete);
    for (axis, sweep, quarters) in [(1, 270, 3.0), (-1, 90, 1.0), (1, 90, 1.0)] {
        let found = length(&format!("CIRCLE/0,10,0,0,0,{axis},10,{sweep},0,0,0\nGOTO/10,10,0"), &camplete);
        assert!((found / (quarter * quarters) - 1.0).abs() < 2e-3, "{axis} {sweep}: {found}");
    }
    for (arc, line, parts) in [
        ("MOVARC/0,10,0,0,0,1,10,ANGLE,120\nGOTO/10,10,0", ":6: GOTO", ["turns by 90.000 deg", "120.000 are stated"]),
        ("MOVARC/0,10,0,0,0,1,9,ANGLE,90\nGOTO/10,10,0", ":6: GOTO", ["misses its start", "9.0000 mm"]),
        (
            "INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/0,10,0,9),ON,(LINE/0,10,0,9,10,0)",
            ":6: TLON",
            ["misses its start", "9.0000"],
        ),
        (
            "INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/0,10,0,10),ON,(LINE/0,10,0,9,10,0)",
            ":6: TLON",
            ["misses its end", "9.0000"],
        ),
    ] {
        refused(&format!("{start}{arc}\nFINI\n"), &settings(), line, &parts);
    }
}

#[test]
fn frames_are_applied_and_that_of_creo_names_the_frame_of_all_positions() {
    let text = |frame: &str| format!("UNITS/MM\nFEDRAT/600,MMPM\n{frame}\nGOTO/1,2,3\nGOTO/9,2,3\nFINI\n");
    // x of the frame is y of the part, y is z, z is x; its origin at 10, 20, 30.
    for frame in [
        "MSYS/10,20,30,0,1,0,0,0,1",
        "CSYS/0,0,1,10,1,0,0,20,0,1,0,30",
        "MCS/0,1,0, 0,0,1, 1,0,0, 10,20,30",
        "MCSYS/NUM,1,POINT,10,20,30,VECTOR,0,1,0,VECTOR,0,0,1",
        "ORIGIN/10,20,30,0,1,0,1,0,0",
    ] {
        let at = program(&text(frame), &settings()).unwrap().moves[0];
        assert!((at.position * 1e3 - Vector3::new(13.0, 21.0, 32.0)).norm() < 1e-9, "{frame} {}", at.position);
        assert!((at.axis - Vector3::x()).norm() < 1e-12, "{frame}");
    }
    let catia = "$$ CATIA\n$$*CATIA0\n$$ Program.1 1 2 3\n$$ 0 0 1 10\n$$ 1 0 0 20\n$$ 0 1 0 30";
    assert!((places(&text(catia), &settings())[0] - Vector3::new(13.0, 21.0, 32.0)).norm() < 1e-9);
    assert!((places(&text("ORIGIN/10,20,30"), &settings())[0] - Vector3::new(11.0, 22.0, 33.0)).norm() < 1e-9);
    refused(
        &text("$$ CATIA\n$$*CATIA0\n$$ Program\n$$ 0 0 1 10"),
        &settings(),
        ":4: CATIA0",
        &["4 numbers", "three comments"],
    );
    let creo = in_format(CamFormat::Creo);
    let named = text("$$-> CSYS / 1,0,0,10, $\n 0,1,0,0, 0,0,1,0");
    assert!((places(&named, &creo)[0] - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-9);
    assert!(task(&named, &creo).1.to_string().contains("frame of CSYS: positions are taken as those in it"));
    let twice = named.replace("GOTO/9", "$$-> CSYS / 1,0,0,10, 0,1,0,0, 0,0,1,0\nGOTO/9");
    assert!(program(&twice, &creo).is_ok());
    let other = named.replace("GOTO/9", "$$-> CSYS / 1,0,0,10, 0,1,0,0, 0,0,1,5\nGOTO/9");
    refused(&other, &creo, ":6: CSYS", &["a second coordinate system", "a file for each"]);
}

#[test]
fn tapers_flutes_and_other_shapes_of_cutters() {
    let cut = "FEDRAT/600,MMPM\nGOTO/0,0,0\nGOTO/90,0,0\nFINI\n";
    let tool = |words: &str, format| {
        let text = format!("UNITS/MM\n{words}\n{cut}");
        let path = import_bytes(Path::new("part.apt"), text.as_bytes(), &in_format(format)).unwrap();
        (path.files(Path::new("p.csv")).unwrap()[1].1.clone(), path.notes.join("\n"))
    };
    for (words, format, rows) in [
        ("CUTTER/6,3,0,3,0,10,40", CamFormat::Apt, ["taper_deg = 10.0", "flute_length_mm = 40.0"]),
        ("TLDATA/MILL,6,3,75,5,0", CamFormat::Nx, ["taper_deg = 5.0", "flute_length_mm = 75.0"]),
        (
            "CUTTER/10,0,5,0,0,0,73\nLOAD/TOOL,1\nCSI_SET_FLUTE_LENGTH/22",
            CamFormat::Solidworks,
            ["flute_length_mm = 22.0", "corner"],
        ),
        (
            "CSI_SET_FLUTE_LENGTH/22\nCUTTER/10,2,3,0,0,0,73",
            CamFormat::Solidworks,
            ["flute_length_mm = 22.0", "corner_radius_mm = 2.0"],
        ),
    ] {
        let (text, notes) = tool(words, format);
        assert!(rows.iter().all(|row| *row == "corner" || text.contains(&format!("\n{row} "))), "{words} {text}");
        assert!(!notes.contains("its shape"), "{notes}");
    }
    // The point angle of a drill is no taper.
    assert!(!tool("CUTTER/8,0,0,0,0,59,40", CamFormat::Autodesk).0.contains("taper_deg"));
    for (words, format) in [
        ("TLDATA/TCUTTER,32,0,40,8,12", CamFormat::Nx),
        ("TLDATA/BARREL,12,0,40,8,12", CamFormat::Nx),
        ("TLDATA/MILL,12,0,40,-5,0", CamFormat::Nx),
        ("CUTTER/12,4,7,0,0,0", CamFormat::Catia),
        ("CUTTER/12,4,0,0,0,0", CamFormat::Solidworks),
    ] {
        let (text, notes) = tool(words, format);
        assert!(notes.contains("its shape is not that of a run file"), "{words} {notes}");
        assert!(!text.contains("corner_radius_mm ="), "{text}");
        assert!(words.contains("TLDATA/MILL") || text.contains("\n# flute_length_mm"), "{text}");
    }
    assert!(!tool("CUTTER/12,4,0,0,0,0", CamFormat::Autodesk).1.contains("its shape"));
}
