//! The readers of files from elsewhere as the fuzzers (`fuzz/`) and the tests run them: whatever bytes come, an answer,
//! no panic, and what an answer promises.

use crate::forces::read_forces_from;
use crate::run::read_from;
use std::path::Path;
use std::sync::Arc;
use stead_cell::collider::Collider;
use stead_cell::{Solid, TriangleMesh};
use stead_disk::input::InputError;
use stead_format::cam::gcode::Machine;
use stead_format::cam::{CamFormat, LengthUnit, ReadSettings, Resampling, import_bytes};
use stead_format::mesh::{MeshUnit, read_mesh};
use stead_format::robot::robot_from;
use stead_format::task::parse_csv;
use stead_format::toml_file::TomlFile;
use stead_format::urdf::{ImportOptions, import_robot_text};
use stead_model::robot::Pose;
use stead_numerics::monitor::Monitor;

/// A reader of files that others write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// Robots.
    Urdf,
    /// Tool paths as cutter location data.
    Cldata,
    /// Tool paths as G-code.
    Gcode,
    /// Tool paths as CSV.
    Task,
    /// Meshes as STL, binary and ASCII.
    Stl,
    /// Meshes as OBJ.
    Obj,
    /// Meshes as DAE.
    Dae,
    /// Robot files (TOML).
    Robot,
    /// Run files (TOML), read as if they lay in `configs/` of the repository, with the files there that they name.
    Run,
    /// Forces files (TOML), read as those are.
    Forces,
}

impl Reader {
    /// Reads a file; whether it was taken.
    ///
    /// # Errors
    /// A sentence where an answer does not hold what it promises: an error in one line that names the file and what is
    /// allowed, an imported path that is read back as a task with as many points.
    pub fn check(self, bytes: &[u8]) -> Result<bool, String> {
        let file = Path::new(match self {
            Self::Obj => "file.obj",
            Self::Dae => "file.dae",
            Self::Run | Self::Forces => concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs/file.toml"),
            _ => "file",
        });
        let taken = match self {
            Self::Robot => TomlFile::new(file, bytes.to_vec()).and_then(|source| robot_from(&source)).map(drop),
            Self::Run => {
                let run = |source| read_from(&source, &Monitor::silent()).map_err(|error| error.input(file));
                TomlFile::new(file, bytes.to_vec()).and_then(run).map(drop)
            }
            Self::Forces => TomlFile::new(file, bytes.to_vec()).and_then(|source| read_forces_from(&source)).map(drop),
            Self::Urdf => {
                import_robot_text(file, &String::from_utf8_lossy(bytes), &ImportOptions::default()).map(|robot| {
                    let _ = robot.to_string();
                })
            }
            Self::Task => parse_csv(file, bytes).map(drop),
            Self::Stl | Self::Obj | Self::Dae => match read_mesh(file, bytes, MeshUnit::Metre) {
                Ok(mesh) => {
                    used(&Arc::new(mesh))?;
                    Ok(())
                }
                Err(error) => Err(error),
            },
            Self::Cldata | Self::Gcode => match import_bytes(file, bytes, &self.settings(bytes)) {
                Ok(path) => {
                    let _ = path.to_string();
                    let text = path.csv(file).map_err(|error| format!("an imported path is no task: {error}"))?;
                    let read = parse_csv(file, text.as_bytes()).map_err(|error| error.to_string())?;
                    let [points, scored] = path.point_counts();
                    if [read.path.points().len(), read.path.scored_count()] != [points, scored] {
                        return Err(format!("{points} points, {scored} scored, come back as others"));
                    }
                    Ok(())
                }
                Err(error) => Err(error),
            },
        };
        match taken {
            Ok(()) => Ok(true),
            Err(error) => promised(self, &error).map(|()| false),
        }
    }

    /// Settings of many kinds; long lines are not divided, so that there are few points.
    fn settings(self, bytes: &[u8]) -> ReadSettings {
        let kind = bytes.len();
        let gcode = self == Self::Gcode;
        // CLDATA as told from the file half of the time, else in one of its dialects.
        let dialects = &CamFormat::WORDS[..8];
        let format = if gcode {
            CamFormat::Gcode
        } else {
            dialects.get(kind % 16).map_or(CamFormat::Cldata, |(_, format)| *format)
        };
        ReadSettings {
            skip_cycles: kind % 11 == 1,
            keep_links: kind % 5 == 2,
            ignore: if gcode { Vec::new() } else { vec!["QUILLX".to_owned()] },
            format: Some(format),
            units: kind.is_multiple_of(3).then_some(LengthUnit::Millimetre),
            machine: Machine::WORDS.get(kind % 5).filter(|_| gcode).map(|(_, machine)| *machine),
            pivot: (gcode && kind % 7 < 2).then(|| nalgebra::Vector3::z() * 0.3),
            tool_centre_point: kind % 7 == 6,
            resampling: Resampling { chord: 1e-3, step: 1.0 },
        }
    }
}

