//! Programs of runs with surroundings: ways between segments in every form, with external axes too, read back.

use super::bench::{ARMS, Bench};
use super::external_axes::{TABLES, options, positions};
use crate::check::{ReadBackOptions, check};
use crate::{ExportError, ExportOptions, ProgramFormat, export};
use stead_numerics::monitor::{Monitor, Progress, Stop, StopHandle};

const SPINDLE: &str = "[[shape]]
name = 'spindle, long'
attached = 'flange'
capsule_mm = { radius = 40, length = 100 }
xyz_mm = [0, 0, 150]
";

/// With zones that the tool has to go round, or cannot leave.
fn zones() -> Vec<String> {
    let hood = |x: i32, height: i32| {
        format!(
            "[[keep_out]]\nname = 'hood'\npoints = ['tool']\nbox_mm = [500, 500, {height}]\nxyz_mm = [{x}, 250, {}]\n",
            1000 + height
        )
    };
    vec![String::new(), hood(1500, 300), hood(1350, 600), hood(1200, 100)]
}

#[test]
fn programs_among_surroundings_are_read_back_with_what_hits() {
    for (name, _, format) in ARMS {
        for (zone, axes) in zones().iter().flat_map(|zone| [(zone, ""), (zone, TABLES)]) {
            let of_axes = positions(name);
            let at = |point: usize| if axes.is_empty() { Vec::new() } else { of_axes(point) };
            let bench = Bench::with(name, &format!("{SPINDLE}{zone}{axes}"), at);
            for (format, folder) in [(format, "maker"), (ProgramFormat::Csv, "table")] {
                let plain = ExportOptions { format, allow_blocked_moves: true, ..bench.options() };
                let requested = if axes.is_empty() {
                    plain
                } else {
                    ExportOptions { allow_blocked_moves: true, ..options(&bench, format) }
                };
                let program = bench.export(&requested).unwrap();
                let is_said = program.files.iter().any(|file| file.text.contains("collisions were not checked"));
                let is_around = !zone.is_empty();
                assert_eq!(is_said, !is_around && format != ProgramFormat::Csv, "{name} {format:?}");
                let found = bench.check(&bench.written(&program, folder)).unwrap();
                assert!(found.is_sound(), "{name} {format:?} {zone}: {found:?}");
                // Others tell of lines out of the cut that are short.
                let blocked = program.warnings.iter().filter(|warning| warning.to_string().starts_with("NOT FREE: "));
                assert_eq!(found.hits.len(), blocked.count(), "{name} {format:?} {zone}: {found:?}");
                assert!(found.hits.iter().all(|hit| !zone.is_empty() && hit.pair == "tool and hood"));
                let marked = program.files.iter().any(|file| {
                    file.text.contains("NOT FREE: this move hits") || file.text.contains(",\"tool and hood\"")
                });
                assert_eq!(marked, !found.hits.is_empty());
            }
        }
    }
}

#[test]
fn external_axes_stay_on_the_way_out_and_stand_right_on_the_way_in() {
    let bench = Bench::with("kuka", &format!("{SPINDLE}{TABLES}"), positions("kuka"));
    let program = bench.export(&options(&bench, ProgramFormat::Krl)).unwrap();
    let lines: Vec<&str> = program.files[1].text.lines().collect();
    let at = lines.iter().position(|line| *line == "; segment 2, by a free way").unwrap();
    // Point 3 ends segment 1, point 4 begins segment 2.
    assert!(lines[at - 1].starts_with("LIN ") && lines[at - 1].contains(",E1 -10.00000,"), "{}", lines[at - 1]);
    assert!(lines[at + 2].starts_with("PTP ") && lines[at + 2].contains(",E1 0.00000,"), "{}", lines[at + 2]);
    assert!(lines[at + 3].starts_with("LIN ") && lines[at + 3].contains(",E1 0.00000,"), "{}", lines[at + 3]);
}

#[test]
fn a_stop_before_or_during_the_search_for_ways_leaves_no_program_and_no_comparison() {
    let bench = Bench::with("kuka", SPINDLE, |_| Vec::new());
    let main = bench.written(&bench.export(&bench.options()).unwrap(), "p");
    let before = || {
        let monitor = Monitor::silent();
        monitor.stop_handle().stop();
        monitor
    };
    // Stopped by its own first report, which says how far it is.
    let during = || {
        let handle = StopHandle::default();
        let stop = handle.clone();
        let watch = move |progress: &Progress| {
            assert_eq!(*progress, Progress::Steps { stage: "free ways", done: 1, total: 3 });
            stop.stop();
        };
        Monitor::new(watch).with_stop(handle)
    };
    let stopped = ExportError::Stopped(Stop::Asked);
    for monitor in [before(), during()] {
        assert_eq!(export(&bench.run, &bench.plan, &bench.options(), &monitor).unwrap_err(), stopped);
    }
    for monitor in [before(), during()] {
        let options = ReadBackOptions::default();
        assert_eq!(check(&bench.run, &bench.plan, &main, &options, &monitor).unwrap_err(), stopped);
    }
}
