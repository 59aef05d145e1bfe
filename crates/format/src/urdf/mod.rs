//! Robots from URDF files, the robot descriptions of ROS.
//!
//! A URDF is a tree of links and joints, each joint with an origin and an axis in its parent. A robot file is six
//! modified Denavit-Hartenberg rows. [`import_robot`] finds the six joints of the arm, derives the rows, maps limits
//! and speeds, compares both forward kinematics over random postures, and states what a URDF does not know: the
//! stiffness of the joints above all.
//!
//! ```
//! use stead_format::urdf::{ImportOptions, import_robot};
//! # let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/urdf/fixtures/kuka.urdf");
//! let robot = import_robot(&file, &ImportOptions::default())?;
//! assert_eq!(robot.rows[1].a_mm, 350.0);
//! assert!(robot.deviation.position_mm < 1e-9);
//! # Ok::<(), stead_disk::input::InputError>(())
//! ```

mod arm;
mod bodies;
mod cell_text;
mod collision;
mod deviation;
mod forward;
mod home;
mod meshes;
mod notes;
mod read;
mod rows;
mod stand;
mod stiffness;
mod summary;
mod toml_text;
mod tree;
mod visual;
pub(crate) mod xml;

pub use collision::{LinkShape, LinkShapes};
pub use deviation::{Deviation, POSTURES};
pub use home::HomePose;
pub use rows::ImportedRow;
pub use visual::LinkVisual;

use arm::Arm;
use deviation::deviation;
use home::controller_at;
use read::Urdf;
use std::path::{Path, PathBuf};
use stead_disk::files::new::{Existing, write_all_new};
use stead_disk::input::{InputError, InputFile, input_file, sha256};
use stead_model::plausibility;
use stead_model::robot::{Controller, ControllerKind, Inertial, Pose};
use stiffness::Borrowed;
use xml::{one_line, quoted};

/// What may be asked of an import.
#[derive(Debug, Clone, Copy, Default)]
pub struct ImportOptions<'a> {
    /// The link that the rows start from; `base_link` or the root where left out.
    pub base_link: Option<&'a str>,
    /// The link that is the flange; `tool0`, `flange` or the last moving link where left out.
    pub tip_link: Option<&'a str>,
    /// A shipped arm whose joint stiffness is taken.
    pub stiffness_like: Option<&'a str>,
    /// A pose read at the controller, by which `[controller]` and `[root]` are filled in.
    pub home: Option<HomePose>,
    /// Whether to look for the files of the shapes.
    pub check_meshes: bool,
    /// Whether to read the shapes of the links for collision checks.
    pub collision: bool,
}

/// A robot from a URDF, as a robot file has it.
#[derive(Debug, Clone)]
pub struct ImportedRobot {
    /// The name that the URDF gives.
    pub name: String,
    /// The link that the rows start from.
    pub base_link: String,
    /// The link that the last row is for.
    pub tip_link: String,
    /// The names of the six joints, base first.
    pub joints: [String; 6],
    /// The rows, base first.
    pub rows: [ImportedRow; 6],
    /// Limits of the joint angles of the rows. deg
    pub limits_deg: [[f64; 2]; 6],
    /// Speed of each joint, where the URDF states it. deg/s
    pub max_speed_deg_per_s: [Option<f64>; 6],
    /// What the sum of joints 2 and 3 may be by their ranges, where a parallelogram drives axis 3. deg
    pub linkage_sums_deg: Option<[f64; 2]>,
    /// The base frame of the rows in the base link. m
    pub link_from_base: Pose<f64>,
    /// Where the robot stands by the fixed joints before its base link: the base frame of the rows in the root link,
    /// as `[mount]` has it. Nothing where these joints move it nowhere. m
    pub mount: Option<Pose<f64>>,
    /// The tip link in the frame of the last row. m
    pub flange_from_tip: Pose<f64>,
    /// How far the rows are from the URDF.
    pub deviation: Deviation,
    /// How the controller counts, where a pose read at it tells.
    pub controller: Option<Controller>,
    /// The bodies behind the joints in the frames of the rows, where the URDF states all.
    pub bodies: Option<[Inertial; 6]>,
    /// The shapes of the links, where they were requested.
    pub link_shapes: Option<LinkShapes>,
    /// What the links look like, as far as the URDF says it, where their shapes were requested.
    pub link_visuals: Vec<LinkVisual>,
    /// The description that it was made from.
    pub inputs: Vec<InputFile>,
    /// What the user should know.
    pub notes: Vec<String>,
    /// The robot file.
    pub text: String,
}