/// A mesh that was read can be looked at as what it is and as its hull.
fn used(mesh: &Arc<TriangleMesh>) -> Result<(), String> {
    let ball = Collider::new(&Solid::Capsule { radius: 0.1, length: 0.0 }, &Pose::identity());
    for solid in [Solid::Mesh(mesh.clone()), Solid::Hull(mesh.clone())] {
        let Some((collider, ball)) = Collider::new(&solid, &Pose::identity()).zip(ball.as_ref()) else { continue };
        let distance = collider.distance(&Pose::identity(), ball, &Pose::identity(), 1.0);
        if distance.is_nan() {
            return Err("a mesh whose distance is no number".to_owned());
        }
    }
    Ok(())
}

/// What every error of a reader promises.
fn promised(reader: Reader, error: &InputError) -> Result<(), String> {
    let message = error.to_string();
    // A run file may be refused for a file that it names.
    let is_named = matches!(reader, Reader::Run | Reader::Forces) || message.starts_with("file");
    let is_kept = is_named && message.contains("; allowed: ") && message.lines().count() == 1;
    if is_kept {
        Ok(())
    } else {
        Err(format!("an error without file, what is allowed, or over several lines: {message}"))
    }
}

#[cfg(test)]
mod tests {
    use super::Reader;
    use rand::{Rng, RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rayon::prelude::*;
    use std::time::{Duration, Instant};
    use stead_model::testing::tried;

    const URDF: [&[u8]; 2] = [
        include_bytes!("../../format/src/urdf/fixtures/kuka.urdf"),
        include_bytes!("../../format/src/urdf/fixtures/abb.urdf"),
    ];
    const CLDATA: [&[u8]; 2] = [
        include_bytes!("../../format/src/cam/fixtures/pocket.cls"),
        include_bytes!("../../format/src/cam/fixtures/every_word.cls"),
    ];
    const GCODE: [&[u8]; 2] = [
        include_bytes!("../../format/src/cam/fixtures/three_axes.nc"),
        include_bytes!("../../format/src/cam/fixtures/five_axes.nc"),
    ];
    const TASK: [&[u8]; 2] = [
        include_bytes!("../../../tasks/five-segments.csv"),
        include_bytes!("../../format/src/cam/fixtures/followed.csv"),
    ];
    const STL: [&[u8]; 2] = [
        include_bytes!("../../format/src/mesh/fixtures/wedge.stl"),
        include_bytes!("../../format/src/mesh/fixtures/wedge-ascii.stl"),
    ];
    const ROBOT: [&[u8]; 2] = [
        include_bytes!("../../../configs/robots/kuka-kr270-2.toml"),
        include_bytes!("../../../configs/robots/staubli-tx200.toml"),
    ];
    const RUN: [&[u8]; 2] = [
        include_bytes!("../../../configs/caro-2013.toml"),
        include_bytes!("../../../configs/five-segments-cutting.toml"),
    ];
    const FORCES: [&[u8]; 2] = [
        include_bytes!("../../../configs/forces-pocket.toml"),
        b"# Forces of a task in a block that is turned, after a program has roughed it. As in the files of people, more is said \
          in words than in keys.\n\
          path = '../tasks/five-segments.csv' # without feeds: they come from the feed per tooth below\n\
          [stock] # a block that is larger than the path, turned about all axes by a little, in cells of a millimetre\n\
          box_mm = [500, 500, 50]\nxyz_mm = [0, 0, -10]\nabc_deg = [1, 2, 3]\ncell_mm = 1\n\
          [tool] # an end mill of four teeth with the coefficients of an aluminium alloy, which are an assumption here\n\
          cutter_diameter_mm = 16\nteeth = 4\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n\
          flute_length_mm = 30\n\
          [cut] # nothing but the speed and the feed, for the path and the stock say what is cut\n\
          spindle_rpm = 9000\nfeed_per_tooth_mm = 0.05\n\
          [[before]] # with a larger cutter, of which the shape alone counts\n\
          path = '../crates/format/src/cam/fixtures/three_axes.nc'\n\
          [before.tool]\ncutter_diameter_mm = 20\nteeth = 2\nflute_length_mm = 40\n",
    ];
    const DAE: [&[u8]; 2] = [include_bytes!("../../format/src/mesh/fixtures/wedge.dae"); 2];
    const OBJ: [&[u8]; 2] = [
        include_bytes!("../../format/src/mesh/fixtures/wedge.obj"),
        include_bytes!("../../format/src/mesh/fixtures/house.obj"),
    ];

    /// No file of these sizes may take longer.
    const LONGEST: Duration = Duration::from_secs(2);

    /// Runs a reader on so many fixtures with mutations; prints how many were taken and how long the slowest took.
    #[expect(clippy::print_stdout, reason = "the figures of a long run")]
    fn run(reader: Reader, fixtures: &[&[u8]], runs: usize) {
        let mut random = ChaCha8Rng::seed_from_u64(16);
        let (mut taken, mut slowest) = (0, Duration::ZERO);
        for run in 0..runs {
            let mut bytes = fixtures[run % fixtures.len()].to_vec();
            (0..random.random_range(1..4)).for_each(|_| mutate(&mut bytes, &mut random));
            let file = || String::from_utf8_lossy(&bytes);
            let begun = Instant::now();
            taken += usize::from(reader.check(&bytes).unwrap_or_else(|broken| panic!("{broken}: {:?}", file())));
            slowest = slowest.max(begun.elapsed());
            assert!(slowest < LONGEST, "{reader:?} takes {slowest:?}: {:?}", file());
        }
        println!("{reader:?}: {runs} files, {taken} taken, the slowest in {slowest:?}");
        let share = taken as f64 / runs as f64;
        assert!((0.025..0.975).contains(&share), "{reader:?}: {share} of {runs} are taken");
    }

    /// One change of a text: a byte, a piece left out, doubled or cut off, a number put in.
    fn mutate(bytes: &mut Vec<u8>, random: &mut impl Rng) {
        const PUT_IN: [&str; 10] = ["nan", "-inf", "1e308", "1e-308", "-0", "0", "1e9", "$", "/", ",,"];
        if bytes.is_empty() {
            return;
        }
        let at = random.random_range(0..bytes.len());
        let end = (at + random.random_range(1..30)).min(bytes.len());
        match random.random_range(0..6) {
            0 => bytes[at] = random.random(),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = random.random_range(0..bytes.len());
                drop(bytes.splice(to..to, piece));
            }
            3 if random.random_range(0..8) == 0 => bytes.truncate(at),
            4 => drop(bytes.splice(at..end.min(at + 3), PUT_IN[random.random_range(0..PUT_IN.len())].bytes())),
            _ => bytes[at] = b"0123456789.-,/$\n GXYZFIJKR"[random.random_range(0..26)],
        }
    }

