//! `stead check --environment`: what a report of a fault has to state of program and machine.

use super::VERSION;
use super::values::beside_the_program;
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::Path;
use std::process::Command;
use stead_disk::files::{self, Lock, PREFIX, Staged, TryLock};

/// A line for each thing.
pub(super) fn environment() -> String {
    let shown = |path: std::io::Result<std::path::PathBuf>| {
        path.map_or_else(|cause| format!("unknown: {cause}"), |path| path.display().to_string())
    };
    let here = std::env::current_dir();
    let temporary = std::env::temp_dir();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let shipped = beside_the_program(Path::new("configs")).map(|path| path.display().to_string());
    let terminal = |is: bool| if is { "terminal" } else { "file or pipe" };
    let lines = [
        ("stead", VERSION.to_owned()),
        ("program", shown(std::env::current_exe())),
        ("shipped files", shipped.unwrap_or_else(|| "none beside the program".to_owned())),
        ("system", system()),
        ("processors", format!("{threads}, {}", vectors())),
        ("folder", shown(here.as_ref().map(Clone::clone).map_err(|cause| cause.kind().into()))),
        ("", here.map_or_else(|_| String::new(), |here| use_of(&here))),
        ("temporary files", temporary.display().to_string()),
        ("", use_of(&temporary)),
        ("output", terminal(std::io::stdout().is_terminal()).to_owned()),
        ("messages", terminal(std::io::stderr().is_terminal()).to_owned()),
        ("stead live", if cfg!(feature = "live") { "part of this build" } else { "no part of this build" }.to_owned()),
    ];
    lines.iter().fold(String::new(), |mut text, (name, value)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<16} {value}");
        text
    })
}

/// The system by its own words.
fn system() -> String {
    let (program, arguments): (_, &[&str]) = if cfg!(windows) { ("cmd", &["/c", "ver"]) } else { ("uname", &["-srm"]) };
    let said = Command::new(program).args(arguments).output().ok().map(|run| run.stdout).unwrap_or_default();
    format!("{} {}, {}", std::env::consts::OS, std::env::consts::ARCH, String::from_utf8_lossy(&said).trim())
}

/// The vectors that the processor has, of those that stead uses.
fn vectors() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        return "AVX2";
    }
    "no AVX2: searches take longer, with the same results"
}

/// Whether files can be written and locked in a folder.
fn use_of(folder: &Path) -> String {
    if let Err(cause) = Staged::write(folder, PREFIX, b"") {
        return format!("cannot be written to: {cause}");
    }
    let probe = folder.join(format!("{PREFIX}environment"));
    let locks = match Lock::attempt_passing(&probe) {
        Ok(TryLock::Taken(lock)) if !lock.is_locked => "no locks: one run at a time is up to you".to_owned(),
        Ok(_) => "locks work".to_owned(),
        Err(cause) => format!("no file can be locked: {cause}"),
    };
    // Where it cannot be removed, it keeps nobody out.
    let _ = files::remove(&probe);
    format!("can be written to, {locks}")
}
