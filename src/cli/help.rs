//! The words of the long help: examples, files written and exit codes of each command, and the overview of all commands.

/// The commands by the question that they answer, those of no group last.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Where to put the workpiece", &["place", "score", "explain", "page"]),
    ("Which cell layout is best", &["study"]),
    ("How good a robot is for machining, and how stiff its joints are", &["assess", "identify"]),
    ("What the loaded tool does", &["compensate", "simulate", "stability"]),
    ("What the robot is to run", &["export"]),
    ("How round a measured profile is", &["circularity"]),
    ("What was understood of robots and runs", &["check", "pose", "robots"]),
    ("Input files, shell and manual", &[]),
];

/// The overview of all commands.
pub(super) fn overview(command: &clap::Command) -> String {
    let line = |command: &clap::Command| {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        format!("  {:<12} {about}\n", command.get_name())
    };
    let is_grouped = |name: &str| GROUPS.iter().any(|(_, names)| names.contains(&name));
    let mut text = String::new();
    for (question, names) in GROUPS {
        let members = command.get_subcommands().filter(|member| {
            let name = member.get_name();
            names.contains(&name) || (names.is_empty() && !is_grouped(name))
        });
        text.push_str(&format!("{question}:\n{}\n", members.map(line).collect::<String>()));
    }
    text
}

pub(super) const STEAD: &str = "\
Start with: stead place configs/caro-2013.toml
`stead COMMAND --help` shows examples, the files that a command writes and its exit codes.
With --json a command prints one JSON document on standard output. Notes, warnings, progress and errors go to standard error.

Exit codes: 0 done; 1 the job failed or nothing is feasible; 2 wrong usage or bad input; 130 ended early by Ctrl-C.
Ctrl-C ends a job with what it has by then; pressed again it ends the command at once. Where standard error is no terminal, a line
every 30 s says how far a job is.";

pub(super) const PLACE: &str = "\
Examples:
  stead place configs/caro-2013.toml
  stead place configs/caro-2013.toml --seed 7 --out results/seed-7
  stead place configs/caro-2013.toml --certify 0.5 --no-worst
  stead place configs/caro-2013.toml --set 'cell.z_mm=[-602, -402]' --set robot.joints[1].stiffness_mnm_per_rad=0.8

Files written to the results folder:
  placements.csv                     the four cases: pose, postures, mean and largest deflection
  best.csv, worst.csv                plan of the best and of the worst placement, point by point
  best-worst-plan.csv, worst-worst-plan.csv
                                     the same placements with the worst plan of the spindle angle
  deflection-map-{best,worst}.{csv,svg}
                                     deflection over path point and spindle angle, unless [output] maps = false
  convergence.{csv,svg}, refinements.csv, transfers.csv, cell.svg
  summary.json                       all of it for programs
  report.html, cell.glb, page-data.json
                                     page for the browser, moving 3-D scene, what `stead page` makes both of; not with --no-page
  with --no-worst no file of the worst placement
  stability-{best,worst}.csv, stability.svg
                                     with a table [stability]: critical depth along the path
  certificate.json, open-region.{csv,svg}, open-region-worst.svg
                                     with --certify or a table [certificate]

Exit codes:
  0  done; also when a certificate did not reach its gap or was ended by Ctrl-C
  1  no feasible placement was found, or a file could not be written after the search
  2  wrong usage, bad input, or a results folder that cannot be written to
130  Ctrl-C ended the search: results are the best found so far, maps of a long path are left out";

pub(super) const SCORE: &str = "\
Examples:
  stead score configs/caro-2013.toml --x-mm 2.2 --y-mm -1643.5 --z-mm -556.4 --q4 0.9258
  stead score configs/caro-2013.toml --x-mm 0 --y-mm -1640 --z-mm -214 --yaw-deg 79 --json
  stead score configs/caro-2013.toml --placement-of results/caro-2013 --case 3 --out results/worst
  stead score configs/tilting-table.toml --x-mm 1700 --y-mm 0 --z-mm 700 --yaw-deg 0 --orientation flat

Files written with --out:
  best-plan.csv, worst-plan.csv      the two plans, point by point
  deflection-map.{csv,svg}           deflection over path point and spindle angle, unless [output] maps = false
  placement.svg                      the cell from above with the placement
  report.html, cell.glb, page-data.json
                                     as of `stead place`
  score.json                         what --json prints
  stability-{best,worst}-plan.csv, stability.svg
                                     with a table [stability]: critical depth along the path

