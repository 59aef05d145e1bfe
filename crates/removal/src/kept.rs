//! What cutting along a path gives, from which all that is said of it follows at once: kept as text, and read again.

use crate::error::ForcesError;
use crate::load::PointForces;
use crate::operation::ForcesProblem;
use crate::outcome::{ForcesDifference, RemovalForces};
use crate::points::{Added, with_points};
use crate::sums::{Event, Events};
use crate::surface::Surface;
use crate::warnings::warnings;
use nalgebra::Vector3;
use std::fmt::Write;
use stead_model::task::Wrench;

/// What cutting along the path of an operation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct CutResult {
    pub(crate) cell: f64,
    pub(crate) difference: ForcesDifference,
    pub(crate) removed: f64,
    /// At the points of the path.
    pub(crate) loads: Vec<PointForces>,
    /// Between them.
    pub(crate) added: Vec<Added>,
    pub(crate) stock: [Surface; 2],
    pub(crate) events: Events,
}

/// Numbers of a load.
const OF_LOAD: usize = 19;

impl CutResult {
    /// The forces along the path of the problem that was cut.
    ///
    /// # Errors
    /// [`ForcesError::Path`] where points that were added make no path.
    pub fn forces(self, problem: &ForcesProblem) -> Result<RemovalForces, ForcesError> {
        let (path, points) = with_points(&problem.operation.path, self.loads, &self.added)?;
        let mut all = RemovalForces {
            path,
            points,
            cell: self.cell,
            difference: self.difference,
            removed: self.removed,
            air: 0.0,
            cut: None,
            stock: self.stock,
            warnings: Vec::new(),
            notes: Vec::new(),
        };
        warnings(&mut all, problem, &self.events);
        Ok(all)
    }

    /// As rows of CSV, a word and numbers in SI units that are read back to the last bit: `cut` (cell, differences of
    /// forces and moments, removed volume), `load` of each point of the path, `added` of those between (number of the
    /// point after it, share of the way), `event` (word, point, volume), and `vertex` and `triangle` of the stock
    /// before (0) and after (1).
    pub fn rows(&self) -> String {
        let mut text = String::new();
        let ForcesDifference { rms, largest } = self.difference;
        row(&mut text, "cut", &[self.cell, rms[0], rms[1], largest[0], largest[1], self.removed].map(Some));
        self.loads.iter().for_each(|load| row(&mut text, "load", &numbers(load)));
        for Added { before, share, load } in &self.added {
            let place = [Some(*before as f64), Some(*share)];
            row(&mut text, "added", &[&place[..], &numbers(load)].concat());
        }
        for ((event, point), volume) in &self.events {
            row(&mut text, &format!("event,{}", event.word()), &[f64::from(*point), *volume].map(Some));
        }
        for (number, surface) in self.stock.iter().enumerate() {
            for at in &surface.vertices {
                row(&mut text, &format!("vertex,{number}"), &[at.x, at.y, at.z].map(Some));
            }
            for triangle in &surface.triangles {
                row(&mut text, &format!("triangle,{number}"), &triangle.map(|vertex| Some(f64::from(vertex))));
            }
        }
        text
    }

