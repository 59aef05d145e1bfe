//! Forces files: the config of `stead forces`.

mod file;
pub mod material;
#[cfg(test)]
mod tests;

pub use file::*;

use crate::Word;
use crate::guesses::guesses;
use crate::kind::read_unless;
use material::Material;
use std::path::{Path, PathBuf};
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::cam::{ProgramTool, ReadSettings, import_bytes};
use stead_format::file_kind::FileKind;
use stead_format::place::{Place, required};
use stead_format::quantity::Quantity;
use stead_format::sources::Sources;
use stead_format::surroundings::{PartTable, PlacedSolid, StockForm, StockTable};
use stead_format::toml_file::TomlFile;
use stead_format::tool::{CutTable, Cutting, ToolTable};
use stead_model::cutting::{Coefficients, Cutter, Rotation};
use stead_model::plausibility;
use stead_model::task::ToolPath;
use stead_numerics::message::Note;
use stead_removal::operation::{AirPoint, EndMill, ForcesProblem, Operation, PathStock, Stock};
use stead_runs::KeptForces;
use stead_runs::forces::{ForcesPlaces, ForcesRun};

/// Reads a forces file, the keys of [`ForcesFile`], and the files that it names.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, a path or a mesh that cannot be read, a cutter without a length, coefficients from
/// two places or none, an operation that names its own path as one before it.
pub fn read_forces(file: &Path) -> Result<ForcesRun, InputError> {
    read_forces_from(&TomlFile::read(file)?)
}

/// As [`read_forces`], from a file already read.
pub(crate) fn read_forces_from(source: &TomlFile) -> Result<ForcesRun, InputError> {
    let document = source.parse()?;
    let at = document.root();
    let file: ForcesFile = read_unless(&[FileKind::RobotFile, FileKind::RunFile], source, &document)?;
    let reading = file.reading.unwrap_or_default();
    let named = read_path(&at.key("path"), &reading, &source.sources)?;
    let tables = RemovalTables {
        path_key: "path",
        reading,
        stock: &file.stock,
        tool: &file.tool,
        material: file.material,
        cut: file.cut.as_ref(),
        finished_part: file.finished_part.as_ref(),
        before: file.before.as_deref().unwrap_or_default(),
        is_for_stability: false,
    };
    let mut run = tables.run(named, source, &at)?;
    run.inputs.insert(0, source.as_config());
    let guesses = guesses(file.guesses.as_deref().unwrap_or_default(), &at)?;
    run.notes.splice(0..0, guesses);
    run.notes.extend(at.radians("").into_iter().map(Note::may_be_wrong));
    Ok(run)
}

/// The tables of a forces file or a run file that say what is removed.
#[derive(Debug)]
pub(crate) struct RemovalTables<'a> {
    /// The key that names the path.
    pub path_key: &'static str,
    /// How the paths before are read that do not say it.
    pub reading: ReadingTable,
    pub stock: &'a StockTable,
    pub tool: &'a ToolTable,
    pub material: Option<Word<Material>>,
    pub cut: Option<&'a CutTable>,
    pub finished_part: Option<&'a PartTable>,
    pub before: &'a [BeforeTable],
    /// Whether `[cut]` may describe the cut too, as stability needs it.
    pub is_for_stability: bool,
}

