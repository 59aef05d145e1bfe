//! STL: triangles one by one, binary or in ASCII.
//!
//! Many binary files begin with `solid` as those in ASCII do. So the size decides: a binary file is as long as the
//! count of its triangles says, to the byte. What is not, begins with `solid` and holds no zero byte is text.

use super::{MAX_TRIANGLES, THINNER, Triangles};
use nalgebra::Vector3;
use std::path::Path;
use stead_disk::files::without_mark;
use stead_disk::input::InputError;
use stead_disk::quote::shorten;

/// The header of a binary file with the count of triangles.
const HEADER: usize = 84;
/// A triangle of a binary file: normal, three vertices, an attribute.
const RECORD: usize = 50;

pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Triangles, InputError> {
    let begins_as_text =
        without_mark(bytes).trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let count =
        bytes.get(HEADER - 4..HEADER).map(|count| u32::from_le_bytes(count.try_into().unwrap_or_default()) as usize);
    let is_binary = count.is_some_and(|count| bytes.len() == HEADER + RECORD * count);
    if !is_binary && begins_as_text && !bytes.contains(&0) {
        return ascii(file, &String::from_utf8_lossy(without_mark(bytes)));
    }
    let Some(count) = count else {
        return Err(InputError::new(file, "is too short for a mesh")
            .found(format!("{} bytes", bytes.len()))
            .allowed(KINDS));
    };
    if !is_binary {
        if bytes.iter().take(HEADER).all(|byte| byte.is_ascii() && *byte != 0) {
            let problem = "is a text that does not begin with \"solid\": no mesh";
            return Err(InputError::new(file, problem).allowed(KINDS));
        }
        let problem = format!("is not as long as its {count} triangles: cut off, or no STL");
        let allowed = format!("{} bytes, or an STL in ASCII, or an OBJ named so", HEADER + RECORD * count);
        return Err(InputError::new(file, problem).found(format!("{} bytes", bytes.len())).allowed(allowed));
    }
    check_count(file, count)?;
    binary(file, &bytes[HEADER..])
}

const KINDS: &str = "an STL, binary or ASCII, or an OBJ in a file named .obj, or a DAE in one named .dae";

fn check_count(file: &Path, count: usize) -> Result<(), InputError> {
    if count <= MAX_TRIANGLES {
        return Ok(());
    }
    Err(InputError::new(file, "has too many triangles").found(count.to_string()).allowed(THINNER))
}

fn binary(file: &Path, records: &[u8]) -> Result<Triangles, InputError> {
    let mut read = Triangles::default();
    for (record, number) in records.chunks_exact(RECORD).zip(1..) {
        let coordinate = |place: usize| {
            let bytes = record[12 + 4 * place..16 + 4 * place].try_into().unwrap_or_default();
            f64::from(f32::from_le_bytes(bytes))
        };
        let vertices: [Vector3<f64>; 3] =
            std::array::from_fn(|k| Vector3::new(coordinate(3 * k), coordinate(3 * k + 1), coordinate(3 * k + 2)));
        if let Some(value) = vertices.iter().flatten().find(|value| !value.is_finite()) {
            let problem = format!("has a coordinate that is not a finite number in triangle {number}");
            return Err(InputError::new(file, problem).found(value.to_string()).allowed("finite numbers"));
        }
        read.push(vertices);
    }
    Ok(read)
}

impl Triangles {
    pub(super) fn push(&mut self, vertices: [Vector3<f64>; 3]) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        self.triangles.push([first, first + 1, first + 2]);
    }
}

/// What a line of a file in ASCII may begin with.
const LINES: &str = "solid, facet normal, outer loop, vertex x y z, endloop, endfacet, endsolid, each in its place";

fn ascii(file: &Path, text: &str) -> Result<Triangles, InputError> {
    let mut read = Triangles::default();
    let mut corners: Vec<Vector3<f64>> = Vec::with_capacity(3);
    // What is open: 0 nothing, 1 a solid, 2 a facet, 3 a loop.
    let mut depth = 0;
    let mut last = 0;
    for (line, number) in text.lines().zip(1..) {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let Some(first) = words.first() else { continue };
        let fail = |problem: &str, allowed: &str| {
            Err(InputError::new(file, problem).at_line(number).found(format!("'{}'", shorten(line))).allowed(allowed))
        };
        last = number;
        match (first.to_ascii_lowercase().as_str(), depth) {
            ("solid", 0) | ("facet", 1) | ("outer", 2) => depth += 1,
            ("endfacet", 2) | ("endsolid", 1) => depth -= 1,
            ("vertex", 3) => match words[1..].iter().map(|word| number_of(word)).collect::<Vec<_>>()[..] {
                [Some(x), Some(y), Some(z)] => corners.push(Vector3::new(x, y, z)),
                _ => return fail("is not a vertex of three finite numbers", "vertex x y z, finite numbers"),
            },
            ("endloop", 3) => {
                let Ok(vertices) = <[Vector3<f64>; 3]>::try_from(std::mem::take(&mut corners)) else {
                    return fail(
                        "ends a facet that has not three vertices",
                        "three vertices between outer loop and endloop",
                    );
                };
                read.push(vertices);
                check_count(file, read.triangles.len())?;
                depth -= 1;
            }
            _ => return fail("is not what an STL has here", LINES),
        }
    }
    if depth != 0 {
        return Err(InputError::new(file, "ends within a solid: cut off").at_line(last).allowed("endsolid at the end"));
    }
    Ok(read)
}

/// A finite number as a word of a mesh file.
pub(super) fn number_of(word: &str) -> Option<f64> {
    word.parse::<f64>().ok().filter(|number| number.is_finite())
}
