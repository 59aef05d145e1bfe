//! The scripts of the pages: modules in `script/`, joined to one text in the order that their imports need.
//!
//! A page must open from a disk, where a browser loads no modules of other files. So each module becomes a function
//! that returns what it exports, called before those that import from it. Imports name what they take
//! (`import { a, b } from './x.js';`); an export is a declaration with `export` before it, and is never assigned anew,
//! since those that import it have its value.

use std::collections::BTreeMap;

macro_rules! modules {
    ($($folder:literal: $($name:literal)*;)*) => {
        &[$($((
            concat!($folder, "/", $name, ".js"),
            include_str!(concat!("script/", $folder, "/", $name, ".js")),
        ),)*)*]
    };
}

/// All modules: their paths within `script/`, and their texts.
const MODULES: &[(&str, &str)] = modules! {
    "draw": "chart-data" "chart" "dom" "downloads" "heat-map" "plot" "scale" "theme";
    "cards": "main" "polar" "sheet" "table";
    "live": "answers" "concerns" "controls" "drag" "edits" "figures" "follow" "jobs" "main" "pace" "pins"
        "place" "server" "tab";
    "run": "arrows" "axis-tracks" "bodies" "camera" "cards" "cases" "charts" "colour" "data" "external-axes"
        "gpu" "header" "kinematics" "lean-map" "linear" "link" "loads" "main" "map" "mesh" "origins" "path-mesh"
        "path" "play" "printed" "readings" "scene-card" "scene" "shaders" "sheet" "small-table" "state"
        "surroundings" "transport" "yielding";
};

/// Why modules are not joined.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum JoinError {
    /// A module that is not there.
    #[error("there is no module {0}")]
    UnknownModule(String),
    /// A name that a module does not export.
    #[error("{module} imports {name}, which {from} does not export")]
    UnknownName { module: String, name: String, from: String },
    /// An export that is not a declaration of one name, or that can be assigned anew.
    #[error("{module} exports what is no constant, function or class: {line}")]
    Export { module: String, line: String },
    /// Modules that import from each other.
    #[error("{0} imports itself, through others")]
    Circle(String),
}

/// The script of a page: its main module with all that it imports.
pub(super) fn script(main: &str) -> Result<String, JoinError> {
    joined(MODULES, main)
}

fn joined(modules: &[(&str, &str)], main: &str) -> Result<String, JoinError> {
    let mut joiner = Joiner { modules: modules.iter().copied().collect(), ..Joiner::default() };
    joiner.add(main)?;
    Ok(format!("(() => {{\n'use strict';\n{}}})();\n", joiner.script))
}

/// A script on its way.
#[derive(Debug, Default)]
struct Joiner<'a> {
    modules: BTreeMap<&'a str, &'a str>,
    /// The number of each module that is in the script, or on its way into it, and what it exports.
    added: BTreeMap<String, Option<(usize, Vec<String>)>>,
    script: String,
}

impl Joiner<'_> {
    /// Adds a module behind those that it imports from.
    fn add(&mut self, path: &str) -> Result<(), JoinError> {
        match self.added.get(path) {
            Some(Some(_)) => return Ok(()),
            Some(None) => return Err(JoinError::Circle(path.to_owned())),
            None => {}
        }
        let text = *self.modules.get(path).ok_or_else(|| JoinError::UnknownModule(path.to_owned()))?;
        self.added.insert(path.to_owned(), None);
        let mut body = String::with_capacity(text.len());
        let mut exports = Vec::new();
        for line in text.lines() {
            if let Some((names, from)) = import(line) {
                let number = self.imported(path, &names, &beside(path, from))?;
                body.push_str(&format!("const {{ {} }} = module{number};", names.join(", ")));
            } else if let Some(declaration) = line.strip_prefix("export ") {
                let wrong = || JoinError::Export { module: path.to_owned(), line: line.to_owned() };
                if declaration != "{};" {
                    exports.push(declared(declaration).ok_or_else(wrong)?.to_owned());
                    body.push_str(declaration);
                }
            } else if is_remark(line) {
                continue;
            } else {
                body.push_str(line.trim_start());
            }
            body.push('\n');
        }
        let number = self.added.values().flatten().count();
        let returned = exports.join(", ");
        self.script.push_str(&format!("const module{number} = (() => {{\n{body}return {{ {returned} }};\n}})();\n"));
        self.added.insert(path.to_owned(), Some((number, exports)));
        Ok(())
    }

    /// The number of the module that names come from.
    fn imported(&mut self, path: &str, names: &[&str], from: &str) -> Result<usize, JoinError> {
        self.add(from)?;
        let (number, exports) = self.added.get(from).cloned().flatten().unwrap_or_default();
        let unknown = names.iter().find(|name| !exports.iter().any(|export| export == **name));
        unknown.map_or(Ok(number), |name| {
            let (module, name, from) = (path.to_owned(), (*name).to_owned(), from.to_owned());
            Err(JoinError::UnknownName { module, name, from })
        })
    }
}