Exit codes:
  0  done
  1  the placement is infeasible, with the violated constraints and the path points, or a file could not be written
  2  wrong usage, bad input, or a results folder that cannot be written to
130  ended early by Ctrl-C: both plans are there, critical depths and the map of a long path may be left out";

pub(super) const EXPLAIN: &str = "\
Examples:
  stead explain configs/caro-2013.toml --x-mm 2.2 --y-mm -1643.5 --z-mm -556.4 --q4 0.9258 --point 30 --beta-deg 40
  stead explain configs/caro-2013.toml --placement-of results/caro-2013 --point 30 --beta-deg 40

Files written: none.

Exit codes:
  0  done, whether or not any posture is feasible
  2  wrong usage or bad input";

pub(super) const STUDY_RUN: &str = "\
Examples:
  stead study run configs/study-example.toml
  stead study run configs/study-example.toml --threads 1 --out results/again
  stead study run configs/study-example.toml --shard 3/4
  stead study run configs/study-example.toml --prune

Files written to the results folder:
  study.csv, study.parquet           one row for each case, once every case is done
  study-timing.csv                   where and how long each case was computed
  cases/<number>-<digest>/           with keep in the study file: what `stead place` writes
  study.json, shards/                what is done so far

The command may be killed at any moment: the same command goes on where it was. After an edit of the study file it does what the
edit has changed; kept cases that are not of the study any longer are named, and removed with --prune. Shards may run at the same
time, on many machines, in one folder that they share; the last one writes the table.
The bytes of study.csv and study.parquet depend on neither threads nor shards.

Exit codes:
  0  done; cases without a placement are rows with their reason
  1  a file could not be written; finished cases are kept
  2  wrong usage, bad input, the folder of another study, or a shard that another process works on
130  Ctrl-C ended it; finished cases are kept";

pub(super) const STUDY_SLURM: &str = "\
Example:
  stead study slurm big.toml --shards 40 --threads 4 > big.sh && sbatch big.sh

Files written: none. An element that is killed or requeued goes on where it was; the last one writes the table.

Exit codes:
  0  done
  2  wrong usage, or bad input";

pub(super) const STUDY_STATUS: &str = "\
Examples:
  stead study status configs/study-example.toml
  stead study status configs/study-example.toml --json

Files written: none.

Exit codes:
  0  done, whether or not the study is
  2  wrong usage, bad input, or the folder of another study";

pub(super) const STUDY_REPORT: &str = "\
Examples:
  stead study report configs/study-example.toml
  stead study report configs/study-example.toml --by max_feed_mm_per_s:max
  stead study report configs/study-example.toml --front best_mean_total_mm,cycle_s,min_joint_margin_deg

Files written to the folder of the study:
  study-ranking.csv                  every layout with its rank; ties share one
  study-front.{csv,svg}              layouts that no other is better than in every column of the front
  study-effects.{csv,svg}            what each axis does to the column of the ranking
  study-map.svg                      that column over two axes
  study-report.json, report.html     what --json prints; a page with all of it, which leads to the pages of kept cases

Exit codes:
  0  done
  1  a file could not be written
  2  wrong usage, bad input, or a study that is not done";

pub(super) const ASSESS: &str = "\
Examples:
  stead assess configs/klimchik-2017.toml
  stead assess configs/horizontal-slot.toml --accuracy-mm 0.2 --force-n 500

Files written to the results folder:
  map-<robot>.{csv,svg}              circularity over the plane
  circularity.csv                    smallest, largest and middle circularity of each robot
  optimal-zones.csv, middle-zones.csv
                                     largest circularity in square zones
  accuracy.csv, selection.csv        with forces and accuracies: which robots reach which accuracy
  indicators.svg                     accuracy, reach, payload and price side by side
  cutting.svg, cutting-*.csv         with a cutter and a cut: force and torque over a turn
  summary.json, report.html          all of it for programs; a page whose charts answer to the pointer

Exit codes:
  0  done
  1  no robot can mill the circle anywhere on the map, or the command was interrupted
  2  wrong usage, bad input, or a results folder that cannot be written to";

pub(super) const COMPENSATE: &str = "\
Examples:
  stead compensate configs/compensate-caro-2013.toml
  stead compensate configs/compensate-caro-2013.toml --reality configs/robots/kuka-kr270-2-k1-0.8.toml --out results/check

