//! What stands around a robot and on it, from the tables of a run file and of the file that its key `surroundings`
//! names.

mod notes;
mod solid;
mod stock;
mod tables;

pub use stock::{PartTable, PlacedSolid, StockForm, StockTable};
pub use tables::{
    CapsuleTable, CollisionTable, CylinderTable, HalfSpaceTable, KeepOutTable, ShapeTable, SurroundingsFile,
    VisualTable,
};

use crate::mount::MountTable;
use crate::place::Place;
use crate::toml_file::TomlFile;
use std::path::Path;
use std::sync::Arc;
use stead_cell::{Scene, SceneError, Shape, Surroundings, SurroundingsError};
use stead_disk::input::{InputError, InputFile};
use stead_model::external_axis::ExternalAxis;
use stead_model::robot::{Pose, Robot, Spindle};
use tables::axis_of;
pub(crate) use tables::{CLEARANCE, attachment};

/// The scene of a run, where it has one.
#[derive(Debug, Default)]
pub struct SceneRead {
    /// The shapes with the arm; none where no shape is stated.
    pub scene: Option<Arc<Scene>>,
    /// The files that it was read from.
    pub inputs: Vec<InputFile>,
    /// What the user should know of it, in sentences.
    pub notes: Vec<String>,
}

/// The tables of one file, with the place of the table that they are in.
struct Part<'a> {
    tables: SurroundingsFile,
    at: Place<'a>,
}

/// The scene of a run file: the shapes and zones of its own tables and of the file that it names, joined with its arm.
///
/// # Errors
/// [`InputError`] with file, line and field: a shape or zone that cannot be, a mesh that cannot be read, two of one
/// name, a pair of unknown names, a clearance that is stated twice or for nothing, shapes that touch in every posture.
pub fn read_scene(
    own: SurroundingsFile,
    at: &Place<'_>,
    robot: &Robot,
    spindle: &Spindle,
    axes: &[ExternalAxis],
) -> Result<SceneRead, InputError> {
    let named = at.key("surroundings");
    let mut read = SceneRead::default();
    let source = if named.is_given() { Some(named.named_toml("surroundings")?) } else { None };
    let document = source.as_ref().map(|(source, _)| source.parse()).transpose()?;
    let mut parts = Vec::new();
    if let (Some((_, input)), Some(document)) = (&source, &document) {
        read.inputs.push(input.clone());
        parts.push(Part { tables: document.read()?, at: document.root() });
    }
    parts.push(Part { tables: own, at: at.clone() });
    let Some(around) = surroundings(&parts, axes, &mut read.inputs)? else { return Ok(read) };
    let scene = Scene::new(robot, &spindle.flange_from_tool, around).map_err(|error| no_scene(&parts, &error))?;
    read.notes = notes::notes(&scene, robot, spindle);
    read.notes.extend(document.iter().flat_map(|document| document.root().radians("surroundings.")));
    read.scene = Some(Arc::new(scene));
    Ok(read)
}

/// Where the robot of a run stands: the table `[mount]` of the run file itself, or of the surroundings that it names.
///
/// # Errors
/// [`InputError`] for a table that is in both files, for one that is wrong, and for surroundings that cannot be read.
pub fn read_mount(own: Option<&MountTable>, at: &Place<'_>) -> Result<Option<Pose<f64>>, InputError> {
    let own = own.map(|table| table.cell_from_base(&at.key("mount"))).transpose()?;
    let named = at.key("surroundings");
    let theirs = match named.is_given() {
        true => mount_in(&named.named_toml("surroundings")?.0, own.is_some())?,
        false => None,
    };
    Ok(own.or(theirs))
}

/// Where the robot stands by a file of surroundings.
///
/// # Errors
/// [`InputError`] for what is wrong in the file.
pub fn mount_of(file: &Path) -> Result<Option<Pose<f64>>, InputError> {
    mount_in(&TomlFile::read(file)?, false)
}

fn mount_in(source: &TomlFile, is_stated: bool) -> Result<Option<Pose<f64>>, InputError> {
    let document = source.parse()?;
    let tables: SurroundingsFile = document.read()?;
    let at = document.root().key("mount");
    if tables.mount.is_some() && is_stated {
        let allowed = "[mount] in the run file or in its surroundings";
        return Err(at.error("is stated in the run file too", allowed).found_if(None));
    }
    tables.mount.map(|table| table.cell_from_base(&at)).transpose()
}

/// The shapes and zones of a file of its own, without external axes.
///
/// # Errors
/// As [`read_scene`], but for what an arm has to do with.
pub fn read_surroundings(file: &Path) -> Result<Option<Surroundings>, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let part = Part { tables: document.read()?, at: document.root() };
    surroundings(&[part], &[], &mut Vec::new())
}