    /// The small CAM files of the tests of the command line, of some extensions.
    fn cam_files(extensions: &[&str]) -> Vec<Vec<u8>> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/cam");
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.retain(|file| extensions.iter().any(|own| file.extension().is_some_and(|extension| extension == *own)));
        files.sort();
        files.iter().map(|file| std::fs::read(file).unwrap()).collect()
    }

    /// All readers, or the one requested, on so many fixtures with mutations each.
    fn run_all(runs: usize, requested: Option<&str>) {
        let [cldata, gcode] = [&["apt", "ncl", "cls", "aptsource"][..], &["nc"]].map(cam_files);
        let with = |own: &[&'static [u8]], more: &[Vec<u8>]| {
            own.iter().map(|file| file.to_vec()).chain(more.to_vec()).collect::<Vec<_>>()
        };
        let (cldata, gcode) = (with(&CLDATA, &cldata), with(&GCODE, &gcode));
        let [cldata, gcode] = [&cldata, &gcode].map(|files| files.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let readers = [
            (Reader::Urdf, &URDF[..]),
            (Reader::Cldata, &cldata),
            (Reader::Gcode, &gcode),
            (Reader::Task, &TASK),
            (Reader::Stl, &STL),
            (Reader::Obj, &OBJ),
            (Reader::Dae, &DAE),
            (Reader::Robot, &ROBOT),
            (Reader::Run, &RUN),
            (Reader::Forces, &FORCES),
        ];
        readers.into_par_iter().for_each(|(reader, fixtures)| {
            if requested.is_none_or(|name| name == format!("{reader:?}").to_lowercase()) {
                run(reader, fixtures, runs);
            }
        });
    }

    #[test]
    fn every_reader_keeps_its_promises_on_fixtures_with_mutations() {
        run_all(tried(20_000), None);
    }

    #[test]
    #[ignore = "a longer look at the same"]
    fn a_million_times() {
        run_all(1_000_000, std::env::var("STEAD_FUZZ_READER").ok().as_deref());
    }
}