Files written to the results folder:
  corrected-path.csv                 target and commanded pose, joint angles, deflection before and after, status
  compensation.svg                   deflection before and after along the path
  summary.json, report.html          all of it for programs; a page whose charts answer to the pointer

Exit codes:
  0  done; points that cannot be compensated keep their target, and a warning says so
  1  no point can be compensated, or with --all-or-nothing some cannot; nothing is written, the message names them with the reason
  2  wrong usage, bad input, a plan that does not fit its run, or a results folder that cannot be written to";

pub(super) const IDENTIFY_FIT: &str = "\
Examples:
  stead identify fit configs/identify-example.toml
  stead identify fit configs/identify-example.toml --json --out results/arm-17

Files written to the results folder:
  robot-identified.toml              the robot file with the identified values and their covariance
  compliances.csv                    every estimate with standard deviation and 95 % interval
  residuals.csv, deflections.svg     every reading beside what the identified arm gives
  report.json, report.html           all of it for programs; a page whose charts answer to the pointer

Exit codes:
  0  done
  1  sound readings for which no spring or no positive compliance is found
  2  wrong usage, bad input, or readings from which the parameters are not identifiable";

pub(super) const IDENTIFY_PLAN: &str = "\
Examples:
  stead identify plan configs/identify-plan-example.toml
  stead identify plan configs/identify-plan-example.toml --seed 2 --out results/plan-2

Files written to the results folder:
  sheet.csv                          the measurement sheet to be filled in; never overwritten once it holds a reading
  expected.csv, plan.svg             the standard deviations that `identify fit` will report
  plan.json                          all of it for programs

Exit codes:
  0  done
  1  too few configurations or test poses are within the limits, no compliance is identifiable, or it was interrupted
  2  wrong usage, bad input, or a sheet with readings in the results folder";

pub(super) const CIRCULARITY: &str = "\
Examples:
  stead circularity tasks/measured-groove.csv
  stead circularity tasks/measured-groove.csv --exclude-deg 354:7 --out results/measured-groove

Files written with --out:
  circularity.json                   the four reference circles with their circularity
  deviations.csv                     angle, radii and deviations of every point
  polar.svg, report.html             the profile between its zone circles; a page whose charts answer to the pointer

Exit codes:
  0  done
  1  a file could not be written
  2  wrong usage, bad input, points that lie on no circle, or a folder that cannot be written to";

pub(super) const SIMULATE: &str = "\
Examples:
  stead simulate configs/umons-aluminium.toml
  stead simulate configs/umons-aluminium.toml --variant gravity --fast
  stead simulate configs/umons-steel.toml --damping-scale 10 --out results/steel-damped

Files written to the results folder:
  series.csv                         forces and tool positions over time
  wall.csv, wall.svg                 profile of the wall that is left, and its roughness
  forces.svg, turns.svg              forces over the pass, and over three turns of the spindle
  summary.json, report.html          all of it for programs; a page whose charts answer to the pointer

Exit codes:
  0  done; an unstable cut is a result, too
  1  the pass cannot be simulated, or a file could not be written
  2  wrong usage, bad input, or a results folder that cannot be written to";

pub(super) const STABILITY: &str = "\
Examples:
  stead stability configs/umons-steel.toml
  stead stability configs/umons-steel.toml --damping-scale 10 --spindle-rpm 5000 --out results/steel-5000

Files written to the results folder:
  lobes.{csv,svg}                    critical depth over spindle speed
  frequency-response.{csv,svg}       frequency response function of the tool tip
  modes.csv                          natural frequencies, damping ratios and mode shapes
  summary.json, report.html          all of it for programs, with the verdict on the given cut; a page of it

Exit codes:
  0  done, whether the cut is stable or not
  1  the small motions of the arm cannot be computed there, or a file could not be written
  2  wrong usage, bad input, or a results folder that cannot be written to";

pub(super) const IMPORT_PATH: &str = "\
Examples:
  stead import path part.cls --units mm --out my/part.csv --report
  stead import path part.nc --machine table-ac --step-mm 5 --out my/part.csv

Files written: the task file, and beside it NAME-tool.toml with the cutter, where the program describes one. The task has no
forces: a run takes them from [tool] and [cut], or from [forces]. `stead init place --robot .. --task ..` takes both files.

