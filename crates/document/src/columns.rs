//! Text in columns, for people.

/// Columns with two blanks between them, to the right but for the given ones.
pub fn aligned(rows: &[Vec<String>], to_the_left: &[usize]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
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
