use super::super::tests::leaning;
use super::*;
use stead_planning::testing::five_segments;

#[test]
#[ignore]
fn how_fast() {
    let problem = leaning(five_segments(), 20.0);
    let model = Leaning::new(&problem);
    let monitor = Monitor::silent();
    let begun = std::time::Instant::now();
    let start = model.start(&whole(&problem));
    eprintln!("{} boxes, {} kinds", start.len(), model.axes[0].kinds().len());
    let classes = vec![15; model.segments.len()];
    let mut bounds: Vec<f64> = Vec::new();
    for (k, region) in start.iter().enumerate().step_by(40) {
        let (sum, left) = model.lower_bound(region, &classes, 1.0, &monitor);
        bounds.push(sum / Objective::of(&problem).weight * 1e3);
        if k % 400 == 0 {
            eprintln!("{k} {:?} {:.4} {left:?} {:.2} s, {} evaluated, {} made", region.middle, sum / Objective::of(&problem).weight * 1e3, begun.elapsed().as_secs_f64(), cells::EVALUATED.load(std::sync::atomic::Ordering::Relaxed), model.axes[0].used());
        }
    }
    bounds.sort_by(f64::total_cmp);
    eprintln!("{:?}", (0..20).map(|k| bounds[k * (bounds.len() - 1) / 19]).collect::<Vec<_>>());
}

#[test]
#[ignore]
fn how_low() {
    let problem = leaning(five_segments(), 20.0);
    let model = Leaning::new(&problem);
    let monitor = Monitor::silent();
    let classes = vec![15; model.segments.len()];
    let weight = Objective::of(&problem).weight;
    for angle in [0.3, 1.0, 1.7, 2.4, 3.1, 3.8, 4.5, 5.2, 5.9] {
        let (s, c) = libm::sincos(angle);
        let mut text = String::new();
        for level in 0..5 {
            let begun = std::time::Instant::now();
            let before = cells::EVALUATED.load(std::sync::atomic::Ordering::Relaxed);
            let region = Region { middle: [1.7 * c, 1.7 * s, -0.4], half: [half_of(level); 3] };
            let (sum, _) = model.lower_bound(&region, &classes, 1.0, &monitor);
            let after = cells::EVALUATED.load(std::sync::atomic::Ordering::Relaxed);
            text += &format!("{:.4} ({} in {:.2} s) ", sum / weight * 1e3, after - before, begun.elapsed().as_secs_f64());
        }
        let placement = super::super::cell::placement_in(&problem, &Region { middle: [1.7, -0.4, -angle], half: [0.0; 3] });
        let value = super::super::relaxed_value(&problem, &placement, &monitor).map(|v| v * 1e3);
        eprintln!("{angle}: {text} {value:?}");
    }
}

