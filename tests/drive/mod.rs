//! Runs drawn over all options, placed and exported in this process, and held against the judge.

use std::path::Path;
use stead::files::Existing;
use stead::forces::ForcesRun;
use stead::program::{ExportOptions, ProgramFormat};
use stead::{Monitor, Run};
use stead_judge::Verdict;
use stead_judge::cover::{Choice, words};

/// What became of a run.
#[derive(Debug)]
pub enum Outcome {
    /// It was placed, and judged.
    Judged(Verdict),
    /// No placement was found, in the words of the product.
    NotPlaced(String),
    /// It was refused, or could not be judged.
    Failed(String),
}

/// Writes the files of a choice, runs them, and judges.
pub fn drive(choice: &Choice, seed: u64, folder: &Path) -> Outcome {
    run(choice, seed, folder).unwrap_or_else(|error| Outcome::Failed(format!("{error}\n    {}", words(choice))))
}

fn run(choice: &Choice, seed: u64, folder: &Path) -> Result<Outcome, String> {
    let told = |error: stead::Error| error.to_string();
    // From the root and from experiments/.
    let mut above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|folder| folder.join("configs/robots"));
    let robots = above.find(|folder| folder.exists()).ok_or("there is no configs/robots")?;
    let files = stead_judge::write::write(choice, seed, &robots, folder)?;
    if let Some([file, task]) = &files.forces {
        let forces = ForcesRun::read(file).and_then(|run| run.compute(&Monitor::silent())).map_err(told)?;
        forces.write(task, Existing::Kept).map_err(told)?;
    }
    let run = Run::read(&files.run).map_err(told)?;
    let placements = match run.place(&Monitor::silent()) {
        Ok(placements) => placements,
        Err(error) if !error.is_bad_input() => return Ok(Outcome::NotPlaced(error.to_string())),
        Err(error) => return Err(error.to_string()),
    };
    let results = folder.join("results");
    placements.write(&results).map_err(told)?;
    let mut verdict = stead_judge::judge(&files.run, &results)?;
    if let Some(format) = files.program {
        let format = match format {
            "krl" => ProgramFormat::Krl,
            "rapid" => ProgramFormat::Rapid,
            "fanuc" => ProgramFormat::Fanuc,
            _ => ProgramFormat::Csv,
        };
        let mut options = ExportOptions::new(format, "PART");
        options.mechanism = (files.part_moves && format == ProgramFormat::Krl).then_some(2);
        options.unit = (files.part_moves && format == ProgramFormat::Rapid).then_some("STN1");
        let plan = results.join("best.csv");
        // An arm that cannot be drawn back so far is refused: then without.
        let export = run.export(&plan, &options, &Monitor::silent()).or_else(|_| {
            options.approach = 0.0;
            run.export(&plan, &options, &Monitor::silent())
        });
        match export {
            Ok(program) => {
                let written = program.write(&results, Existing::Kept).map_err(told)?;
                verdict.join(stead_judge::judge_program(&files.run, &results, &written.files[0])?);
            }
            // A move that hits is refused by name.
            Err(error) => verdict.not_exported.push(error.to_string()),
        }
    }
    Ok(Outcome::Judged(verdict))
}