Exit codes:
  0  done
  2  wrong usage, a program that is refused, with line and word, or a file that is there already (--force replaces it):
     nothing is written";

pub(super) const CHECK: &str = "\
Examples:
  stead check my/run.toml
  stead check my/run.toml --out results/check
  stead check my/kr210.toml --json

Files written with --out:
  check.svg                          the arm from its rows, from the side and from above, with cell and tool path

Exit codes:
  0  done; what looks wrong is noted
  1  the picture could not be written
  2  wrong usage, bad input, or a folder that cannot be written to";

pub(super) const POSE: &str = "\
Examples:
  stead pose name:kuka-kr210-r2700 --controller-deg 0,-90,90,0,30,0
  stead pose my/kr210.toml --joints-deg 10,80,-160,5,30,-20 --tool-of my/run.toml --json

Frames are printed in the base frame of the rows, and in the controller's robot root where the robot file has the tables
[controller] and [root]. A robot file without stiffness will do.

Files written: none.

Exit codes:
  0  done; also where an angle is beyond its limits, which is noted
  2  wrong usage or bad input";

pub(super) const ROBOTS: &str = "\
Examples:
  stead robots
  stead robots --json
  stead robots abb-irb6640-235 > my/arm.toml

A shipped arm takes the place of a robot file by its name: robot = \"name:kuka-kr270-2\".

Files written: none.

Exit codes:
  0  done
  2  wrong usage";

pub(super) const IMPORT_ROBOT: &str = "\
Examples:
  stead import robot kr120.urdf --out my/kr120.toml
  stead import robot cell.urdf --base-link base_link --tip-link tool0 --out my/arm.toml
  stead import robot kr210.urdf --stiffness-like kuka-kr270-r2700 --collision --out my/kr210.toml
  stead import robot kr210.urdf --controller kuka --out my/kr210.toml \\
      --home-deg=-31.2,-71.4,63.7,17.9,52.6,-117.3=1791.52,1023.61,1741.52,99.95,-2.34,131.94

Files written: the robot file, and with --collision NAME-cell.toml beside it: the links as shapes of surroundings.
Joint stiffness is not in a URDF: its six lines are written commented out, or with --stiffness-like taken from a shipped arm
(`stead robots` lists them), which ranks placements and does not predict millimetres.

Exit codes:
  0  done
  2  wrong usage, a URDF that is refused, with line and element, or a file that is there already (--force replaces it):
     nothing is written";

pub(super) const INIT: &str = "\
Examples:
  stead init place my-cell
  stead init simulate my-arm
  stead init place --robot my/kr210.toml --task my/part.csv --out my/run.toml

Files written to the folder:
  place       run.toml, robot.toml, task.csv, cell.toml
  assess      assess.toml, robot.toml
  identify    identify.toml, robot.toml, sheet.csv
  simulate    simulate.toml, robot.toml (for stead stability too)
  study       study.toml and the files of place; beside a run.toml that is there, study.toml alone
  compensate  compensate.toml, likewise
With --robot, --task and --out: one run file for files that are there, with the shapes (ROBOT-cell.toml) and the cutter
(TASK-tool.toml) that stead import has left beside them; what they do not say is a guess, marked as one.

Exit codes:
  0  done
  2  wrong usage, or one of the files exists already (--force replaces it): nothing is written and nothing is changed";

pub(super) const SCHEMA: &str = "\
Examples:
  stead schema run > run.schema.json
  stead schema robot

An editor that knows TOML completes and checks the keys of a file whose first line is `#:schema` and the path of its schema.

Files written: none; the schema goes to standard output.

Exit codes:
  0  done
  2  wrong usage, or there is no schema of this name";

pub(super) const COMPLETIONS: &str = "\
Examples:
  stead completions bash > ~/.local/share/bash-completion/completions/stead
  stead completions zsh > ~/.zfunc/_stead
  stead completions fish > ~/.config/fish/completions/stead.fish

Files written: none; the script goes to standard output.

Exit codes:
  0  done
  2  wrong usage";

pub(super) const MAN: &str = "\
Examples:
  stead man ~/.local/share/man/man1
  man stead-place

Files written to the folder: stead.1, and stead-COMMAND.1 for every command.

Exit codes:
  0  done
  1  a page could not be written
  2  wrong usage, or a folder that cannot be written to";
