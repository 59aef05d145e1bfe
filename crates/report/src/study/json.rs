//! The report of a study for programs.

use super::{number, percent};
use crate::document::Document;
use serde_json::{Map, Value, json};
use stead_format::input::InputFile;
use stead_study::analysis::{
    Analysis, AxisEffect, Effects, Failures, Front, Layout, Layouts, Measure, Ranked, Ranking, TaskRanking,
};
use stead_study::cases::{Cell, StudyStatus};

/// What `stead study report --json` prints, and the content of `study-report.json`.
pub fn study_json(name: &str, analysis: &Analysis, inputs: &[InputFile]) -> Value {
    let layouts = &analysis.layouts;
    let entries = json!({
        "study": name,
        "noise_percent": percent(analysis.noise),
        "tasks_joined": layouts.tasks(),
        "ranking": ranking(&analysis.ranking, layouts),
        "tasks": analysis.tasks.iter().map(task).collect::<Value>(),
        "front": analysis.front.as_ref().map(|found| front(found, layouts)),
        "effects": effects(&analysis.effects),
        "map": analysis.map.as_ref().map(|map| json!({
            "column": map.measure.name,
            "axes": map.names,
            "values": map.labels,
            "means": map.cells.iter().map(|cell| cell.map(number)).collect::<Vec<_>>(),
            "layouts": map.counts,
        })),
        "failures": failures(&analysis.failures),
    });
    Document::new(inputs).notes(&analysis.notes).with(entries)
}

/// What `stead study status --json` prints.
pub fn status_json(name: &str, status: &StudyStatus, inputs: &[InputFile]) -> Value {
    let shard = |shard: &stead_study::cases::ShardStatus| {
        json!({
            "shard": shard.shard.to_string(),
            "planned": shard.planned,
            "done": shard.done,
            "without_placement": shard.without,
            "running": shard.is_running,
        })
    };
    let entries = json!({
        "study": name,
        "planned": status.planned,
        "done": status.done,
        "infeasible": status.infeasible,
        "failed": status.failed,
        "shards": status.shards.iter().map(shard).collect::<Value>(),
        "stale_cases": status.stale,
    });
    Document::new(inputs).warnings(&status.problems).with(entries)
}

fn measure(measure: &Measure) -> Value {
    json!({ "column": measure.name, "sense": measure.sense })
}

/// A layout by its cases and the values of the axes.
fn layout(layouts: &Layouts, layout: &Layout) -> Value {
    let value = |cell: &Cell| match cell {
        Cell::Number(number) => json!(number),
        Cell::Count(count) => json!(count),
        Cell::Text(text) => json!(text),
        Cell::None => Value::Null,
    };
    let axis = |axis: usize| (layouts.columns[axis].name.clone(), value(&layout.row[axis]));
    let axes: Map<String, Value> = layouts.varied().into_iter().map(axis).collect();
    json!({ "cases": layout.cases, "axes": axes })
}

fn ranked(layouts: &Layouts, ranked: &Ranked) -> Value {
    json!({
        "rank": ranked.rank,
        "layout": layout(layouts, &layouts.all[ranked.layout]),
        "value": ranked.value,
        "behind_best_percent": ranked.behind.map(percent),
    })
}

/// The best with its ties, and the next; all others are in the table.
fn ranking(found: &Ranking, layouts: &Layouts) -> Value {
    json!({
        "by": measure(&found.measure),
        "ranked": found.ranked.len(),
        "best": found.best().iter().map(|entry| ranked(layouts, entry)).collect::<Value>(),
        "next": found.next().map(|entry| ranked(layouts, entry)),
    })
}

fn task(found: &TaskRanking) -> Value {
    json!({ "task": found.task, "ranking": ranking(&found.ranking, &found.layouts) })
}

fn front(front: &Front, layouts: &Layouts) -> Value {
    let member = |member: &stead_study::analysis::FrontMember| {
        json!({
            "layout": layout(layouts, &layouts.all[member.layout]),
            "values": member.values,
            "behind_within_noise": member.is_tie,
        })
    };
    json!({
        "of": front.measures.iter().map(measure).collect::<Value>(),
        "compared": front.compared.len(),
        "members": front.members.iter().map(member).collect::<Value>(),
    })
}

fn effects(effects: &Effects) -> Value {
    let axis = |axis: &AxisEffect| {
        let level = |level: &stead_study::analysis::Level| json!({ "value": level.label, "layouts": level.count, "mean": number(level.value) });
        json!({
            "axis": axis.name,
            "method": axis.method.word(),
            "share_percent": axis.share.map(percent),
            "range": number(axis.range),
            "rank_correlation": axis.rank_correlation.map(number),
            "slope": axis.slope.map(number),
            "values": axis.levels.iter().map(level).collect::<Value>(),
        })
    };
    json!({
        "on": measure(&effects.measure),
        "layouts": effects.count,
        "mean": (effects.count > 0).then(|| number(effects.mean)),
        "axes": effects.axes.iter().map(axis).collect::<Value>(),
        "together_percent": effects.remainder.map(percent),
    })
}

fn failures(found: &Failures) -> Value {
    json!({
        "cases": found.cases,
        "infeasible": found.infeasible,
        "failed": found.failed,
        "reasons": found.reasons.iter()
            .map(|(reason, cases, first)| json!({ "reason": reason, "cases": cases, "first_case": first }))
            .collect::<Value>(),
        "never_placed": found.lost.iter()
            .map(|lost| json!({ "values": lost.values.iter().map(|[axis, value]| json!({ "axis": axis, "value": value })).collect::<Value>(), "cases": lost.cases }))
            .collect::<Value>(),
    })
}