impl RemovalTables<'_> {
    /// What is to be cut along a path; the file of the tables is not among the inputs yet.
    ///
    /// # Errors
    /// Those of [`read_forces`].
    pub fn run(&self, named: NamedPath, source: &TomlFile, at: &Place<'_>) -> Result<ForcesRun, InputError> {
        if let (Some(cut), false) = (self.cut, self.is_for_stability) {
            check_cut(cut, &at.key("cut"))?;
        }
        let of_path = named.tool.and_then(|tool| tool.spindle_speed);
        let (spindle_speed, of_speed) = self.spindle_speed(of_path, &at.key("cut"))?;
        let mill = end_mill(self.tool, self.material, at)?;
        let (path, of_feed) = self.fed(named.path, &mill, spindle_speed, &at.key("cut"))?;
        let (before, of_before): (Vec<_>, Vec<_>) =
            self.before(&named.file, spindle_speed, source, at)?.into_iter().unzip();
        let (stock, of_stock) = self.stock(&path, &mill, &at.key("stock"))?;
        let finished_part = self.finished_part.map(|table| table.mesh(&at.key("finished_part"))).transpose()?;
        let (finished_part, of_part) = finished_part.map(|(mesh, pose, input)| ((mesh, pose), input)).unzip();

        let mut notes = named.notes;
        notes.extend(of_speed.map(Note::from).into_iter().chain(self.material.map(|material| material.0.note())));
        notes.extend(of_feed.map(Note::from));
        let unusual = unusual(self.tool, &mill, &path, spindle_speed, &stock, self.stock.cell());
        notes.extend(unusual.into_iter().map(Note::may_be_wrong));
        let name = named.input.name.clone();
        let inputs = [named.input].into_iter().chain(of_before).chain(of_stock).chain(of_part).collect();
        let problem = ForcesProblem {
            stock,
            before,
            operation: Operation { name, path, rapids: named.rapids, mill, spindle_speed },
            finished_part,
            cell: self.stock.cell(),
            memory: self.stock.memory(),
        };
        let stock_at = at.key("stock");
        let places = ForcesPlaces {
            stock: stock_at.error("", "").found_if(None),
            path: at.key(self.path_key).error("", ""),
            cell: stock_at.key("cell_mm").error("", ""),
        };
        let keep = self.stock.keep(&stock_at).map(|(file, at)| KeptForces::new(file, at));
        Ok(ForcesRun { problem, inputs, notes, keep, places })
    }

    /// The speed of the spindle (rev/s) that the table states, or the path, which a note says.
    fn spindle_speed(&self, of_path: Option<f64>, at: &Place<'_>) -> Result<(f64, Option<String>), InputError> {
        let stated = self.cut.and_then(|cut| cut.spindle_rpm).map(|speed| speed.si() / std::f64::consts::TAU);
        let missing = || at.key("spindle_rpm").missing("the speed of the spindle, which the path does not state");
        let speed = stated.or(of_path).ok_or_else(missing)?;
        let note = || format!("spindle speed {:.0} 1/min, as the path states it", speed * 60.0);
        Ok((speed, stated.is_none().then(note)))
    }

    /// The path with feeds: its own, or that of the feed per tooth at a spindle speed (rev/s), which a note says.
    fn fed(
        &self,
        path: ToolPath,
        mill: &EndMill,
        spindle_speed: f64,
        at: &Place<'_>,
    ) -> Result<(ToolPath, Option<String>), InputError> {
        let per_tooth = self.cut.and_then(|cut| cut.feed_per_tooth_mm);
        let at = at.key("feed_per_tooth_mm");
        if path.feed(0).is_some() {
            return if per_tooth.is_some() && !self.is_for_stability {
                Err(at.error("is given, and the path has feeds", "spindle_rpm alone"))
            } else {
                Ok((path, None))
            };
        }
        let per_tooth = per_tooth.ok_or_else(|| at.missing("the feed per tooth, for the path has no feeds"))?;
        let feed = per_tooth.si() * mill.cutter.teeth().len() as f64 * spindle_speed;
        let feeds = vec![feed; path.points().len()];
        let path = path.with_feeds(feeds).map_err(|error| at.error(error.to_string(), "a feed above 0"))?;
        let note = format!("the path has no feeds: {:.4} mm/s everywhere, by feed_per_tooth_mm", feed * 1e3);
        Ok((path, Some(note)))
    }

    /// The operations before that along the path of a file, each with its input file.
    fn before(
        &self,
        file: &Path,
        spindle_speed: f64,
        source: &TomlFile,
        at: &Place<'_>,
    ) -> Result<Vec<(Operation, InputFile)>, InputError> {
        let operation = |(table, number): (&BeforeTable, usize)| {
            let at = at.key("before").element(number);
            let reading = table.reading.as_ref().unwrap_or(&self.reading);
            let named = read_path(&at.key("path"), reading, &source.sources)?;
            if is_same(&named.file, file) {
                let problem = "is the path of the operation itself";
                return Err(at.key("path").error(problem, "the path of an earlier operation"));
            }
            let mill = shape(&table.tool, outline(&table.tool, &at)?, &at)?;
            let name = named.input.name.clone();
            Ok((Operation { name, path: named.path, rapids: named.rapids, mill, spindle_speed }, named.input))
        };
        self.before.iter().zip(1..).map(operation).collect()
    }

    /// The stock, and the mesh file that it comes from, if there is one.
    fn stock(&self, path: &ToolPath, mill: &EndMill, at: &Place<'_>) -> Result<(Stock, Option<InputFile>), InputError> {
        let (depth, layer) = match self.stock.form(path, at)? {
            StockForm::Solid(PlacedSolid { solid, pose, file }) => return Ok((Stock::Solid { solid, pose }, file)),
            StockForm::Path { depth, layer } => (depth, layer),
        };
        let (most, of) = match mill.corner_radius {
            corner if corner > 0.0 => (corner, "the corner radius"),
            _ => (mill.cutter.radius(), "half the diameter"),
        };
        if layer.is_some_and(|layer| layer >= most) {
            let allowed = format!("a number above 0 and below {of}, {} mm", rounded_mm(most));
            return Err(at.key("layer_mm").out_of_range(allowed));
        }
        Ok((Stock::Path(PathStock { depth, layer }), None))
    }
}

