//! `stead import robot`: a robot file from a URDF.

use super::super::Failure;
use super::super::given::Force;
use super::super::output::{print, say_notes};
use super::super::values::{Home, controller, home};
use crate::cli::manual::Manual;
use clap::Args;
use std::path::PathBuf;
use stead::import::{HomePose, ImportOptions, import_robot};
use stead_model::robot::ControllerKind;

#[derive(Debug, Args)]
pub(in super::super) struct RobotOptions {
    /// Robot description (URDF; a xacro file is expanded first)
    pub urdf: PathBuf,
    /// Robot file (TOML) to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Link that the arm starts from [default: base_link, or the root]
    #[arg(long, value_name = "LINK")]
    pub base_link: Option<String>,
    /// Link that is the flange [default: tool0, flange, or the last moving link]
    #[arg(long, value_name = "LINK")]
    pub tip_link: Option<String>,
    /// Take the joint stiffness of a shipped arm, as kuka-kr270-2
    #[arg(long, value_name = "NAME")]
    pub stiffness_like: Option<String>,
    /// Whose controller the arm has
    #[arg(long, value_name = "KIND", value_parser = controller, requires = "home_deg")]
    pub controller: Option<ControllerKind>,
    /// A flange pose read at the controller, ABB also as X,Y,Z,QW,QX,QY,QZ: gives [controller] and [root]
    #[arg(long, value_name = "A1,..,A6=X,Y,Z,A,B,C", value_parser = home, allow_hyphen_values = true, requires = "controller")]
    pub home_deg: Option<Home>,
    /// Look for the mesh files that the URDF names, and note those that are missing
    #[arg(long)]
    pub check_meshes: bool,
    /// Write the <collision> shapes of the links too, and what they look like, to NAME-cell.toml beside the robot file
    #[arg(long)]
    pub collision: bool,
    #[command(flatten)]
    pub force: Force,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead import robot kr120.urdf --out my/kr120.toml",
        "stead import robot cell.urdf --base-link base_link --tip-link tool0 --out my/arm.toml",
        "stead import robot kr210.urdf --stiffness-like kuka-kr270-r2700 --collision --out my/kr210.toml",
        "stead import robot kr210.urdf --controller kuka --out my/kr210.toml \\\n      --home-deg=-31.2,-71.4,63.7,17.9,52.6,-117.3=1791.52,1023.61,1741.52,99.95,-2.34,131.94",
    ],
    written: "as --out names them",
    files: "\
NAME.toml: the robot file
NAME-cell.toml: with --collision: the links as shapes of surroundings",
    remarks: "Joint stiffness is not in a URDF: its six lines are written commented out, or with --stiffness-like \
              taken from a shipped arm (`stead robots` lists them), which ranks placements and does not predict \
              millimetres.",
    refused: "wrong usage, a URDF that is refused, with line and element, or a file that is there already (--force replaces it): nothing is written",
    ..Manual::NEW
};

pub(super) fn run(options: &RobotOptions) -> Result<(), Failure> {
    let home = options.controller.zip(options.home_deg.as_ref());
    let home = home.map(|(kind, (angles, flange))| HomePose::new(kind, *angles, flange)).transpose();
    let home = home.map_err(stead::Error::from)?;
    let requested = ImportOptions {
        base_link: options.base_link.as_deref(),
        tip_link: options.tip_link.as_deref(),
        stiffness_like: options.stiffness_like.as_deref(),
        home,
        check_meshes: options.check_meshes,
        collision: options.collision,
    };
    let robot = import_robot(&options.urdf, &requested).map_err(stead::Error::from)?;
    robot.write(&options.out, options.force.existing()).map_err(stead::Error::from)?;
    say_notes(&robot.notes);
    let files: Vec<String> = robot.files(&options.out).iter().map(|(file, _)| file.display().to_string()).collect();
    print(format!("{robot}\nwritten: {}\n", files.join(", ")).as_bytes())
}
