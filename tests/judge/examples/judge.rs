//! `cargo run -p stead-judge --example judge -- RUN.toml RESULTS [PROGRAM ..]`: what the judge finds in results, and in
//! main files of programs.

fn main() -> Result<(), String> {
    let arguments: Vec<std::path::PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    let [run, results, programs @ ..] = &arguments[..] else {
        return Err("usage: judge RUN.toml RESULTS [PROGRAM ..]".to_owned());
    };
    let mut verdict = stead_judge::judge(run, results)?;
    for program in programs {
        verdict.join(stead_judge::judge_program(run, results, program)?);
    }
    println!("{verdict}");
    Ok(())
}
