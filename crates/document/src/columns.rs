//! Text in columns, for people.

/// Rows under their header, in columns with two blanks between them, to the right but for the given ones.
pub fn table<N: Into<String>>(
    header: impl IntoIterator<Item = N>,
    rows: impl IntoIterator<Item = Vec<String>>,
    to_the_left: &[usize],
) -> String {
    let header: Vec<String> = header.into_iter().map(Into::into).collect();
    let columns = header.len();
    let rows: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in &rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| {
            if to_the_left.contains(&k) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        line(&mut text, cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

/// Adds a line to a text.
pub fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}
