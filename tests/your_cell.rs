//! The page "Your own cell in fifteen minutes", command by command, as it stands.

use crate::common::Bench;

const PAGE: &str = include_str!("../src/guide/your_cell.md");

/// A block of the page in a language: its lines.
struct Block<'a> {
    language: &'a str,
    lines: Vec<&'a str>,
}

fn blocks() -> Vec<Block<'static>> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    let mut is_inside = false;
    for line in PAGE.lines() {
        match line.strip_prefix("```") {
            Some(language) => {
                is_inside = !is_inside;
                if is_inside {
                    blocks.push(Block { language, lines: Vec::new() });
                }
            }
            None if is_inside => blocks.last_mut().unwrap().lines.push(line),
            None => {}
        }
    }
    blocks
}

/// Puts the lines of a block of TOML in the places of those of the same table and key of a file.
fn edit(bench: &Bench, file: &str, lines: &[&str]) {
    let mut edited: Vec<String> = bench.read(file).lines().map(str::to_owned).collect();
    let mut table = String::new();
    for line in lines.iter().filter(|line| !line.is_empty()) {
        if line.starts_with('[') {
            table = (*line).to_owned();
            continue;
        }
        let key = format!("{} ", line.split(' ').next().unwrap());
        let from = edited.iter().position(|own| own.starts_with(&table)).unwrap_or_else(|| panic!("{table} in {file}"));
        let at =
            edited[from..].iter().position(|own| own.starts_with(&key)).unwrap_or_else(|| panic!("{key} in {file}"));
        edited[from + at] = (*line).to_owned();
    }
    bench.write(file, &(edited.join("\n") + "\n"));
}

#[test]
fn every_command_of_the_page_works_as_it_stands() {
    let bench = Bench::new();
    bench.copy("crates/format/src/urdf/fixtures/kuka.urdf", "arm.urdf");
    bench.copy("tasks/pocket.cls", "part.cls");
    let mut commands = 0;
    for block in blocks() {
        if block.language == "toml" {
            edit(&bench, "my/run.toml", &block.lines);
            continue;
        }
        // A line that ends with a backslash goes on in the next one.
        let text = block.lines.join("\n").replace("\\\n", "");
        for line in text.lines() {
            let mut words: Vec<&str> = line.split_whitespace().collect();
            assert_eq!(words.remove(0), "stead", "{line}");
            // So small a search that it takes seconds.
            let small = ["--set", "search.population=16", "--set", "search.generations=3", "--set", "search.basins=1"];
            if words[0] == "place" {
                words.extend(small);
            }
            let ended = bench.stead(&words);
            assert_eq!(ended.code, Some(0), "{line}: {}{}", ended.stdout, ended.stderr);
            commands += 1;
        }
    }
    assert_eq!(commands, 7);
    for made in ["my/arm.toml", "my/part.csv", "my/check/check.svg", "my/results/summary.json", "my/program/PART.src"] {
        assert!(bench.path(made).is_file(), "{made}");
    }
}