/// Numbers of a cut that look like a wrong unit.
fn unusual(
    tool: &ToolTable,
    mill: &EndMill,
    path: &ToolPath,
    spindle_speed: f64,
    stock: &Stock,
    cell: Option<f64>,
) -> Vec<String> {
    let fastest = (0..path.points().len()).filter_map(|point| path.feed(point)).fold(0.0, f64::max);
    let per_tooth = fastest / spindle_speed / mill.cutter.teeth().len() as f64;
    let of_path = match stock {
        Stock::Path(of_path) => *of_path,
        Stock::Solid { .. } => PathStock::default(),
    };
    let mut numbers = tool.numbers();
    numbers.extend([("cut.spindle_rpm", spindle_speed * 60.0), ("feed per tooth", per_tooth * 1e3)]);
    let lengths = [("stock.cell_mm", cell), ("stock.depth_mm", of_path.depth), ("stock.layer_mm", of_path.layer)];
    numbers.extend(lengths.into_iter().filter_map(|(key, length)| Some((key, length? * 1e3))));
    plausibility::cut(tool.cutter_diameter_mm.written(), &numbers)
}

/// Millimetres without the digits that the unit has brought in.
pub(crate) fn rounded_mm(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

/// Whether two names are of one file.
fn is_same(a: &Path, b: &Path) -> bool {
    let whole = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    whole(a) == whole(b)
}

/// A path with what goes with it.
pub(crate) struct NamedPath {
    /// Where it lies.
    pub file: PathBuf,
    pub path: ToolPath,
    pub rapids: Vec<Vec<AirPoint>>,
    /// What a program says of its tool.
    pub tool: Option<ProgramTool>,
    pub input: InputFile,
    pub notes: Vec<Note>,
}

impl NamedPath {
    /// A path without anything else.
    pub fn plain(file: &Path, path: ToolPath, input: InputFile) -> Self {
        Self { file: file.to_owned(), path, rapids: Vec::new(), tool: None, input, notes: Vec::new() }
    }
}

/// Reads the path that is named here: a program of CAM, or a task file.
fn read_path(at: &Place<'_>, reading: &ReadingTable, sources: &Sources) -> Result<NamedPath, InputError> {
    let named = at.named_file()?;
    path_of(named.name, &named.file, &named.bytes, reading, sources)
}

/// The path of a file already read, by its name for results and its place.
pub(crate) fn path_of(
    name: String,
    file: &Path,
    bytes: &[u8],
    reading: &ReadingTable,
    sources: &Sources,
) -> Result<NamedPath, InputError> {
    let input = input_file("path", &name, bytes);
    let is_cam = reading.format.is_some() || matches!(FileKind::of(bytes), Some(FileKind::Cldata | FileKind::GCode));
    if !is_cam {
        let imported = sources.task(file, bytes)?;
        let notes = imported
            .wrenches
            .map(|_| format!("{name}: its forces are left aside, those of what is removed take their place").into());
        return Ok(NamedPath { notes: notes.into_iter().collect(), ..NamedPath::plain(file, imported.path, input) });
    }
    let imported = import_bytes(file, bytes, &reading.settings()).map_err(by_keys)?;
    let air = |moves: &Vec<stead_format::cam::Move>| {
        moves.iter().map(|one| AirPoint { position: one.position, axis: one.axis }).collect()
    };
    Ok(NamedPath {
        rapids: imported.rapids().iter().map(air).collect(),
        notes: imported.notes.iter().map(|note| format!("{name}: {}", keyed(note)).into()).collect(),
        tool: imported.tool.clone(),
        ..NamedPath::plain(file, imported.path(file)?, input)
    })
}

/// An error of an import with the keys of `[reading]` in place of the options of the command line.
fn by_keys(error: InputError) -> InputError {
    InputError {
        problem: keyed(&error.problem).into(),
        field: error.field.as_deref().map(|field| keyed(field).into()),
        allowed: error.allowed.as_deref().map(|allowed| keyed(allowed).into()),
        ..error
    }
}

/// A text with the keys of `[reading]` in place of the options of the command line.
fn keyed(text: &str) -> String {
    let keys =
        ["units", "format", "machine", "pivot_mm", "tcp", "skip_cycles", "keep_links", "ignore", "step_mm", "chord_mm"];
    let option = |key: &str| format!("--{}", key.replace('_', "-"));
    keys.iter().fold(text.to_owned(), |text, key| text.replace(&option(key), &format!("reading.{key}")))
}

impl ReadingTable {
    fn settings(&self) -> ReadSettings {
        let default = ReadSettings::default();
        let mut resampling = default.resampling;
        resampling.step = self.step_mm.map_or(resampling.step, Quantity::si);
        resampling.chord = self.chord_mm.map_or(resampling.chord, Quantity::si);
        ReadSettings {
            format: self.format.map(|word| word.0),
            units: self.units.map(|word| word.0),
            machine: self.machine.map(|word| word.0),
            pivot: self.pivot_mm.map(|pivot| pivot.vector()),
            tool_centre_point: self.tcp.unwrap_or_default(),
            skip_cycles: self.skip_cycles.unwrap_or_default(),
            keep_links: self.keep_links.unwrap_or_default(),
            ignore: self.ignore.clone().unwrap_or_default(),
            resampling,
        }
    }
}

/// Refuses keys of a cut that the path and the stock say.
fn check_cut(cut: &CutTable, at: &Place<'_>) -> Result<(), InputError> {
    let given = [
        ("milling", cut.milling.is_some()),
        ("radial_depth_mm", cut.radial_depth_mm.is_some()),
        ("axial_depth_mm", cut.axial_depth_mm.is_some()),
        ("engagement", cut.engagement.is_some()),
        ("open_width_mm", cut.open_width_mm.is_some()),
        ("concave_corners", cut.concave_corners.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((key, _)) => Err(at.key(key).error(
            "is given, and the path and the stock say what is cut",
            "spindle_rpm, and feed_per_tooth_mm where the path has no feeds",
        )),
        None => Ok(()),
    }
}

/// The end mill of a file, with the coefficients of its table or those published for the material.
fn end_mill(tool: &ToolTable, material: Option<Word<Material>>, at: &Place<'_>) -> Result<EndMill, InputError> {
    let tool_at = at.key("tool");
    let stated = ["kt_mpa", "kr", "kr_mpa", "ka_mpa", "kte_n_per_mm", "kre_n_per_mm"];
    let given = stated.iter().map(|key| tool_at.key(key)).find(Place::is_given);
    let coefficients = match (material, given) {
        (Some(material), None) => material.0.coefficients(),
        (Some(_), Some(key)) => {
            return Err(key.error("is given beside material", "coefficients in [tool], or material"));
        }
        (None, None) => {
            let allowed =
                "coefficients kt_mpa, kr (or kr_mpa), kte_n_per_mm and kre_n_per_mm, or material beside [tool]";
            return Err(tool_at.key("kt_mpa").missing(allowed));
        }
        (None, Some(_)) => {
            required!(tool_at, tool.kte_n_per_mm)?;
            required!(tool_at, tool.kre_n_per_mm)?;
            let coefficients = Cutting::new(tool, &CutTable::default(), at).coefficients()?;
            if coefficients.radial < 0.0 {
                return Err(tool_at.key("kr_mpa").out_of_range("a number not below 0 for forces along a path"));
            }
            coefficients
        }
    };
    shape(tool, Cutting::new(tool, &CutTable::default(), at).cutter(coefficients, "kt_mpa")?, at)
}

/// A cutter of which its shape alone counts: its teeth need not be stated.
fn outline(tool: &ToolTable, at: &Place<'_>) -> Result<Cutter, InputError> {
    if tool.teeth.is_some() || tool.pitch_deg.is_some() || tool.runout_um.is_some() {
        return Cutting::new(tool, &CutTable::default(), at).cutter(Coefficients::default(), "kt_mpa");
    }
    let radius = tool.cutter_diameter_mm.si() / 2.0;
    Cutter::even(1, radius, 0.0, Rotation::Clockwise, Coefficients::default()).map_err(|error| {
        let at = at.key("tool").key("cutter_diameter_mm");
        at.error(format!("makes no cutter: {error}"), "a number above 0")
    })
}

/// The end mill of a cutter.
fn shape(tool: &ToolTable, cutter: Cutter, at: &Place<'_>) -> Result<EndMill, InputError> {
    let tool_at = at.key("tool");
    let flutes = required!(tool_at, tool.flute_length_mm)?;
    let corner_radius = tool.corner_radius_mm.map_or(0.0, Quantity::si);
    let diameter = tool.cutter_diameter_mm;
    if corner_radius > diameter.si() / 2.0 + 1e-12 {
        let allowed = format!("a number not below 0 and not above half of cutter_diameter_mm = {}", diameter.written());
        return Err(tool_at.key("corner_radius_mm").out_of_range(allowed));
    }
    if corner_radius > flutes.si() {
        let allowed = format!("at least corner_radius_mm = {}", corner_radius * 1e3);
        return Err(tool_at.key("flute_length_mm").out_of_range(allowed));
    }
    Ok(EndMill {
        flute_length: flutes.si(),
        // With runout the mean radius may be the smaller one.
        corner_radius: corner_radius.min(cutter.radius()),
        cutter,
        taper: tool.taper_deg.map_or(0.0, Quantity::si),
        is_centre_cutting: tool.centre_cutting.unwrap_or(true),
        holder: tool.body().holder,
    })
}
