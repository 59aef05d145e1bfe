//! What a file is that was given in place of another: told by how it begins, so that the message can name the command
//! that takes it.

use crate::cam::cldata::has_word;
use std::path::Path;
use stead_disk::input::InputError;

/// Lines of a file that are looked at.
const LINES: usize = 200;

/// Files that people give in place of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A robot description.
    Urdf,
    /// One with macros, to be expanded first.
    Xacro,
    /// Any other XML.
    Xml,
    /// A tool path of a CAM system.
    Cldata,
    /// A program for a machine tool.
    GCode,
    /// A solid of a CAD system.
    Step,
    /// A robot file of this program.
    RobotFile,
    /// A run file of this program.
    RunFile,
    /// A forces file of this program.
    ForcesFile,
}

impl FileKind {
    /// What the beginning of a file shows it to be.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let text = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]);
        let text = text.trim_start_matches('\u{feff}');
        let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty()).take(LINES);
        let any = |test: fn(&str) -> bool| lines().any(test);
        if lines().next()?.starts_with("ISO-10303") {
            Some(Self::Step)
        } else if lines().next()?.starts_with('<') {
            let text = without_comments(text);
            Some(if !text.contains("<robot") {
                Self::Xml
            } else if text.contains("${") || has_macros(&text) {
                Self::Xacro
            } else {
                Self::Urdf
            })
        } else if any(|line| line == "[[joints]]") {
            Some(Self::RobotFile)
        } else if any(|line| line == "[redundancy]") {
            Some(Self::RunFile)
        } else if any(|line| line == "[stock]") {
            Some(Self::ForcesFile)
        } else if any(has_word) {
            Some(Self::Cldata)
        } else {
            // What comes before the first block of a program: its end marks, its name, remarks.
            let first = lines().find(|line| !line.starts_with(['%', '(', ';', ':']))?;
            (begins_with_word(first, &['O', 'N', 'G', 'T', 'M', 'S', 'F', '#']) && any(is_gcode)).then_some(Self::GCode)
        }
    }

    /// What the beginning of a file shows it to be, where that is no file of this program.
    pub fn foreign(bytes: &[u8]) -> Option<Self> {
        Self::of(bytes).filter(|kind| !matches!(kind, Self::RobotFile | Self::RunFile | Self::ForcesFile))
    }

    /// Refuses a file of any kind but these where a command reads another: with the command that takes it.
    ///
    /// # Errors
    /// [`InputError`] for a file that shows itself to be of another kind.
    pub fn expect(known: &[Self], file: &Path, bytes: &[u8], allowed: &str) -> Result<(), InputError> {
        let Some(kind) = Self::of(bytes).filter(|kind| !known.contains(kind)) else { return Ok(()) };
        let is = match kind {
            Self::Urdf => "is a URDF: `stead import robot` makes a robot file of it",
            Self::Xacro => {
                "is a xacro file, for `stead import robot` once it is expanded: `pip install xacro`, `xacro FILE > arm.urdf`"
            }
            Self::Xml => "is XML, and no URDF",
            Self::Cldata => "is CLDATA of a CAM system: `stead import path` makes a task of it",
            Self::GCode => "is G-code: `stead import path` makes a task of it",
            Self::Step => "is a STEP file of a CAD system",
            Self::RobotFile => "is a robot file already: `robot` of a run file names it",
            Self::RunFile => "is a run file, for `stead place`",
            Self::ForcesFile => "is a forces file, for `stead forces`",
        };
        Err(InputError::new(file, is).allowed(allowed))
    }

    /// That a file is of this kind and not what was requested, and what to do with it.
    pub fn refused(self, file: &Path) -> InputError {
        let (is, allowed) = match self {
            Self::Urdf => ("is a URDF", "the robot file that `stead import robot` makes of it"),
            Self::Xacro => (
                "is a xacro file",
                "the robot file that `stead import robot` makes of its URDF: `pip install xacro`, `xacro FILE > arm.urdf`",
            ),
            Self::Xml => ("is XML", "a file that stead reads: the guide's page `files` has them"),
            Self::Cldata => ("is CLDATA of a CAM system", "the task that `stead import path` makes of it"),
            Self::GCode => ("is G-code", "the task that `stead import path` makes of it"),
            Self::Step => ("is a STEP file", "the same solid saved as STL or OBJ"),
            Self::RobotFile => {
                ("is a robot file", "a run file that names it: `stead init place --robot FILE --task TASK` writes one")
            }
            Self::RunFile => (
                "is a run file of `stead place`",
                "a forces file, with path, [stock] and [tool]: `stead init forces` writes one",
            ),
            Self::ForcesFile => (
                "is a forces file",
                "a run file, which names the task that `stead forces` makes of it, or has [stock] itself",
            ),
        };
        InputError::new(file, is).allowed(allowed)
    }
}