/// Rows farther from their URDF than this are refused. mm
const REFUSED_MM: f64 = 0.5;
/// Rows turned farther from their URDF than this are refused. deg
const REFUSED_DEG: f64 = 0.1;
/// Reads a URDF and derives the robot file of its arm.
///
/// # Errors
/// [`InputError`] with file, line and element: a file that is no URDF, links that are no tree, a chain that is not six
/// hinges, a joint without limits, an arm that is no upright elbow arm with a spherical wrist, or rows that miss the
/// URDF by more than 0.5 mm or 0.1 deg.
pub fn import_robot(file: &Path, options: &ImportOptions<'_>) -> Result<ImportedRobot, InputError> {
    imported(&Urdf::read(file)?, options)
}

/// As [`import_robot`], from the text of a file; `file` is its name in messages.
///
/// # Errors
/// Those of [`import_robot`].
#[cfg(any(test, feature = "testing"))]
pub fn import_robot_text(file: &Path, text: &str, options: &ImportOptions<'_>) -> Result<ImportedRobot, InputError> {
    imported(&Urdf::parse(file, text.to_owned())?, options)
}

fn imported(urdf: &Urdf, options: &ImportOptions<'_>) -> Result<ImportedRobot, InputError> {
    let borrowed = options.stiffness_like.map(Borrowed::of).transpose()?;
    let arm = Arm::new(urdf, options.base_link, options.tip_link)?;
    let deviation = deviation(&arm);
    refuse_far(&arm, deviation)?;
    let bodies = bodies::bodies(&arm);
    let linkage_sums_deg = arm.linkage_sums_deg();
    let mut imported = ImportedRobot {
        name: one_line(&urdf.name),
        base_link: urdf.links[arm.chain.base].name.clone(),
        tip_link: urdf.links[arm.chain.tip].name.clone(),
        joints: arm.chain.moving.map(|joint| urdf.joints[joint].name.clone()),
        rows: arm.rows.rows,
        limits_deg: arm.limits_deg,
        max_speed_deg_per_s: arm.speeds_deg,
        linkage_sums_deg,
        link_from_base: arm.rows.link_from_base,
        mount: arm.stand.mount,
        flange_from_tip: arm.rows.flange_from_tip,
        deviation,
        notes: notes::notes(&arm, deviation, borrowed.as_ref(), linkage_sums_deg.is_some()),
        inputs: vec![input_file("robot", urdf.file.display().to_string(), urdf.text.as_bytes())],
        controller: None,
        bodies: bodies.as_ref().ok().copied(),
        link_shapes: None,
        link_visuals: Vec::new(),
        text: String::new(),
    };
    imported.notes.extend(notes::stand(&arm, options.collision));
    imported.notes.extend(plausibility::joint_ranges(&arm.robot));
    let masses = bodies.err().filter(|_| urdf.links.iter().any(|link| link.inertial.is_some()));
    imported.notes.extend(masses.map(|reason| format!("masses and inertias are not taken: {reason}")));
    if let Some(home) = &options.home {
        let (controller, is_own) = controller_at(&arm.robot, &imported.controller_of_urdf(home.kind), home)?;
        let found = "the controller counts its angles otherwise than the URDF: signs, offsets and root are those that agree with --home-deg";
        imported.notes.extend((!is_own).then(|| found.to_owned()));
        imported.controller = Some(controller);
    }
    if options.check_meshes {
        imported.notes.extend(meshes::missing(urdf).iter().map(|name| format!("mesh {} is not found", quoted(name))));
    }
    if options.collision {
        imported.add_shapes(&arm)?;
    }
    imported.text = toml_text::text(&imported, urdf, &sha256(urdf.text.as_bytes()), borrowed.as_ref());
    Ok(imported)
}

