//! The tables of a study's report.

use super::{cases, number, percent};
use crate::csv_file::table;
use crate::output::ReportError;
use stead_study::analysis::{Analysis, Effects, Front, Layout, Layouts};

/// `study-ranking.csv`: every layout with its rank, best first, then those without a value.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn ranking_table(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    let (layouts, ranking) = (&analysis.layouts, &analysis.ranking);
    let axes = layouts.varied();
    let mut header = vec!["rank".to_owned(), "cases".to_owned()];
    header.extend(axes.iter().map(|axis| layouts.columns[*axis].name.clone()));
    header.extend([
        ranking.measure.name.clone(),
        "behind_best_percent".to_owned(),
        "status".to_owned(),
        "reason".to_owned(),
    ]);
    let row = |layout: usize, [rank, value, behind]: [String; 3]| {
        let layout = &layouts.all[layout];
        let mut row = vec![rank, cases(layout)];
        row.extend(axis_values(layout, &axes));
        row.extend([value, behind]);
        row.extend(layouts.status(layout));
        row
    };
    let ranked = ranking.ranked.iter().map(|ranked| {
        let behind = ranked.behind.map_or_else(String::new, |behind| percent(behind).to_string());
        row(ranked.layout, [ranked.rank.to_string(), ranked.value.to_string(), behind])
    });
    let without = ranking.without.iter().map(|layout| row(*layout, [const { String::new() }; 3]));
    table("the ranking", header, ranked.chain(without))
}

/// `study-front.csv`: the layouts on the front, from the best to the worst in its first column.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn front_table(front: &Front, layouts: &Layouts) -> Result<Vec<u8>, ReportError> {
    let axes = layouts.varied();
    let mut header = vec!["cases".to_owned()];
    header.extend(axes.iter().map(|axis| layouts.columns[*axis].name.clone()));
    header.extend(front.measures.iter().map(|measure| measure.name.clone()));
    header.push("behind_within_noise".to_owned());
    let rows = front.members.iter().map(|member| {
        let layout = &layouts.all[member.layout];
        let mut row = vec![cases(layout)];
        row.extend(axis_values(layout, &axes));
        row.extend(member.values.iter().map(ToString::to_string));
        row.push(member.is_tie.to_string());
        row
    });
    table("the front", header, rows)
}

/// `study-effects.csv`: every value of every axis with its mean.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn effects_table(effects: &Effects) -> Result<Vec<u8>, ReportError> {
    let names = ["axis", "method", "share_percent", "range", "rank_correlation", "slope", "value", "layouts"];
    let names = names.map(str::to_owned);
    let header = names.into_iter().chain([format!("mean_of_{}", effects.measure.name)]);
    let rows = effects.axes.iter().flat_map(|axis| {
        axis.levels.iter().map(move |level| {
            let or_empty = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
            vec![
                axis.name.clone(),
                axis.method.word().to_owned(),
                or_empty(axis.share.map(percent)),
                number(axis.range).to_string(),
                or_empty(axis.rank_correlation.map(number)),
                or_empty(axis.slope.map(number)),
                level.label.clone(),
                level.count.to_string(),
                number(level.value).to_string(),
            ]
        })
    });
    table("the effects", header, rows)
}

fn axis_values(layout: &Layout, axes: &[usize]) -> impl Iterator<Item = String> {
    axes.iter().map(|axis| layout.row[*axis].written())
}
