//! The user guide.
//!
//! | question | page |
//! |---|---|
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

#[doc = include_str!("assess.md")]
pub mod assess {}
#[doc = include_str!("assessment_file.md")]
pub mod assessment_file {}
#[doc = include_str!("cell_setup.md")]
pub mod cell_setup {}
#[doc = include_str!("certify.md")]
pub mod certify {}
#[doc = include_str!("circularity.md")]
pub mod circularity {}
#[doc = include_str!("columns.md")]
pub mod columns {}
#[doc = include_str!("compensate.md")]
pub mod compensate {}
#[doc = include_str!("compensation_file.md")]
pub mod compensation_file {}
#[doc = include_str!("conventions.md")]
pub mod conventions {}
#[doc = include_str!("explain.md")]
pub mod explain {}
#[doc = include_str!("export.md")]
pub mod export {}
#[doc = include_str!("files.md")]
pub mod files {}
#[doc = include_str!("forces.md")]
pub mod forces {}
#[doc = include_str!("forces_file.md")]
pub mod forces_file {}
#[doc = include_str!("glossary.md")]
pub mod glossary {}
#[doc = include_str!("identification_file.md")]
pub mod identification_file {}
#[doc = include_str!("identify.md")]
pub mod identify {}
#[doc = include_str!("import_path.md")]
pub mod import_path {}
#[doc = include_str!("import_robot.md")]
pub mod import_robot {}
#[doc = include_str!("lean.md")]
pub mod lean {}
#[doc = include_str!("library.md")]
pub mod library {}
#[doc = include_str!("live.md")]
pub mod live {}
#[doc = include_str!("method.md")]
pub mod method {}
#[doc = include_str!("objective.md")]
pub mod objective {}
#[doc = include_str!("page.md")]
pub mod page {}
#[doc = include_str!("place.md")]
pub mod place {}
#[doc = include_str!("python.md")]
pub mod python {}
#[doc = include_str!("release.md")]
pub mod release {}
#[doc = include_str!("robot_file.md")]
pub mod robot_file {}
#[doc = include_str!("robots.md")]
pub mod robots {}
#[doc = include_str!("run_file.md")]
pub mod run_file {}
#[doc = include_str!("score.md")]
pub mod score {}
#[doc = include_str!("simulate.md")]
pub mod simulate {}
#[doc = include_str!("simulation_file.md")]
pub mod simulation_file {}
#[doc = include_str!("stability.md")]
pub mod stability {}
#[doc = include_str!("starting.md")]
pub mod starting {}
#[doc = include_str!("studies.md")]
pub mod studies {}
#[doc = include_str!("study.md")]
pub mod study {}
#[doc = include_str!("study_file.md")]
pub mod study_file {}
#[doc = include_str!("surroundings.md")]
pub mod surroundings {}
#[doc = include_str!("tables.md")]
pub mod tables {}
#[doc = include_str!("troubleshooting.md")]
pub mod troubleshooting {}
#[doc = include_str!("validation.md")]
pub mod validation {}
#[doc = include_str!("whole_arm.md")]
pub mod whole_arm {}
#[doc = include_str!("your_cell.md")]
pub mod your_cell {}
