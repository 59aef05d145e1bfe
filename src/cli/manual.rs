//! What a command says of itself: examples, files written and exit codes. Each command declares it beside its options;
//! long help, manual pages and the tables of the guide are made of it. Here is how it is laid out.

/// What long help and guide say of a command beyond its options.
pub(super) struct Manual {
    /// Command lines to copy.
    pub examples: &'static [&'static str],
    /// Where the files go, or why there are none: what follows "Files written".
    pub written: &'static str,
    /// Names of files, as `wall.csv, map-{best,worst}.{csv,svg}`, and behind a colon what they hold: a line each.
    pub files: &'static str,
    /// What else one has to know.
    pub remarks: &'static str,
    /// When it ends with exit code 0.
    pub done: &'static str,
    /// When it ends with exit code 1, if ever.
    pub failed: &'static str,
    /// When it ends with exit code 2.
    pub refused: &'static str,
    /// When it ends with exit code 130, if ever.
    pub interrupted: &'static str,
}

/// Columns of a terminal.
const WIDTH: usize = 120;

/// Of a command that has nothing to write before it is done.
pub(super) const STOPPED: &str = "Ctrl-C ended it early: nothing is written";

impl Manual {
    /// What most commands say.
    pub const NEW: Self = Self {
        examples: &[],
        written: "to the results folder",
        files: "",
        remarks: "",
        done: "done",
        failed: "",
        refused: "wrong usage or bad input",
        interrupted: "",
    };

    /// Names of files with what they hold, line by line.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, &'static str)> + use<> {
        self.files.lines().filter_map(|line| line.split_once(": "))
    }

    /// The names of the files that it writes, those alone that are known before it has run.
    pub fn file_names(&self) -> Vec<String> {
        let names = self.files().flat_map(|(names, _)| names.split(", "));
        names.flat_map(expanded).filter(|name| name.contains('.') && !name.contains(['/', '<'])).collect()
    }

    /// The end of the long help.
    pub fn text(&self) -> String {
        let heading = if self.examples.len() == 1 { "Example:" } else { "Examples:" };
        let mut text = self.examples.iter().fold(heading.to_owned(), |text, line| text + "\n  " + line);
        text += "\n\nFiles written";
        if self.files.is_empty() {
            text += &format!(": {}.", self.written);
        } else {
            let widths = self.files().map(|(names, _)| names.len());
            let width = widths.max().unwrap_or(0).min(38);
            text += &format!(" {}:", self.written);
            for (names, content) in self.files() {
                // Names that leave no room stand on a line of their own.
                let gap = if names.len() > width {
                    "\n".to_owned() + &" ".repeat(width + 4)
                } else {
                    " ".repeat(width + 2 - names.len())
                };
                text += &format!("\n  {names}{gap}{}", wrapped(content, width + 4));
            }
        }
        if !self.remarks.is_empty() {
            text += &format!("\n\n{}", wrapped(self.remarks, 0));
        }
        let codes = [(0, self.done), (1, self.failed), (2, self.refused), (130, self.interrupted)];
        let codes = codes.iter().filter(|(_, meaning)| !meaning.is_empty());
        let codes = codes.map(|(code, meaning)| format!("\n{code:>3}  {}", wrapped(meaning, 5)));
        text + "\n\nExit codes:" + &codes.collect::<String>()
    }
}

/// Words in lines, those after the first indented.
fn wrapped(words: &str, indent: usize) -> String {
    let (mut text, mut column) = (String::new(), indent);
    for word in words.split(' ') {
        let length = word.chars().count();
        if column > indent && column + 1 + length > WIDTH {
            text += &format!("\n{}", " ".repeat(indent));
            column = indent;
        } else if column > indent {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text
}

/// The names that one with alternatives in braces stands for.
pub(super) fn expanded(name: &str) -> Vec<String> {
    let Some((before, (among, behind))) =
        name.split_once('{').and_then(|(before, rest)| Some((before, rest.split_once('}')?)))
    else {
        return vec![name.to_owned()];
    };
    among.split(',').flat_map(|one| expanded(&format!("{before}{one}{behind}"))).collect()
}
