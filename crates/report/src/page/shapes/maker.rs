//! The colour in which the maker of an arm paints it.

use stead_model::robot::{ControllerKind, Robot};

/// Makers by words of the names of their robots, with their paint. sRGB
const MAKERS: [(&[&str], [u8; 3]); 9] = [
    (&["kuka"], [232, 112, 38]),
    (&["abb", "irb"], [226, 226, 220]),
    (&["fanuc"], [244, 200, 40]),
    (&["staubli", "stäubli"], [236, 206, 70]),
    (&["yaskawa", "motoman"], [36, 92, 168]),
    (&["kawasaki"], [224, 228, 232]),
    (&["comau"], [196, 44, 40]),
    (&["nachi"], [206, 212, 218]),
    (&["universal robots", "doosan"], [168, 176, 186]),
];

/// What an arm of another maker has.
const PLAIN: [u8; 3] = [198, 204, 212];

/// The paint of an arm, by its name, else by whose controller it has. Red, green and blue, sRGB from 0 to 1
pub(super) fn body_color(robot: &Robot) -> [f32; 3] {
    let name = robot.name().to_lowercase();
    let words: Vec<&str> = name.split(|letter: char| !letter.is_alphanumeric()).collect();
    let is_named = |word: &str| if word.contains(' ') { name.contains(word) } else { words.contains(&word) };
    let by_name = MAKERS.iter().find(|(known, _)| known.iter().any(|word| is_named(word)));
    let by_controller = || {
        let maker = match robot.controller()?.kind {
            ControllerKind::Kuka => "kuka",
            ControllerKind::Abb => "abb",
            ControllerKind::Fanuc => "fanuc",
            ControllerKind::Staubli => "staubli",
        };
        MAKERS.iter().find(|(known, _)| known.contains(&maker))
    };
    let paint = by_name.or_else(by_controller).map_or(PLAIN, |(_, paint)| *paint);
    paint.map(|part| f32::from(part) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::robot::testing::kr270;

    #[test]
    fn arms_have_the_paint_of_their_makers() {
        let of = |name: &str| {
            body_color(&Robot::new(name, kr270().joints().clone()).unwrap()).map(|part| (part * 255.0).round() as u8)
        };
        assert_eq!(of("KUKA KR270-2"), [232, 112, 38]);
        assert_eq!(of("abb_irb6640_185_280"), [226, 226, 220]);
        assert_eq!(of("FANUC R-2000iC"), of("fanuc r2000ic"));
        assert_eq!(of("Universal Robots UR10"), [168, 176, 186]);
        // No word of another name.
        assert_eq!(of("crabby"), PLAIN);
    }
}
