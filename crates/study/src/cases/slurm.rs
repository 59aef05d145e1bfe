//! Studies as arrays of Slurm.

use std::path::Path;

/// The script of a Slurm array that does a study in so many shards, an element each, with the binary `stead`. An
/// element that is requeued goes on where it was. Paths are taken as they are, so absolute ones let `sbatch` be called
/// anywhere.
pub fn slurm_script(stead: &Path, study: &Path, folder: &Path, shards: usize, threads: usize) -> String {
    let quoted = |path: &Path| format!("'{}'", path.display().to_string().replace('\'', r"'\''"));
    let name: String = study.file_stem().unwrap_or_default().to_string_lossy().chars().map(in_a_name).collect();
    format!(
        "#!/bin/bash
#SBATCH --job-name=stead-{name}
#SBATCH --array=1-{shards}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={threads}
# Each element does its shard of the study; one that is killed or requeued goes on where it was, and the last one writes the table.
set -eu
exec {} study run {} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads {threads} --out {}
",
        quoted(stead),
        quoted(study),
        quoted(folder),
    )
}

/// A character of a job's name.
fn in_a_name(character: char) -> char {
    if character.is_ascii_alphanumeric() || "-_.".contains(character) { character } else { '-' }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_any_kind_stay_names() {
        let script = slurm_script(
            Path::new("/opt/my tools/stead"),
            Path::new("/home/o'neill/cell $HOME;.toml"),
            Path::new("/scratch/a\"b"),
            40,
            2,
        );
        let lines: Vec<&str> = script.lines().collect();
        assert_eq!(lines[..3], ["#!/bin/bash", "#SBATCH --job-name=stead-cell--HOME-", "#SBATCH --array=1-40"]);
        assert_eq!(
            lines.last().copied(),
            Some(
                "exec '/opt/my tools/stead' study run '/home/o'\\''neill/cell $HOME;.toml' --shard \
                 \"$SLURM_ARRAY_TASK_ID/40\" --threads 2 --out '/scratch/a\"b'"
            )
        );
    }
}
