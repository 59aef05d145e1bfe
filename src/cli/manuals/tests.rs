//! The guide and the shipped results are held to what the commands declare.

use super::*;
use crate::cli::command;
use crate::cli::manual::expanded;
use std::collections::BTreeSet;
use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn manual(name: &str) -> &'static Manual {
    let found = MANUALS.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("no command {name}")).1
}

/// A command by its name, as `study run`.
fn command_of(name: &str) -> clap::Command {
    let whole = command();
    let found = name.split(' ').try_fold(&whole, |above, name| above.find_subcommand(name));
    found.unwrap_or_else(|| panic!("no command {name}")).clone()
}

/// Words of the help in Markdown: options, tables of files and elements as code.
fn marked(words: &str) -> String {
    let word = |word: &str| {
        let core = word.trim_end_matches([',', ';', ':', '.']);
        let is_code = core.starts_with("--") || core.starts_with('<') || core.contains('[');
        if is_code { format!("`{core}`{}", &word[core.len()..]) } else { word.to_owned() }
    };
    words.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// What help and its end, as `[default: results]`, say of an option.
fn said(option: &clap::Arg) -> (String, String) {
    let help = option.get_help().map(ToString::to_string).unwrap_or_default();
    let (meaning, default) = help.split_once(" [default: ").unwrap_or((&help, ""));
    (meaning.to_owned(), default.trim_end_matches(']').to_owned())
}

/// The guide's table of the files that a command writes.
fn file_table(name: &str) -> String {
    let command = command_of(name);
    let out = command.get_arguments().find(|option| option.get_long() == Some("out")).map(|option| said(option).1);
    let place = out.filter(|folder| folder.starts_with("results")).map(|folder| format!(" in `{folder}`"));
    let row = |(names, content): (&str, &str)| {
        let names: Vec<_> =
            names.split(", ").map(|name| if name == ".." { name.to_owned() } else { format!("`{name}`") }).collect();
        format!("| {} | {} |\n", names.join(", "), marked(content))
    };
    let rows: String = manual(name).files().map(row).collect();
    format!("| file{} | content |\n|---|---|\n{rows}", place.unwrap_or_default())
}

/// The guide's table of the options of a command.
fn option_table(name: &str) -> String {
    let row = |option: &clap::Arg| {
        let (meaning, stated) = said(option);
        let takes_value = option.get_action().takes_values();
        let values = option.get_default_values().iter().map(|value| value.to_string_lossy());
        let default = match stated.as_str() {
            "" if option.is_required_set() => "required".to_owned(),
            "" if takes_value => values.collect::<Vec<_>>().join(","),
            stated => stated.to_owned(),
        };
        let value = option.get_value_names().filter(|_| takes_value).unwrap_or_default();
        let value: String = value.iter().map(|value| format!(" {value}")).collect();
        let known: Vec<_> =
            option.get_possible_values().iter().map(|value| format!("`{}`", value.get_name())).collect();
        let known = if takes_value && !known.is_empty() && !meaning.contains(option.get_possible_values()[0].get_name())
        {
            format!(": {}", known.join(", "))
        } else {
            String::new()
        };
        let name = option.get_long().unwrap_or_default();
        format!("| `--{name}{value}` | {default} | {}{known} |\n", marked(&meaning))
    };
    let command = command_of(name);
    let options = command.get_arguments().filter(|argument| argument.get_long().is_some_and(|name| name != "help"));
    format!("| option | default | meaning |\n|---|---|---|\n{}", options.map(row).collect::<String>())
}

/// A page with the table below each mark, as `<!-- files: place -->`, made anew.
fn renewed(page: &str) -> String {
    let (mut text, mut lines) = (String::new(), page.lines().peekable());
    while let Some(line) = lines.next() {
        text += &format!("{line}\n");
        let mark = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->")?.split_once(": "));
        if let Some((kind, name)) = mark {
            text += &format!("\n{}", if kind == "files" { file_table(name) } else { option_table(name) });
            while lines.next_if(|line| line.is_empty() || line.starts_with('|')).is_some() {}
            if lines.peek().is_some() {
                text.push('\n');
            }
        }
    }
    text
}

#[test]
fn tables_of_the_guide_are_those_of_the_commands() {
    let (mut stale, mut marks) = (Vec::new(), 0);
    for entry in std::fs::read_dir(root().join("src/guide")).unwrap() {
        let file = entry.unwrap().path();
        let Some(name) = file.extension().is_some_and(|end| end == "md").then(|| file.file_name().unwrap()) else {
            continue;
        };
        let page = std::fs::read_to_string(&file).unwrap();
        marks += page.matches("\n<!-- files: ").count() + page.matches("\n<!-- options: ").count();
        if renewed(&page) != page {
            let made = std::env::temp_dir().join(name);
            std::fs::write(&made, renewed(&page)).unwrap();
            stale.push(format!("cp {} {}", made.display(), file.display()));
        }
    }
    assert!(stale.is_empty(), "renew them: {}", stale.join(" && "));
    assert!(marks >= 14, "{marks}");
}

/// Whether a file has a name, in which `*` and `<..>` stand for anything.
fn is_named(file: &str, name: &str) -> bool {
    match name.split_once(['*', '<']) {
        Some((before, rest)) => {
            let after = rest.split_once('>').map_or(rest, |(_, after)| after);
            file.starts_with(before) && file.ends_with(after)
        }
        None => file == name,
    }
}

/// Every file of a shipped results folder is among those that its command says it writes, and what a command says
/// without a condition is there.
#[test]
fn commands_write_the_files_that_they_declare() {
    let mut checked = BTreeSet::new();
    for entry in std::fs::read_dir(root().join("results")).unwrap() {
        let folder = entry.unwrap().path();
        let text = std::fs::read_to_string(folder.join("manifest.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
        for result in manifest["results"].as_array().unwrap() {
            let name = result["command"].as_str().unwrap();
            let files = result["files"].as_array().unwrap();
            let files: Vec<&str> = files.iter().map(|file| file["name"].as_str().unwrap()).collect();
            let declared = manual(name).files().flat_map(|(names, content)| {
                names.split(", ").flat_map(expanded).map(move |name| (name, content.split(' ').next() == Some("with")))
            });
            let declared: Vec<(String, bool)> = declared.collect();
            let unknown: Vec<_> =
                files.iter().filter(|file| !declared.iter().any(|(name, _)| is_named(file, name))).collect();
            assert!(unknown.is_empty(), "{name} does not declare {unknown:?}");
            // Folders, and what manifests do not list.
            let listed = declared.iter().filter(|(name, is_conditional)| !is_conditional && !name.ends_with('/'));
            let is_kept = |name: &str| !matches!(name, "study-timing.csv" | "study.json");
            let missing: Vec<_> = listed
                .map(|(name, _)| name)
                .filter(|name| is_kept(name))
                .filter(|name| !files.iter().any(|file| is_named(file, name)))
                .collect();
            assert!(missing.is_empty(), "{}: {name} declares {missing:?}", folder.display());
            checked.insert(name.to_owned());
        }
    }
    assert!(checked.len() >= 9, "{checked:?}");
}

/// The commands by which the guide says that a kind of file is read are those that take one.
#[test]
fn the_guide_says_which_commands_read_a_file() {
    let page = read("src/guide/files.md");
    let table =
        page.lines().skip_while(|line| !line.starts_with("| file |")).skip(2).take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for row in table {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let stated: BTreeSet<&str> = cells[2].split('`').skip(1).step_by(2).collect();
        let kind = cells[0];
        let takes = |name: &&str| {
            command_of(name).get_positionals().any(|argument| {
                let help = argument.get_help().unwrap().to_string().to_lowercase();
                [" file", " (", " that"].iter().any(|next| help.starts_with(&format!("{kind}{next}")))
                    || help.contains(&format!("or {kind} file"))
            })
        };
        let reading: BTreeSet<&str> = MANUALS.iter().map(|(name, _)| *name).filter(takes).collect();
        assert_eq!(stated, reading, "{kind}");
        count += reading.len();
    }
    assert!(count >= 15, "{count}");
}

/// The guide's table of starter sets has the files of `stead init`.
#[test]
fn the_guide_has_the_starter_sets() {
    let page = read("src/guide/starting.md");
    let names = |text: &str| -> BTreeSet<String> {
        let words = text.split([' ', ',', '`', ';']).filter(|word| word.ends_with(".toml") || word.ends_with(".csv"));
        words.map(str::to_owned).collect()
    };
    for (set, files) in manual("init").files() {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{set}` |"))).unwrap();
        let written = files.split(';').next().unwrap();
        assert_eq!(names(row.split('|').nth(2).unwrap()), names(written), "{set}");
    }
}

/// Every command is in the README's table.
#[test]
fn the_readme_lists_every_command() {
    let readme = read("README.md");
    let rows = readme.lines().filter(|line| line.starts_with("| `stead "));
    let listed: String = rows.map(|row| row.split('|').nth(1).unwrap().replace('`', " ")).collect();
    for command in command().get_subcommands() {
        let name = command.get_name();
        assert!(listed.contains(&format!("stead {name} ")) || listed.contains(&format!(",  {name} ")), "{name}");
    }
}