/// The text of XML without its comments, the last of which may go on behind the end.
fn without_comments(text: &str) -> String {
    let mut parts = text.split("<!--");
    let before = parts.next().unwrap_or_default().to_owned();
    parts.fold(before, |all, part| all + part.split_once("-->").map_or("", |(_, rest)| rest))
}

/// Whether there are elements of xacro. Its namespace alone, which files that are expanded still declare, tells only
/// where no link is described.
fn has_macros(text: &str) -> bool {
    let mut declared = text.split("xmlns:").skip(1).filter_map(|rest| {
        let (prefix, value) = rest.split_once('=')?;
        let uri = value.split(['"', '\'']).nth(1)?;
        uri.contains("xacro").then_some(prefix.trim())
    });
    let is_used = |prefix: &str| text.contains(&format!("<{prefix}:"));
    is_used("xacro") || declared.any(|prefix| is_used(prefix) || !text.contains("<link"))
}

/// A block with a preparatory function, with or without its number.
fn is_gcode(line: &str) -> bool {
    let is_numbered = begins_with_word(line, &['N']);
    let numbered = is_numbered.then(|| line[1..].trim_start_matches(|c: char| c.is_ascii_digit()).trim_start());
    begins_with_word(numbered.unwrap_or(line), &['G'])
}

/// Whether a line begins with one of these letters and a digit.
fn begins_with_word(line: &str, letters: &[char]) -> bool {
    let mut rest = line.chars();
    rest.next().is_some_and(|first| letters.contains(&first.to_ascii_uppercase()))
        && rest.next().is_some_and(|c| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_how_they_begin() {
        for (text, kind) in [
            ("<?xml version='1.0'?>\n<robot name='arm'>", Some(FileKind::Urdf)),
            ("<robot xmlns:xacro='http://ros.org/wiki/xacro'>", Some(FileKind::Xacro)),
            ("<robot><xacro:include/><link name='a'/>", Some(FileKind::Xacro)),
            ("<robot xmlns:x = \"http://ros.org/wiki/xacro\">\n<x:arm/>", Some(FileKind::Xacro)),
            ("<robot xmlns:xacro='http://ros.org/wiki/xacro' name='expanded'><link name='a'/>", Some(FileKind::Urdf)),
            (
                "\u{feff}<?xml version='1.0'?>\n<!-- made by xacro from <xacro:macro>, ${pi} -->\n<robot name='arm'>",
                Some(FileKind::Urdf),
            ),
            ("<robot name='xacro'><!-- ends behind xacro:", Some(FileKind::Urdf)),
            ("<robot name='arm'>\n<!-- a --><xacro:arm/>\n<!-- b --></robot>", Some(FileKind::Xacro)),
            ("<robot name='arm'><origin xyz='0 0 ${height}'/>", Some(FileKind::Xacro)),
            ("<sdf version='1.6'><!-- once a <robot> -->", Some(FileKind::Xml)),
            ("$$ made by hand\nTOOL PATH/CONTOUR,TOOL,MILL\n", Some(FileKind::Cldata)),
            ("  goto/ 1, 2, 3\n", Some(FileKind::Cldata)),
            ("$$ CATIA\nMULTAX/ON\nGOTO  / 1, 2, 3\n", Some(FileKind::Cldata)),
            ("$$*          Pro/CLfile\n$$-> MFGNO / A\n", Some(FileKind::Cldata)),
            ("UNITS/ MM\nRAPID\n", Some(FileKind::Cldata)),
            ("%\nO1000\nN10 G90 G54\n", Some(FileKind::GCode)),
            ("(PART)\nG0X0Y0\n", Some(FileKind::GCode)),
            ("ISO-10303-21;\nHEADER;\n", Some(FileKind::Step)),
            ("name = 'arm'\n[[joints]]\n", Some(FileKind::RobotFile)),
            ("path = 'a.nc'\n[stock]\nbox_mm = [1, 2, 3]\n", Some(FileKind::ForcesFile)),
            ("robot = 'arm.toml'\n[redundancy]\n[stock]\n", Some(FileKind::RunFile)),
            ("segment,x_mm\n1,0\n", None),
            ("robot = 'name:kuka-kr500'\n[spindle]\n", None),
            ("gain = 3\nN\nG\n", None),
            ("robot = 'name:kuka-kr\nG500'\n", None),
            ("T1 M6\nG0 X0\n", Some(FileKind::GCode)),
            ("", None),
        ] {
            assert_eq!(FileKind::of(text.as_bytes()), kind, "{text}");
        }
    }
}
