//! Journals and tables: what is written comes back, what was torn does not.

use super::journal::{self, Entry, Journal, JournalRead, Timing};
use super::table::{Column, ColumnKind, Table, TableCell};
use super::{Shard, result_columns};

fn columns() -> Vec<Column> {
    vec![
        Column::new("a.b[1]", ColumnKind::Text),
        Column::new("x & y", ColumnKind::Number),
        Column::new("n", ColumnKind::Count),
    ]
}

fn table() -> Table {
    let rows = vec![
        vec![TableCell::Text("a,\"b\"".to_owned()), TableCell::Number(0.1 + 0.2), TableCell::Count(-3)],
        vec![TableCell::None, TableCell::None, TableCell::None],
        vec![TableCell::Text("\u{e4}".to_owned()), TableCell::Number(-0.0625), TableCell::Count(i64::MAX)],
    ];
    Table { columns: columns(), rows }
}

#[test]
fn a_table_as_csv_has_empty_fields_and_every_digit() {
    assert_eq!(
        String::from_utf8(table().to_csv().unwrap()).unwrap(),
        "a.b[1],x & y,n\n\"a,\"\"b\"\"\",0.30000000000000004,-3\n,,\n\u{e4},-0.0625,9223372036854775807\n"
    );
}

fn entry(number: usize) -> Entry {
    let row = table().rows[number % 3].clone();
    Entry { id: format!("id-{number}"), row, timing: Timing { seconds: 0.5, threads: 2, host: "h".to_owned() } }
}

#[test]
fn a_journal_cut_anywhere_has_its_whole_lines_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jsonl");
    assert_eq!(journal::read(&path, &columns()).unwrap(), JournalRead::default());
    let mut journal = Journal::open(&path, 0).unwrap();
    (0..4).for_each(|number| journal.push(&entry(number)).unwrap());
    let bytes = std::fs::read(&path).unwrap();
    let ends: Vec<usize> = (1..=bytes.len()).filter(|end| bytes[end - 1] == b'\n').collect();
    for length in (0..=bytes.len()).step_by(7) {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let JournalRead { entries, whole, problem } = journal::read(&path, &columns()).unwrap();
        assert_eq!(problem, None);
        let expected = ends.iter().filter(|end| **end <= length).count();
        assert_eq!(entries, (0..expected).map(entry).collect::<Vec<_>>());
        let mut journal = Journal::open(&path, whole).unwrap();
        (expected..4).for_each(|number| journal.push(&entry(number)).unwrap());
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
    for flipped in (0..bytes.len()).step_by(31) {
        let mut changed = bytes.clone();
        changed[flipped] ^= 1;
        std::fs::write(&path, &changed).unwrap();
        let JournalRead { entries, problem, .. } = journal::read(&path, &columns()).unwrap();
        assert!(problem.is_some() || entries.len() == 4);
        let before = ends.iter().filter(|end| **end <= flipped).count();
        assert!(entries.len() <= before + 1 && entries == (0..entries.len()).map(entry).collect::<Vec<_>>());
    }
}

#[test]
fn every_case_is_in_one_shard() {
    for count in [1, 2, 3, 7, 40] {
        for case in 1..100 {
            assert_eq!((1..=count).filter(|index| Shard { index: *index, count }.has(case)).count(), 1);
        }
    }
    let third = Shard::parse("3/40").unwrap();
    assert_eq!((1..100).filter(|case| third.has(*case)).collect::<Vec<_>>(), [3, 43, 83]);
    for bad in ["0/1", "2/1", "1/0", "1/10000", "1", "1/", "-1/2", "a/2"] {
        assert_eq!(Shard::parse(bad), None, "{bad}");
    }
}

#[test]
fn the_columns_of_results_are_distinct() {
    let mut names: Vec<String> = result_columns().into_iter().map(|column| column.name).collect();
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!((names.len(), count), (count, 49));
}
