//! What is in a page: `page-data.json` and the other files of a run, as the script reads them.

use super::packed::chosen_singles;
use super::table::Table;
use super::{PageError, clearance, map_data, removal};
use crate::Files;
use crate::document::value;
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use stead_problem::problem::Problem;

/// `page-data.json`.
pub(super) const DATA: &str = "page-data.json";
/// The map over lead and tilt.
pub(crate) const LEAN_MAP: &str = "lean-map.csv";
/// The setup sheet of the best, or of the given, placement.
pub(crate) const SETUP_SHEET: &str = "setup.svg";
/// What a certificate proves.
const CERTIFICATE: &str = "certificate.json";
/// The boxes that it has not excluded.
const OPEN_REGION: &str = "open-region.csv";
/// Longer paths are thinned for drawing.
const MAX_POINTS: usize = 6000;

/// The command that leaves the page of one placement.
pub(super) const SCORE: &str = "score";

/// A kind of results folder: its document and the tables of its plans.
struct Kind {
    command: &'static str,
    document: &'static str,
    plans: &'static [&'static str],
    stability: &'static [&'static str],
}

const KINDS: [Kind; 2] = [
    Kind {
        command: "place",
        document: "summary.json",
        plans: &["best.csv", "best-worst-plan.csv", "worst.csv", "worst-worst-plan.csv"],
        stability: &["stability-best.csv", "stability-worst.csv"],
    },
    Kind {
        command: SCORE,
        document: "score.json",
        plans: &["best-plan.csv", "worst-plan.csv"],
        stability: &["stability-best-plan.csv", "stability-worst-plan.csv"],
    },
];

/// The files that the page of a command is made of, `page-data.json` and its document first; those that it must have
/// are told.
pub(super) fn sources(command: &str) -> Vec<(&'static str, bool)> {
    let Some(kind) = KINDS.iter().find(|kind| kind.command == command) else { return Vec::new() };
    let mut names = vec![(DATA, true), (kind.document, true)];
    // Those of the worst placement are there where it was looked for.
    names.extend(kind.plans.iter().enumerate().map(|(number, name)| (*name, number < 2)));
    let optional = ["deflection-map-best.csv", "deflection-map-worst.csv", "deflection-map.csv"];
    names.extend(optional.iter().chain(kind.stability).map(|name| (*name, false)));
    names.extend(["convergence.csv", LEAN_MAP, CERTIFICATE, OPEN_REGION, SETUP_SHEET].map(|name| (name, false)));
    names
}

/// The document and the first plan of a command, which the scene is made of beside `page-data.json`.
pub(super) fn scene_files(command: &str) -> Option<[&'static str; 2]> {
    let kind = KINDS.iter().find(|kind| kind.command == command)?;
    Some([kind.document, kind.plans.first()?])
}

/// Everything that the script reads, as one JSON object.
pub(super) fn content(files: &Files) -> Result<Value, PageError> {
    let bytes = |name: &str| files.iter().find(|(file, _)| file == name).map(|(_, bytes)| bytes.as_slice());
    let needed = |name: &str| bytes(name).ok_or_else(|| PageError::file(name, "is missing"));
    let table = |name: &str| Table::read(name, needed(name)?);
    let data = json_file(DATA, needed(DATA)?)?;
    let command = data["command"].as_str().unwrap_or_default();
    let kind = KINDS.iter().find(|kind| kind.command == command);
    let kind = kind.ok_or_else(|| PageError::data("command", "names no command that leaves a page"))?;
    let document = json_file(kind.document, needed(kind.document)?)?;
    if document["inputs"] != data["inputs"] {
        return Err(PageError::data("inputs", &format!("are not those of {}: they are of two runs", kind.document)));
    }
    let cases = document["cases"].as_array().map_or(kind.plans.len(), Vec::len);
    let tables = kind.plans.iter().take(cases).map(|name| table(name)).collect::<Result<Vec<_>, _>>()?;
    let points = data["task"]["points"].as_u64().unwrap_or(0) as usize;
    for table in &tables {
        if table.len() != points {
            let problem = format!("has {} points and {DATA} {points}: they are of two runs, or not whole", table.len());
            return Err(table.error(&problem));
        }
    }
    let chosen = thinned(&tables)?;
    let plans = tables
        .iter()
        .map(|table| table.content(&["nearest_pair"], chosen.as_deref()))
        .collect::<Result<Vec<_>, _>>()?;
    let mut maps = Vec::new();
    for entry in data["maps"].as_array().into_iter().flatten() {
        let name = entry["table"].as_str().unwrap_or_default();
        maps.push(map_data::content(entry, &table(name)?)?);
    }
    let read = |name: &'static str| bytes(name).map(|found| Table::read(name, found)).transpose();
    let depths: Vec<&str> = kind.stability.iter().copied().filter(|name| bytes(name).is_some()).collect();
    let depths = depths.iter().map(|name| table(name)?.content(&["stable", "kind"], chosen.as_deref()));
    let mut data = data;
    if let Some(chosen) = &chosen {
        keep_points(&mut data, chosen);
    }
    data["maps"] = maps.into();
    Ok(value(&Content {
        document,
        plans,
        thinned: chosen.as_ref().map(|chosen| Thinned { points, shown: chosen.len() }),
        convergence: read("convergence.csv")?.map(|table| table.content(&["search"], None)).transpose()?,
        lean_map: read(LEAN_MAP)?.map(|table| table.content(&["reason", "pair"], None)).transpose()?,
        depths: depths.collect::<Result<_, _>>()?,
        certificate: bytes(CERTIFICATE).map(|found| json_file(CERTIFICATE, found)).transpose()?,
        setup_sheet_svg: bytes(SETUP_SHEET).map(|found| String::from_utf8_lossy(found).into_owned()),
        open_region: read(OPEN_REGION)?.map(|boxes| open_region(&boxes)).transpose()?,
        data,
    }))
}