/// Whether a line is nothing but a remark, which a page does without, as without indentation: both are a fifth of the
/// script.
fn is_remark(line: &str) -> bool {
    let line = line.trim();
    let is_block = ["/**", "* ", "*/"].iter().any(|start| line.starts_with(start)) || line == "*";
    line.is_empty() || line.starts_with("//") || is_block && line.find("*/").is_none_or(|end| end + 2 == line.len())
}

/// The names that a line imports, and from where.
fn import(line: &str) -> Option<(Vec<&str>, &str)> {
    let (names, from) = line.strip_prefix("import { ")?.split_once(" } from '")?;
    Some((names.split(", ").collect(), from.strip_suffix("';")?))
}

/// The name that is declared, where it cannot be assigned anew.
fn declared(declaration: &str) -> Option<&str> {
    let rest = ["const ", "function ", "class "].iter().find_map(|word| declaration.strip_prefix(word))?;
    rest.split(|letter: char| !letter.is_alphanumeric() && letter != '_').next().filter(|name| !name.is_empty())
}

/// The path of a module that another one names.
fn beside(path: &str, named: &str) -> String {
    let mut folders: Vec<&str> = path.split('/').collect();
    folders.pop();
    for part in named.split('/') {
        match part {
            "." => {}
            ".." => drop(folders.pop()),
            part => folders.push(part),
        }
    }
    folders.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every page can be written, every module is in one, and nothing in it ends the script.
    #[test]
    fn the_pages_have_all_modules() {
        let both = ["run/main.js", "cards/main.js", "live/main.js"].map(|main| script(main).unwrap());
        for (path, text) in MODULES {
            let last = text.lines().last().unwrap();
            let is_data = *path == "draw/chart-data.js";
            assert!(
                is_data || both.iter().any(|script| script.contains(last.trim_start_matches("export ").trim_start())),
                "{path}"
            );
            assert!(!text.contains("</") && !text.contains("<!--"), "{path}");
            let imports = text.lines().filter(|line| line.starts_with("import")).all(|line| import(line).is_some());
            assert!(imports, "{path} imports in a way that is not read");
        }
    }

    #[test]
    fn modules_come_before_those_that_import_them_and_once() {
        let modules = [
            ("a/main.js", "import { two } from './two.js';\nimport { one } from '../b/one.js';\ntwo(one);\n"),
            ("a/two.js", "import { one } from '../b/one.js';\nexport const two = () => one;\n"),
            ("b/one.js", "export const one = 1;\nconst own = 2;\n"),
        ];
        let script = joined(&modules, "a/main.js").unwrap();
        let order =
            ["const one = 1;", "const { one } = module0;", "const two", "const { two } = module1;", "two(one);"];
        let places: Vec<usize> = order.iter().map(|part| script.find(part).unwrap()).collect();
        assert!(places.is_sorted(), "{script}");
        assert_eq!(script.matches("const one = 1;").count(), 1);
        assert!(!script.contains("import") && !script.contains("export"));
    }

    #[test]
    fn remarks_and_indentation_are_left_out() {
        let text =
            "// Head.\n\n/**\n * A remark.\n */\nexport const one = () => {\n  // Why.\n  return 1 / 2; // half\n};\n";
        let script = joined(&[("main.js", text)], "main.js").unwrap();
        assert!(script.contains("const one = () => {\nreturn 1 / 2; // half\n};\n"), "{script}");
        assert!(!script.contains("Head") && !script.contains("remark") && !script.contains("Why"), "{script}");
        // What a remark looks like begins no line of a text or of a formula, and block remarks are of whole lines.
        for (path, text) in MODULES {
            let is_open = |line: &str| line.trim_start().starts_with("/*") && !line.trim_start().starts_with("/**");
            assert!(!text.lines().any(is_open), "{path}");
            let mut inside = false;
            for line in text.lines().map(str::trim_start) {
                let is_cast = line.starts_with("/**") && !is_remark(line);
                inside |= line.starts_with("/**") && !is_cast;
                assert!(inside || !line.starts_with('*'), "{path}: {line}");
                assert!(!inside || is_remark(line), "{path}: {line}");
                inside &= !line.contains("*/");
            }
        }
    }

    #[test]
    fn wrong_imports_and_exports_are_refused() {
        let error = |modules: &[(&str, &str)]| joined(modules, "main.js").unwrap_err().to_string();
        let main = ("main.js", "import { a } from './x.js';\n");
        assert_eq!(error(&[main]), "there is no module x.js");
        assert_eq!(error(&[main, ("x.js", "const a = 1;\n")]), "main.js imports a, which x.js does not export");
        let circle = ("x.js", "import { b } from './main.js';\nexport const a = 1;\n");
        assert_eq!(error(&[main, circle]), "main.js imports itself, through others");
        let changing = ("x.js", "export let a = 1;\n");
        assert_eq!(error(&[main, changing]), "x.js exports what is no constant, function or class: export let a = 1;");
    }
}