impl ImportedRobot {
    /// Adds the shapes of the links, and what they look like.
    fn add_shapes(&mut self, arm: &Arm<'_>) -> Result<(), InputError> {
        let shapes = collision::link_shapes(arm)?;
        if shapes.shapes.is_empty() {
            let allowed = "a URDF with <collision> shapes whose files are there, or an import without --collision";
            let error = InputError::new(&arm.urdf.file, "has no <collision> shape that can be read");
            return Err(error.allowed(allowed));
        }
        let (visuals, notes) = visual::link_visuals(arm, &shapes);
        self.notes.extend(shapes.notes.iter().cloned().chain(notes));
        self.link_visuals = visuals;
        self.link_shapes = Some(shapes);
        Ok(())
    }

    /// A controller that counts as the URDF does, its root at the base link.
    fn controller_of_urdf(&self, kind: ControllerKind) -> Controller {
        let (sign, offset) = (self.rows.map(|row| row.sign), self.rows.map(|row| row.offset_deg.to_radians()));
        Controller { kind, sign, offset, is_j3_level: Some(false), root_from_base: Some(self.link_from_base) }
    }

    /// The files of the robot with their texts: the robot file, and beside it, where the shapes of the links were
    /// requested, that of the surroundings with where the robot stands, these shapes and what the links look like,
    /// `NAME-cell.toml`.
    pub fn files(&self, file: &Path) -> Vec<(PathBuf, String)> {
        let mut files = vec![(file.to_owned(), self.text.clone())];
        if let Some(shapes) = &self.link_shapes {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy();
            let cell = file.with_file_name(format!("{stem}-cell.toml"));
            let text = cell_text::text(self, shapes, &cell);
            files.push((cell, text));
        }
        files
    }

    /// Writes these files; folders to them are made.
    ///
    /// # Errors
    /// [`InputError`] where a file exists and is to be kept, or cannot be written: nothing is changed then.
    pub fn write(&self, file: &Path, existing: Existing) -> Result<(), InputError> {
        let files = self.files(file);
        let texts: Vec<(PathBuf, &str)> = files.iter().map(|(file, text)| (file.clone(), text.as_str())).collect();
        write_all_new(&texts, existing, &self.inputs)
    }
}

fn refuse_far(arm: &Arm<'_>, deviation: Deviation) -> Result<(), InputError> {
    let Deviation { position_mm, angle_deg } = deviation;
    if position_mm <= REFUSED_MM && angle_deg <= REFUSED_DEG {
        return Ok(());
    }
    let link = &arm.urdf.links[arm.chain.tip];
    let problem =
        format!("is up to {position_mm:.3} mm and {angle_deg:.4} deg from where Denavit-Hartenberg rows have it");
    let allowed = "axes that meet and are at right angles so well that it is within 0.5 mm and 0.1 deg";
    Err(arm.urdf.error(link.byte, format!("link {}", quoted(&link.name)), problem, allowed))
}

#[cfg(test)]
mod tests;

/// The last link of a URDF's arm at its joint values (rad) in the frame of the first, through the URDF's own joint
/// origins and axes: an oracle of tests.
#[cfg(feature = "testing")]
#[expect(clippy::unwrap_used, reason = "for tests alone")]
pub fn tip_at(text: &str, joints: &[f64; 6]) -> Pose<f64> {
    let urdf = read::Urdf::parse(Path::new("arm.urdf"), text.to_owned()).unwrap();
    let chain = tree::Chain::new(&urdf, &tree::Tree::new(&urdf).unwrap(), None, None).unwrap();
    forward::tip_at(&urdf, &chain, joints)
}