/// All shapes and zones; the mesh files read are added to the inputs. Nothing where there are none.
fn surroundings(
    parts: &[Part<'_>],
    axes: &[ExternalAxis],
    inputs: &mut Vec<InputFile>,
) -> Result<Option<Surroundings>, InputError> {
    let (mut shapes, mut zones, mut ignored) = (Vec::new(), Vec::new(), Vec::new());
    let mut clearance: Option<f64> = None;
    for Part { tables, at } in parts {
        for (table, number) in tables.shape.iter().flatten().zip(1..) {
            let at = at.key("shape").element(number);
            let (attached, pose) = table.attached_at(axes, &at)?;
            let (solid, file) = table.solid(&at)?;
            inputs.extend(file.filter(|file| !inputs.contains(file)));
            shapes.push(Shape { name: table.name.clone(), attached, solid, pose });
        }
        for (table, number) in tables.keep_out.iter().flatten().zip(1..) {
            zones.push(table.keep_out(axes, &at.key("keep_out").element(number))?);
        }
        let Some(collision) = &tables.collision else { continue };
        if let (Some(_), Some(_)) = (clearance, collision.clearance()) {
            let at = at.key("collision").key("clearance_mm");
            return Err(at.error(
                "is stated in another file too",
                "collision.clearance_mm in the run file or in its surroundings",
            ));
        }
        clearance = clearance.or(collision.clearance());
        // Shapes are known by the number of the axis that carries them.
        let known = |name: String| axis_of(&name, axes).map_or(name, |axis| axis.to_string());
        ignored.extend(collision.ignored().map(|pair| pair.map(known)));
    }
    if shapes.is_empty() && zones.is_empty() {
        for (key, beside) in [("visual", "[[shape]] beside it"), ("collision", "[[shape]] or [[keep_out]] beside it")] {
            if let Some(at) = parts.iter().map(|part| part.at.key(key)).find(Place::is_given) {
                return Err(at.error("is there without anything that could collide", beside).found_if(None));
            }
        }
        return Ok(None);
    }
    let mut visuals = Vec::new();
    for Part { tables, at } in parts {
        for (table, number) in tables.visual.iter().flatten().zip(1..) {
            let (visual, file) = table.visual(&at.key("visual").element(number))?;
            inputs.extend(Some(file).filter(|file| !inputs.contains(file)));
            visuals.push(visual);
        }
    }
    let around = Surroundings::new(shapes, zones, clearance.unwrap_or(CLEARANCE), ignored);
    let around = around.map_err(|error| no_surroundings(parts, &error))?;
    Ok(Some(around.with_visuals(visuals)))
}

/// The places of all shapes and zones of a name, in the order of the files.
fn named<'a>(parts: &'a [Part<'a>], name: &'a str) -> impl Iterator<Item = Place<'a>> {
    parts.iter().flat_map(move |Part { tables, at }| {
        let shapes = tables.shape.iter().flatten().map(|table| &table.name).zip(1..).map(|entry| ("shape", entry));
        let zones = tables.keep_out.iter().flatten().map(|table| &table.name).zip(1..).map(|entry| ("keep_out", entry));
        let of_name = shapes.chain(zones).filter(move |(_, (known, _))| *known == name);
        of_name.map(move |(key, (_, number))| at.key(key).element(number))
    })
}

/// The first table `[collision]`, or where it would be.
fn collision<'a>(parts: &'a [Part<'a>]) -> Option<Place<'a>> {
    let mut places = parts.iter().map(|part| part.at.key("collision"));
    places.clone().find(Place::is_given).or_else(|| places.next())
}

/// What is wrong with all together, at its place.
fn no_surroundings(parts: &[Part<'_>], error: &SurroundingsError) -> InputError {
    match error {
        SurroundingsError::SameName(name) => {
            let place = named(parts, name).last().map(|place| place.key("name"));
            located(place, "is the name of another shape or zone too", "a name that no other has")
        }
        SurroundingsError::UnknownName(name) => {
            let place = parts.iter().find_map(|part| {
                let at = part.at.key("collision").key("ignore");
                let pairs = part.tables.collision.iter().flat_map(|table| table.ignored()).zip(1..);
                let found =
                    pairs.filter_map(|(pair, number)| Some((number, pair.iter().position(|known| known == name)? + 1)));
                found.map(|(pair, side)| at.element(pair).element(side)).next()
            });
            let names = parts.iter().flat_map(|part| part.tables.shape.iter().flatten());
            let known: Vec<&str> = names.map(|table| table.name.as_str()).take(20).collect();
            let allowed = format!("names of shapes ({}), or what shapes are attached to", known.join(", "));
            located(place, "is no shape, and nothing is attached to it", &allowed)
        }
        SurroundingsError::IgnoresItself(_) => {
            let place = parts.iter().find_map(|part| {
                let pairs = part.tables.collision.iter().flat_map(|table| table.ignored()).zip(1..);
                let mut same = pairs.filter(|([first, second], _)| first == second);
                same.next().map(|(_, number)| part.at.key("collision").key("ignore").element(number))
            });
            let place = place.or_else(|| collision(parts));
            located(
                place,
                "names one shape twice",
                "two that may touch each other: a shape is never held against itself",
            )
        }
        SurroundingsError::Clearance => located(collision(parts), &error.to_string(), "a clearance not below 0"),
    }
}

/// Why shapes and arm are no scene, at the shape.
fn no_scene(parts: &[Part<'_>], error: &SceneError) -> InputError {
    match error {
        SceneError::Empty(name) => {
            let place = named(parts, name).next().map(|place| place.key("mesh"));
            located(place, "has nothing that could collide", "a mesh of triangles")
        }
        SceneError::AlwaysTouching(pairs) => {
            let place = pairs.first().and_then(|[first, _]| named(parts, first).next());
            let lines: Vec<String> = pairs.iter().map(|pair| format!("[{:?}, {:?}]", pair[0], pair[1])).collect();
            let allowed = format!("room between them, or [collision] ignore = [{}]", lines.join(", "));
            let touch: Vec<String> = pairs.iter().map(|[a, b]| format!("{a:?} and {b:?}")).collect();
            let problem = format!("is nearer than the clearance in every posture tried: {}", touch.join(", "));
            located(place, &problem, &allowed).found_if(None)
        }
    }
}

fn located(place: Option<Place<'_>>, problem: &str, allowed: &str) -> InputError {
    match place {
        Some(place) => place.error(problem, allowed),
        None => InputError::new("".as_ref(), problem).allowed(allowed),
    }
}
