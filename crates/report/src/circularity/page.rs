//! `report.html` of a roundness.

use crate::page::cards::{Cell, Chart, Column, Page, Polar, PolarChoice, Series, Table, Tile};
use crate::picture;
use crate::units::{figures, fixed};
use stead_assessment::circle::Fit;
use stead_assessment::roundness::Roundness;
use stead_runs::PointFile;

/// Names of the four circles in files, in words, and what they are.
pub(super) fn circles(found: &Roundness) -> [(&'static str, &'static str, &Fit); 4] {
    let circles = &found.circles;
    [
        ("lsc", "least squares (LSC)", &circles.lsc),
        ("mzc", "minimum zone (MZC)", &circles.mzc),
        ("mic", "maximum inscribed (MIC)", &circles.mic),
        ("mcc", "minimum circumscribed (MCC)", &circles.mcc),
    ]
}

/// `polar.svg`: the profile about the minimum zone circles.
pub(super) fn polar_picture(name: &str, found: &Roundness) -> String {
    let detail = "Deviation from the reference circle".to_owned();
    let card = Polar { title: format!("Roundness of {name}"), detail, ..polar(found) };
    picture::polar(&card, &card.choices[1])
}

/// The polar plot about each of the four circles, and the circles beside each other.
pub(super) fn page(file: &PointFile, found: &Roundness) -> Page {
    let (all, kept) = (found.points.len(), found.kept().count());
    let zone = &found.circles.mzc;
    let lead = format!(
        "All points counted lie between two circles about one centre that are {} mm apart in radius, about a mean radius of {} mm.",
        figures(zone.circularity),
        fixed(zone.circle.radius, 4)
    );
    let none: [&str; 0] = [];
    let subtitle = format!("roundness · {all} points, {} left out", all - kept);
    Page::new(&file.input.name, subtitle, lead, std::slice::from_ref(&file.input))
        .messages(&found.warnings(), &none)
        .with(tiles(found))
        .with(polar(found))
        .with(table(found))
        .with_all(found.plane.is_some().then(|| heights(found)))
}

fn tiles(found: &Roundness) -> Vec<Tile> {
    let tile = |(_, name, fit): (&str, &str, &Fit)| {
        Tile::new(name, figures(fit.circularity), "mm", format!("radius {} mm", fixed(fit.circle.radius, 4)))
    };
    let flatness = |flatness: f64| Tile::new("flatness", figures(flatness), "mm", "of the plane fitted");
    circles(found).into_iter().map(tile).chain(found.flatness().map(flatness)).collect()
}

fn polar(found: &Roundness) -> Polar {
    let degrees = |angle: f64| angle.to_degrees().rem_euclid(360.0);
    let choice = |(_, name, fit): (&str, &str, &Fit)| {
        let [x, y] = fit.circle.center;
        let deviation = |place: [f64; 2]| libm::hypot(place[0] - x, place[1] - y) - fit.circle.radius;
        let ([center_x, center_y], center_z) = found.center(fit);
        let radii = [
            ("radius of reference", fit.circle.radius),
            ("outer zone circle", fit.largest),
            ("inner zone circle", fit.smallest),
            ("centre x in the file", center_x),
            ("centre y in the file", center_y),
        ];
        let figures = radii.into_iter().chain(center_z.map(|z| ("centre z in the file", z)));
        PolarChoice {
            name: name.to_owned(),
            detail: format!(
                "circularity {} mm; solid: the reference circle, dashed: the smallest and the largest radius of the points counted",
                fixed(fit.circularity, 6)
            ),
            deviations: found.points.iter().map(|point| deviation(point.place)).collect(),
            band: [fit.smallest - fit.circle.radius, fit.largest - fit.circle.radius],
            radius: fit.circle.radius,
            figures: figures.map(|(name, value)| (name.to_owned(), fixed(value, 4))).collect(),
        }
    };
    Polar {
        title: "Deviation from the reference circle".to_owned(),
        detail: "grey: left out".to_owned(),
        unit: "mm".to_owned(),
        choices: circles(found).into_iter().map(choice).collect(),
        angles: found.points.iter().map(|point| degrees(point.angle)).collect(),
        excluded: found.points.iter().map(|point| point.is_excluded).collect(),
    }
}

fn table(found: &Roundness) -> Table {
    let names = ["circularity mm", "radius mm", "center x mm", "center y mm"].map(Column::number);
    let row = |(_, name, fit): (&str, &str, &Fit)| {
        let ([x, y], _) = found.center(fit);
        let numbers = [fixed(fit.circularity, 6), fixed(fit.circle.radius, 5), fixed(x, 5), fixed(y, 5)];
        std::iter::once(Cell::Text(name.to_owned())).chain(numbers.map(Cell::Number)).collect()
    };
    let columns = std::iter::once(Column::text("reference circle")).chain(names).collect();
    Table::new("Reference circles", columns, circles(found).into_iter().map(row).collect())
}

/// How far the points are out of their plane.
fn heights(found: &Roundness) -> Chart {
    let of = |is_excluded: bool| {
        let points = found.points.iter().filter(move |point| point.is_excluded == is_excluded);
        points.map(|point| [point.angle.to_degrees().rem_euclid(360.0), point.height])
    };
    let mut series = vec![Series::dots("counted", 0, of(false))];
    if found.points.iter().any(|point| point.is_excluded) {
        series.push(Series::dots("left out", 2, of(true)));
    }
    Chart::new("Height above the plane", "angle (deg)", "height (mm)", series)
}
