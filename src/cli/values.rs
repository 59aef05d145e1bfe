//! The values of options: how each is read from its text, and what is allowed.

use super::output::say;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use stead::MAX_THREADS;
use stead_assessment::roundness::Sector;
use stead_format::MAX_SPINDLE_SPEED_RPM;
use stead_format::field::FieldOverride;
use stead_model::robot::ControllerKind;
use stead_problem::settings::CertificateSettings;
use stead_run_files::{GAPS_ALLOWED, MAX_DAMPING_SCALE};
use stead_simulation::arm::Variant;
use stead_study::cases::Shard;

/// A file that is read. Where there is none of this name, that of the files which came with the program, beside it.
pub(super) fn input_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|file| {
        let shipped = if file.exists() { None } else { beside_the_program(&file) };
        shipped.map_or(file, |shipped| {
            say(&format!("note: there is no such file here: {} came with the program", shipped.display()));
            shipped
        })
    })
}

/// What came with the program, by its path there.
pub(super) fn beside_the_program(path: &Path) -> Option<PathBuf> {
    // The command of the Python package has an interpreter as its program.
    let folder = match std::env::var_os("STEAD_SHIPPED") {
        Some(folder) => PathBuf::from(folder),
        None => std::env::current_exe().ok()?.parent()?.to_owned(),
    };
    let beside = folder.join(path);
    (path.is_relative() && beside.exists()).then_some(beside)
}

/// A number that is as it should be.
pub(super) fn parsed<T: FromStr>(
    text: &str,
    is_allowed: impl FnOnce(&T) -> bool,
    allowed: impl Display,
) -> Result<T, String> {
    text.parse().ok().filter(is_allowed).ok_or_else(|| format!("allowed: {allowed}"))
}

pub(super) fn variant(text: &str) -> Result<Variant, String> {
    by_word(Variant::WORDS, text)
}

/// The value of a word.
fn by_word<T: Copy>(words: &[(&str, T)], text: &str) -> Result<T, String> {
    let found = words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
    let allowed = || words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
    found.ok_or_else(|| format!("allowed: {}", allowed()))
}

/// A value for a field, by its path.
pub(super) fn field(text: &str) -> Result<FieldOverride, String> {
    FieldOverride::parse(text).map_err(|error| error.to_string())
}

pub(super) fn damping_scale(text: &str) -> Result<f64, String> {
    let allowed = format_args!("a number from 0 to {MAX_DAMPING_SCALE}");
    parsed(text, |scale| (0.0..=MAX_DAMPING_SCALE).contains(scale), allowed)
}

pub(super) fn rpm(text: &str) -> Result<f64, String> {
    let allowed = format_args!("a number above 0 and not above {MAX_SPINDLE_SPEED_RPM}");
    parsed(text, |rpm| *rpm > 0.0 && *rpm <= MAX_SPINDLE_SPEED_RPM, allowed)
}

pub(super) fn finite(text: &str) -> Result<f64, String> {
    parsed(text, |value: &f64| value.is_finite(), "a finite decimal number")
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    parsed(text, |value: &f64| value.is_finite() && *value > 0.0, "a finite decimal number above 0")
}

/// Six numbers with commas between them.
pub(super) fn six(text: &str) -> Result<[f64; 6], String> {
    let numbers: Result<Vec<f64>, String> = text.split(',').map(|part| finite(part.trim())).collect();
    let allowed = || "allowed: six finite decimal numbers with commas between them".to_owned();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).ok_or_else(allowed)
}

/// Joint angles and what is shown of the flange there.
pub(super) type Home = ([f64; 6], Vec<f64>);

/// Joint angles and the flange pose there, with `=` between them.
pub(super) fn home(text: &str) -> Result<Home, String> {
    let allowed = || {
        "allowed: A1,..,A6=X,Y,Z,A,B,C, six angles in deg, then mm and deg; for an ABB also A1,..,A6=X,Y,Z,QW,QX,QY,QZ"
            .to_owned()
    };
    let (angles, flange) = text.split_once('=').ok_or_else(allowed)?;
    let numbers: Result<Vec<f64>, String> = flange.split(',').map(|number| finite(number.trim())).collect();
    let flange = numbers.ok().filter(|numbers| [6, 7].contains(&numbers.len())).ok_or_else(allowed)?;
    Ok((six(angles).map_err(|_| allowed())?, flange))
}

pub(super) fn controller(text: &str) -> Result<ControllerKind, String> {
    by_word(ControllerKind::WORDS, text)
}

/// Per cent in, a share out.
pub(super) fn gap(text: &str) -> Result<f64, String> {
    finite(text).ok().and_then(CertificateSettings::gap).ok_or_else(|| format!("allowed: {GAPS_ALLOWED}"))
}

/// Angles count from the x axis counter-clockwise; from the first to the second the sector may pass through zero.
pub(super) fn sector(text: &str) -> Result<Sector, String> {
    let allowed = || "allowed: two angles from -360 to 360, as in 350:10".to_owned();
    let angle = |text: &str| finite(text.trim()).map_err(|_| allowed());
    let (from, to) = text.split_once(':').ok_or_else(allowed)?;
    Sector::between_deg(angle(from)?, angle(to)?).ok_or_else(allowed)
}

pub(super) fn quaternion(text: &str) -> Result<f64, String> {
    parsed(text, |q| (-1.0..=1.0).contains(q), "a number from -1 to 1")
}

/// Seeds are what a run file can hold too.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    const MAX: u64 = i64::MAX as u64;
    parsed(text, |seed| *seed <= MAX, format_args!("a whole number from 0 to {MAX}"))
}

/// Per cent in, a share out.
pub(super) fn noise(text: &str) -> Result<f64, String> {
    parsed(text, |percent| (0.0..100.0).contains(percent), "a number from 0 to below 100")
        .map(|percent| percent / 100.0)
}

/// A part of a study.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
    Shard::parse(text).ok_or_else(|| format!("allowed: {}", Shard::ALLOWED))
}

/// Slurm's largest array, as it is set up at first.
const MAX_SHARDS: usize = 1000;

pub(super) fn shards(text: &str) -> Result<usize, String> {
    parsed(text, |n| (1..=MAX_SHARDS).contains(n), format_args!("a whole number from 1 to {MAX_SHARDS}"))
}

pub(super) fn case(text: &str) -> Result<u8, String> {
    parsed(text, |case| [1, 3].contains(case), "1 or 3")
}

pub(super) fn point(text: &str) -> Result<usize, String> {
    parsed(text, |_| true, "a whole number from 0")
}

pub(super) fn threads(text: &str) -> Result<usize, String> {
    parsed(text, |n| (1..=MAX_THREADS).contains(n), format_args!("a whole number from 1 to {MAX_THREADS}"))
}
