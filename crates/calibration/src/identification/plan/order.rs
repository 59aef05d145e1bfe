//! The order in which to measure: short ways from one configuration to the next.

use super::super::synthetic::Shot;

/// How far apart two configurations are: the joint that turns furthest decides. rad
fn distance(a: &Shot, b: &Shot) -> f64 {
    a.0.iter().zip(b.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Length of the way through configurations in their order. rad
pub(super) fn travel(shots: &[Shot]) -> f64 {
    shots.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum()
}

/// Each configuration followed by the nearest that is left, from the start that makes the way shortest; then pieces of the way
/// turned round as long as that makes it shorter.
pub(super) fn ordered(shots: &[Shot]) -> Vec<Shot> {
    let mut best: Vec<Shot> = shots.to_vec();
    for start in 0..shots.len() {
        let mut left: Vec<Shot> = shots.to_vec();
        let mut way = vec![left.remove(start)];
        while let Some(last) = way.last().copied() {
            let nearest =
                (0..left.len()).min_by(|a, b| distance(&last, &left[*a]).total_cmp(&distance(&last, &left[*b])));
            let Some(nearest) = nearest else { break };
            way.push(left.remove(nearest));
        }
        turn_pieces(&mut way);
        if travel(&way) < travel(&best) - 1e-12 {
            best = way;
        }
    }
    best
}

fn turn_pieces(way: &mut [Shot]) {
    let mut is_better = true;
    while is_better {
        is_better = false;
        for first in 0..way.len() {
            for last in first + 1..way.len() {
                let before = travel(way);
                way[first..=last].reverse();
                if travel(way) < before - 1e-12 {
                    is_better = true;
                } else {
                    way[first..=last].reverse();
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
        let shot = |angle: f64| ([angle; 6], Vector3::x(), Vector3::zeros());
        let way = ordered(&[0.4, 0.1, 0.9, 0.2, 0.7].map(shot));
        let mut angles: Vec<f64> = way.iter().map(|shot| shot.0[0]).collect();
        if angles[0] > angles[4] {
            angles.reverse();
        }
        assert_eq!(angles, [0.1, 0.2, 0.4, 0.7, 0.9]);
        assert!((travel(&way) - 0.8).abs() < 1e-15);
    }
}
