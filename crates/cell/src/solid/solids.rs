//! What the triangles of a mesh file make: corners that are one, and the closed surfaces.

use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Vertices that are nearer than this share of the size of the mesh are one: single precision leaves them so far apart.
const SAME: f64 = 1e-6;
/// Edge of the cells in which vertices are looked up, by the distance at which they are one.
const CELL: f64 = 8.0;

/// Vertices of which none are one, and the number among them of each that was given: the first of those that it is one
/// with.
pub(super) fn merged(vertices: &[Vector3<f64>]) -> (Vec<Vector3<f64>>, Vec<u32>) {
    let first = vertices.first().copied().unwrap_or_default();
    let (low, high) = vertices.iter().fold((first, first), |(low, high), v| (low.inf(v), high.sup(v)));
    let same = ((high - low).max() * SAME).max(f64::MIN_POSITIVE);
    let cell = |vertex: &Vector3<f64>| <[f64; 3]>::from(*vertex - low).map(|c| (c / (CELL * same)).floor() as i64);
    let mut known: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    let mut number_of = Vec::with_capacity(vertices.len());
    for vertex in vertices {
        let [from, to] = [-same, same].map(|by| cell(&vertex.add_scalar(by)));
        let cells = (from[0]..=to[0])
            .flat_map(|x| (from[1]..=to[1]).flat_map(move |y| (from[2]..=to[2]).map(move |z| [x, y, z])));
        let near = cells.filter_map(|cell| known.get(&cell)).flatten().copied();
        let found = near.filter(|number| (kept[*number as usize] - vertex).norm() <= same).min();
        number_of.push(found.unwrap_or_else(|| {
            let number = kept.len() as u32;
            kept.push(*vertex);
            known.entry(cell(vertex)).or_default().push(number);
            number
        }));
    }
    (kept, number_of)
}

/// The closed surfaces that triangles make.
pub(super) struct Solids {
    /// Their triangles, in the order of their first ones.
    pub solids: Vec<Vec<[u32; 3]>>,
    /// Whether two of them have a vertex in common.
    pub is_touching: bool,
}

/// The closed surfaces of which a mesh is made; `None` where something of it is not closed. Triangles at an edge belong
/// together; where solids touch along an edge, those with the material of one solid between them.
pub(super) fn solids_of(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<Solids> {
    let mut edges: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (number, triangle) in triangles.iter().enumerate() {
        for edge in directed(triangle) {
            edges.entry(edge).or_default().push(number);
        }
    }
    let mut parent: Vec<usize> = (0..triangles.len()).collect();
    for ((from, to), of) in &edges {
        let others = edges.get(&(*to, *from))?;
        for here in of {
            let there = match others.as_slice() {
                [one] => *one,
                all => across(vertices, triangles, (*from, *to), *here, all)?,
            };
            let [a, b] = [*here, there].map(|number| root(&mut parent, number));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut by_root: BTreeMap<usize, Vec<[u32; 3]>> = BTreeMap::new();
    for (number, triangle) in triangles.iter().enumerate() {
        by_root.entry(root(&mut parent, number)).or_default().push(*triangle);
    }
    let solids: Vec<Vec<[u32; 3]>> = by_root.into_values().collect();
    if !solids.iter().all(|solid| is_closed(solid)) {
        return None;
    }
    let mut owner: BTreeMap<u32, usize> = BTreeMap::new();
    let corners =
        solids.iter().enumerate().flat_map(|(solid, of)| of.iter().flatten().map(move |corner| (solid, corner)));
    let mut is_touching = false;
    for (solid, corner) in corners {
        is_touching |= *owner.entry(*corner).or_insert(solid) != solid;
    }
    Some(Solids { solids, is_touching })
}

/// Of the triangles beyond an edge of one, the first that is met on the way round the edge through the material behind
/// that one.
fn across(
    vertices: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    edge: (u32, u32),
    here: usize,
    others: &[usize],
) -> Option<usize> {
    let start = vertices[edge.0 as usize];
    let along = (vertices[edge.1 as usize] - start).normalize();
    // From the edge into a triangle, square to the edge.
    let into = |number: usize| {
        let third = triangles[number].into_iter().find(|corner| *corner != edge.0 && *corner != edge.1)?;
        let off = vertices[third as usize] - start;
        Some((off - along * off.dot(&along)).normalize())
    };
    let own = into(here)?;
    let behind = -along.cross(&own);
    let angle = |number: usize| {
        let other = into(number)?;
        let angle = libm::atan2(other.dot(&behind), other.dot(&own)).rem_euclid(TAU);
        // One that lies on it is met last.
        Some((if angle < SAME { TAU } else { angle }, number))
    };
    let angles = others.iter().map(|number| angle(*number)).collect::<Option<Vec<_>>>()?;
    angles.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
}

fn directed(corners: &[u32; 3]) -> [(u32, u32); 3] {
    [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3]))
}

fn root(parent: &mut [usize], of: usize) -> usize {
    let mut number = of;
    while parent[number] != number {
        parent[number] = parent[parent[number]];
        number = parent[number];
    }
    number
}

/// Whether each directed edge has its opposite, once.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for edge in triangles.iter().flat_map(directed) {
        *edges.entry(edge).or_insert(0) += 1;
    }
    edges.iter().all(|((from, to), count)| *count == 1 && edges.get(&(*to, *from)) == Some(&1))
}