/// Keeps of the path in `page-data.json` the points that are drawn.
pub(super) fn keep_points(data: &mut Value, chosen: &[usize]) {
    let vectors = data["task"].as_object_mut().into_iter().flatten();
    for (_, all) in vectors.filter(|(key, _)| ["position_mm", "feed", "axis", "moment_nm"].contains(&key.as_str())) {
        *all = chosen_singles(all.as_str().unwrap_or_default(), chosen, 3).into();
    }
    for all in data["task"]["scored"].as_array_mut().into_iter().flatten() {
        *all = chosen_singles(all.as_str().unwrap_or_default(), chosen, 3).into();
    }
    if let Some(clearances) = data.get_mut("clearances") {
        clearance::keep(clearances, chosen);
    }
    if let Some(removal) = data.get_mut("removal") {
        removal::keep(removal, chosen);
    }
}

/// What the script reads.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Content {
    /// The document of the run.
    document: Value,
    /// The tables of its plans, by their columns.
    plans: Vec<Value>,
    /// How many points of a long path are shown.
    thinned: Option<Thinned>,
    /// The table of the convergence.
    #[serde(skip_serializing_if = "Option::is_none")]
    convergence: Option<Value>,
    /// The map over lead and tilt.
    #[serde(skip_serializing_if = "Option::is_none")]
    lean_map: Option<Value>,
    /// The tables of critical depths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    depths: Vec<Value>,
    /// The certificate.
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<Value>,
    /// The setup sheet as it is printed.
    #[serde(skip_serializing_if = "Option::is_none")]
    setup_sheet_svg: Option<String>,
    /// What it has not excluded.
    #[serde(skip_serializing_if = "Option::is_none")]
    open_region: Option<Regions>,
    /// `page-data.json`, its maps with their tables.
    #[serde(flatten)]
    data: Value,
}

/// Points of a long path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Thinned {
    /// All.
    pub points: usize,
    /// Those shown.
    pub shown: usize,
}

/// For `best` and `worst` the ends of radius, z and yaw less azimuth.
type Regions = BTreeMap<&'static str, BTreeMap<&'static str, [f64; 2]>>;

/// For each search the extent of all its boxes.
fn open_region(boxes: &Table<'_>) -> Result<Regions, PageError> {
    let searches = boxes.texts("search")?;
    let mut regions = Regions::new();
    for [key, from, to] in [
        ["radius_mm", "radius_from_mm", "radius_to_mm"],
        ["z_mm", "z_from_mm", "z_to_mm"],
        ["yaw_less_azimuth_deg", "yaw_less_azimuth_from_deg", "yaw_less_azimuth_to_deg"],
    ] {
        let (from, to) = (boxes.numbers(from)?, boxes.numbers(to)?);
        for name in ["best", "worst"] {
            let of = |values: &[f64], start: f64, choose: fn(f64, f64) -> f64| {
                searches.iter().zip(values).filter(|(search, _)| *search == name).fold(start, |a, (_, b)| choose(a, *b))
            };
            let (low, high) = (of(&from, f64::INFINITY, f64::min), of(&to, f64::NEG_INFINITY, f64::max));
            if low.is_finite() && high.is_finite() {
                regions.entry(name).or_default().insert(key, [low, high]);
            }
        }
    }
    Ok(regions)
}

pub(super) fn json_file(name: &str, bytes: &[u8]) -> Result<Value, PageError> {
    let value: Value = serde_json::from_slice(bytes)
        .map_err(|cause| PageError::file(name, format!("is no JSON document: {cause}")))?;
    match value["format"].as_u64() {
        Some(format) if format == u64::from(crate::document::FORMAT) => Ok(value),
        found => {
            let found = found.map_or_else(|| "none".to_owned(), |format| format.to_string());
            let problem = format!("is of format {found}, where this stead reads format {}", crate::document::FORMAT);
            Err(PageError::file(name, problem))
        }
    }
}

/// Of a long path evenly chosen points, with both ends of every segment; nothing where all points are drawn.
pub(super) fn evenly_chosen(problem: &Problem) -> Option<Vec<usize>> {
    let count = problem.task.points().len();
    let step = (count > MAX_POINTS).then(|| count.div_ceil(MAX_POINTS))?;
    let ends: BTreeSet<usize> = problem.task.segments().iter().flat_map(|span| [span.start, span.end - 1]).collect();
    Some((0..count).filter(|k| k % step == 0 || ends.contains(k)).collect())
}

/// Of a long path evenly chosen points, with both ends of every segment and the point of every plan that deflects most.
fn thinned(plans: &[Table<'_>]) -> Result<Option<Vec<usize>>, PageError> {
    let Some(first) = plans.first().filter(|plan| plan.len() > MAX_POINTS) else { return Ok(None) };
    let step = first.len().div_ceil(MAX_POINTS);
    let segments = first.numbers("segment")?;
    let last = first.len() - 1;
    let is_end = |k: usize| k == 0 || k == last || segments[k - 1] != segments[k] || segments[k + 1] != segments[k];
    let mut highest = Vec::new();
    for plan in plans {
        let scores = plan.numbers("score_mm")?;
        highest.extend((0..scores.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b])));
    }
    Ok(Some((0..=last).filter(|&k| k % step == 0 || is_end(k) || highest.contains(&k)).collect()))
}
