//! The user guide.
//!
//! | question | page |
//! |---|---|
//! | How do I get it to run, on Windows too? | [`install`] |
//! | How do I begin with my own cell? | [`your_cell`], [`starting`] |
//! | How do I get a tool path from my CAM system? | [`import_path`] |
//! | How large are the forces of the cut, from the path and the stock? | [`forces`] |
//! | How do I get a robot file from a URDF? | [`import_robot`] |
//! | Which arms are there, and does my file agree with the controller? | [`robots`] |
//! | What must the robot not hit? | [`surroundings`] |
//! | Where should the workpiece stand? | [`place`], [`score`], [`explain`] |
//! | Is the robot on a wall, the part on its side, a rail or a turntable there? | [`cell_setup`] |
//! | May the tool lean, to cut with less deflection or where the spindle has no room? | [`lean`] |
//! | What is minimised, and is it what spoils the part? | [`objective`] |
//! | What does a placement come to while I move the part by hand? | [`live`] |
//! | How do I show it to others? | [`page`] |
//! | How far is that from the optimum? | [`certify`] |
//! | Which robot, pedestal, mounting or stiffness: how do many variants compare? | [`study`], [`study_file`], with figures [`studies`] |
//! | How good is a robot for machining? | [`assess`] |
//! | How stiff are the joints of my robot? | [`identify`] |
//! | What of links, base, spindle, tool and part? | [`whole_arm`] |
//! | What must be commanded so that the deflected tool follows the path? | [`compensate`] |
//! | How do I get the plan onto the robot? | [`export`] |
//! | Will the cut chatter? | [`stability`] |
//! | What do forces and surface look like over time? | [`simulate`] |
//! | How round is a measured profile? | [`circularity`] |
//! | How do I use stead from Rust, from Python? | [`library`], [`python`] |
//! | How is a wheel, a binary or a crate made of it? | [`release`] |
//! | Which direction is positive? | [`conventions`] |
//! | What stands in which file? | [`files`], [`run_file`], [`surroundings`], [`robot_file`], [`tables`], results [`columns`], [`assessment_file`], [`identification_file`], [`compensation_file`], [`simulation_file`], [`forces_file`] |
//! | How does it work, and how far can it be trusted? | [`method`], [`validation`] |
//! | What does this message mean? | [`troubleshooting`], [`glossary`] |
//!
//! The pages are the files `src/guide/*.md` of the repository. Their examples in Rust run as tests.

/// A module for every page, with the page as its comment.
macro_rules! pages {
    ($($name:ident),*) => {$(
        #[doc = include_str!(concat!(stringify!($name), ".md"))]
        pub mod $name {}
    )*};
}

pages! {
    assess, assessment_file, cell_setup, certify, circularity, columns, compensate, compensation_file,
    conventions, explain, export, files, forces, forces_file, glossary, identification_file, identify,
    import_path, import_robot, install, lean, library, live, method, objective, page, place, python, release, robot_file,
    robots, run_file, score, simulate, simulation_file, stability, starting, studies, study, study_file,
    surroundings, tables, troubleshooting, validation, whole_arm, your_cell
}
