//! A small study for the tests of its report.

use stead_study::analysis::{Analysis, Question};
use stead_study::cases::{Column, ColumnKind, Table, TableCell};

/// Two robots at two heights, case 4 without a placement: objectives 1, 2, 4 mm, cycles 9, 5, 6 s.
pub(crate) fn table() -> Table {
    let texts = ["id", "task", "robot", "status", "reason"];
    let kind = |name: &str| match name {
        "case" => ColumnKind::Count,
        name if texts.contains(&name) => ColumnKind::Text,
        _ => ColumnKind::Number,
    };
    let names = [
        "case",
        "id",
        "task",
        "task_weight",
        "robot",
        "height",
        "status",
        "reason",
        "objective_mm",
        "best_mean_total_mm",
        "cycle_s",
    ];
    let words = |text: &str| TableCell::Text(text.to_owned());
    let row = |case, robot, height, figures: Option<[f64; 2]>| {
        let mut row = vec![
            TableCell::Count(case),
            words("id"),
            words("t.csv"),
            TableCell::Number(1.0),
            words(robot),
            TableCell::Number(height),
        ];
        match figures {
            Some([objective, cycle]) => {
                row.extend([
                    words("placed"),
                    TableCell::None,
                    TableCell::Number(objective),
                    TableCell::Number(objective),
                    TableCell::Number(cycle),
                ]);
            }
            None => row.extend([
                words("infeasible"),
                words("joint 2 at 7.0 deg"),
                TableCell::None,
                TableCell::None,
                TableCell::None,
            ]),
        }
        row
    };
    let rows = vec![
        row(1, "a.toml", 100.0, Some([1.0, 9.0])),
        row(2, "a.toml", 200.0, Some([2.0, 5.0])),
        row(3, "b.toml", 100.0, Some([4.0, 6.0])),
        row(4, "b.toml", 200.0, None),
    ];
    Table { columns: names.map(|name| Column::new(name, kind(name))).to_vec(), rows }
}

pub(crate) fn analysis() -> Analysis {
    Analysis::of(&table(), &Question::default()).unwrap()
}
