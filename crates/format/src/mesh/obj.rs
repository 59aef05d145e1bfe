//! OBJ: vertices, and faces that name them. Of a face only its vertices are read; one with more than three corners
//! becomes a fan of triangles, which covers it.

use super::stl::number_of;
use super::{MAX_TRIANGLES, THINNER, Triangles};
use nalgebra::Vector3;
use std::path::Path;
use stead_disk::files::without_mark;
use stead_disk::input::InputError;
use stead_disk::quote::shorten;

/// Statements that say nothing of the surface: texture, normals, names, materials, display, and what is no surface
/// (points, lines).
const WITHOUT_SURFACE: &str = "vt vn vp g o s mg usemtl mtllib usemap maplib p l bevel c_interp d_interp lod \
                               shadow_obj trace_obj ctech stech end";

pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Triangles, InputError> {
    let text = String::from_utf8_lossy(without_mark(bytes));
    let mut read = Triangles::default();
    // The largest vertex number that a face names, with its line.
    let mut largest = (0, 0);
    for (line, number) in statements(&text) {
        let mut words = line.split('#').next().unwrap_or_default().split_ascii_whitespace();
        let Some(kind) = words.next() else { continue };
        let fail = |problem: &str, allowed: &str| {
            Err(InputError::new(file, problem).at_line(number).found(format!("'{}'", shorten(&line))).allowed(allowed))
        };
        match kind {
            "v" => match words.by_ref().take(3).map(number_of).collect::<Vec<_>>()[..] {
                [Some(x), Some(y), Some(z)] => read.vertices.push(Vector3::new(x, y, z)),
                _ => return fail("is not a vertex of three finite numbers", "v x y z, finite numbers"),
            },
            "f" => {
                let count = read.vertices.len();
                let Some(corners) = words.map(|word| corner(word, count)).collect::<Option<Vec<u32>>>() else {
                    return fail("names a vertex that there cannot be", FACE);
                };
                if corners.len() < 3 {
                    return fail("has fewer than three corners", FACE);
                }
                let top = corners.iter().max().copied().unwrap_or_default();
                if top >= largest.0 {
                    largest = (top, number);
                }
                read.triangles.extend(corners.windows(2).skip(1).map(|edge| [corners[0], edge[0], edge[1]]));
                if read.triangles.len() > MAX_TRIANGLES {
                    return fail("makes too many triangles", THINNER);
                }
            }
            kind if WITHOUT_SURFACE.split(' ').any(|known| known == kind) => {}
            _ => {
                return fail(
                    "is a statement that is not read",
                    "an OBJ of vertices (v) and faces (f), without curved surfaces",
                );
            }
        }
    }
    if !read.triangles.is_empty() && largest.0 as usize >= read.vertices.len() {
        let problem = format!("names vertex {}, and there are {}", largest.0 + 1, read.vertices.len());
        return Err(InputError::new(file, problem).at_line(largest.1).allowed(FACE));
    }
    if read.triangles.is_empty() {
        return Err(InputError::new(file, "has no faces").allowed("an OBJ with vertices (v) and faces (f)"));
    }
    Ok(read)
}

const FACE: &str =
    "f with three corners or more: numbers of vertices from 1, or from -1 backwards, with or without /texture/normal";

/// The vertex that a corner names, from 0: counted from 1, or backwards from the last so far.
fn corner(word: &str, count: usize) -> Option<u32> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let place = if number < 0 { count as i64 + number } else { number - 1 };
    u32::try_from(place).ok().filter(|place| *place < u32::MAX)
}

/// Statements with their first line, from 1: a line that ends with a backslash goes on in the next.
fn statements(text: &str) -> impl Iterator<Item = (String, usize)> + '_ {
    let mut lines = text.lines().zip(1..);
    std::iter::from_fn(move || {
        let (first, number) = lines.next()?;
        let mut statement = first.to_owned();
        while let Some(open) = statement.trim_end().strip_suffix('\\').map(str::to_owned) {
            let next = lines.next().map(|(line, _)| line).unwrap_or_default();
            statement = format!("{open} {next}");
            if next.is_empty() {
                break;
            }
        }
        Some((statement, number))
    })
}
