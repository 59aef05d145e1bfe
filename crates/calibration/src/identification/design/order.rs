//! The order in which to measure: short moves from one configuration to the next.

use super::super::sheet::LoadCase;

/// How far apart two configurations are: the joint that turns furthest decides. rad
fn distance(a: &LoadCase, b: &LoadCase) -> f64 {
    a.theta.iter().zip(b.theta).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Length of the route through configurations in their order. rad
pub(super) fn travel(load_cases: &[LoadCase]) -> f64 {
    load_cases.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum()
}

/// Each configuration followed by the nearest that is left, from the start that makes the route shortest; then pieces
/// of the route reversed as long as that makes it shorter.
pub(super) fn ordered(load_cases: &[LoadCase]) -> Vec<LoadCase> {
    let mut best: Vec<LoadCase> = load_cases.to_vec();
    for start in 0..load_cases.len() {
        let mut left: Vec<LoadCase> = load_cases.to_vec();
        let mut route = vec![left.remove(start)];
        while let Some(last) = route.last().copied() {
            let nearest =
                (0..left.len()).min_by(|a, b| distance(&last, &left[*a]).total_cmp(&distance(&last, &left[*b])));
            let Some(nearest) = nearest else { break };
            route.push(left.remove(nearest));
        }
        reverse_pieces(&mut route);
        if travel(&route) < travel(&best) - 1e-12 {
            best = route;
        }
    }
    best
}

fn reverse_pieces(route: &mut [LoadCase]) {
    let mut is_better = true;
    while is_better {
        is_better = false;
        for first in 0..route.len() {
            for last in first + 1..route.len() {
                let before = travel(route);
                route[first..=last].reverse();
                if travel(route) < before - 1e-12 {
                    is_better = true;
                } else {
                    route[first..=last].reverse();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn a_line_is_walked_from_end_to_end() {
        let load_case = |angle: f64| LoadCase { theta: [angle; 6], force: Vector3::x(), moment: Vector3::zeros() };
        let route = ordered(&[0.4, 0.1, 0.9, 0.2, 0.7].map(load_case));
        let mut angles: Vec<f64> = route.iter().map(|load_case| load_case.theta[0]).collect();
        if angles[0] > angles[4] {
            angles.reverse();
        }
        assert_eq!(angles, [0.1, 0.2, 0.4, 0.7, 0.9]);
        assert!((travel(&route) - 0.8).abs() < 1e-15);
    }
}