    /// What [`rows`](Self::rows) has written of a path of so many points; nothing where the rows are other ones.
    pub fn of_rows(text: &str, points: usize) -> Option<Self> {
        let (mut head, mut loads, mut added) = (None, Vec::new(), Vec::<Added>::new());
        let (mut events, mut stock) = (Events::new(), <[Surface; 2]>::default());
        for line in text.lines() {
            let (word, rest) = line.split_once(',')?;
            match word {
                "cut" if head.is_none() => head = Some(exactly::<6>(&fields(rest)?)?),
                "load" => loads.push(load_of(&fields(rest)?)?),
                "added" => {
                    let all = fields(rest)?;
                    let (place, of_load) = all.split_at_checked(2)?;
                    let (before, share) = (index(place[0]?)? as usize, place[1]?);
                    let last = added.last().map_or((0, 0.0), |last| (last.before, last.share));
                    let is_next = before > last.0 || (before == last.0 && share > last.1);
                    let is_between = (1..points).contains(&before) && share > 0.0 && share < 1.0;
                    (is_next && is_between).then_some(())?;
                    added.push(Added { before, share, load: load_of(of_load)? });
                }
                "event" => {
                    let (word, rest) = rest.split_once(',')?;
                    let (_, event) = Event::WORDS.iter().find(|(known, _)| *known == word)?;
                    let [point, volume] = exactly(&fields(rest)?)?;
                    let point = index(point).filter(|point| (*point as usize) < points)?;
                    events.insert((*event, point), volume);
                }
                "vertex" | "triangle" => {
                    let (number, rest) = rest.split_once(',')?;
                    let surface = stock.get_mut(number.parse::<usize>().ok()?)?;
                    let three = exactly::<3>(&fields(rest)?)?;
                    if word == "vertex" {
                        surface.vertices.push(Vector3::from(three));
                    } else {
                        let [a, b, c] = three.map(index);
                        surface.triangles.push([a?, b?, c?]);
                    }
                }
                _ => return None,
            }
        }
        let [cell, a, b, c, d, removed] = head?;
        let is_whole = |surface: &Surface| {
            surface.triangles.iter().flatten().all(|vertex| (*vertex as usize) < surface.vertices.len())
        };
        (cell > 0.0 && loads.len() == points && stock.iter().all(is_whole)).then_some(())?;
        let difference = ForcesDifference { rms: [a, b], largest: [c, d] };
        Some(Self { cell, difference, removed, loads, added, stock, events })
    }
}

/// The loads of a tool that leans, as rows of the word `leaning`.
pub fn load_rows(loads: &[PointForces]) -> String {
    let mut text = String::new();
    loads.iter().for_each(|load| row(&mut text, "leaning", &numbers(load)));
    text
}

/// What [`load_rows`] has written of one load; nothing where the row is another one.
pub fn load_of_row(line: &str) -> Option<PointForces> {
    load_of(&fields(line.strip_prefix("leaning,")?)?)
}

fn row(text: &mut String, word: &str, numbers: &[Option<f64>]) {
    text.push_str(word);
    for number in numbers {
        text.push(',');
        if let Some(number) = number {
            // Writing to a string cannot fail.
            let _ = write!(text, "{number}");
        }
    }
    text.push('\n');
}

/// The numbers of a row, finite or left out.
fn fields(text: &str) -> Option<Vec<Option<f64>>> {
    let number = |field: &str| match field {
        "" => Some(None),
        field => field.parse().ok().filter(|number: &f64| number.is_finite()).map(Some),
    };
    text.split(',').map(number).collect()
}

/// So many numbers, none left out.
fn exactly<const N: usize>(fields: &[Option<f64>]) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = fields.iter().copied().collect();
    all?.try_into().ok()
}

/// A number of a point or a vertex.
fn index(number: f64) -> Option<u32> {
    (number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0).then_some(number as u32)
}

fn numbers(load: &PointForces) -> [Option<f64>; OF_LOAD] {
    let mut all = [None; OF_LOAD];
    let parts = [load.chip.force, load.chip.moment, load.edge.force, load.edge.moment];
    let known = parts.into_iter().flat_map(|part| [part.x, part.y, part.z]);
    let known = known.chain([load.largest, load.removed, load.chip_thickness]).map(Some);
    let pairs = [load.heights, load.angles].into_iter().flat_map(|pair| [0, 1].map(|k| pair.map(|pair| pair[k])));
    all.iter_mut().zip(known.chain(pairs)).for_each(|(place, number)| *place = number);
    all
}

fn load_of(fields: &[Option<f64>]) -> Option<PointForces> {
    let fields: &[Option<f64>; OF_LOAD] = fields.try_into().ok()?;
    let vector = |k: usize| Some(Vector3::new(fields[3 * k]?, fields[3 * k + 1]?, fields[3 * k + 2]?));
    let pair = |k: usize| match [fields[k], fields[k + 1]] {
        [Some(low), Some(high)] => Some(Some([low, high])),
        [None, None] => Some(None),
        _ => None,
    };
    Some(PointForces {
        is_added: false,
        chip: Wrench { force: vector(0)?, moment: vector(1)? },
        edge: Wrench { force: vector(2)?, moment: vector(3)? },
        largest: fields[12]?,
        removed: fields[13]?,
        chip_thickness: fields[14]?,
        heights: pair(15)?,
        angles: pair(17)?,
    })
}
