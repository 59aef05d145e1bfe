"""Studies: the bytes of the command, shards, what stops them, and their tables."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import stead

AXES = """
[[axis]]
field = "robot.joints[1].stiffness_mnm_per_rad"
values = [0.2, 0.8, 6.0]
[[axis]]
name = "height"
field = "cell.z_mm"
values = [[-220.0, -214.0], [4000.0, 4001.0]]
labels = ["1", "2"]
"""
TEXTS = {
    "id",
    "task",
    "height",
    "status",
    "reason",
    "nearest_pair",
    "active_bounds",
    "certificate_best_status",
    "certificate_worst_status",
}
COUNTS = {"case", "postures"}
Value = str | float | int | None


@pytest.fixture(scope="module")
def study_file(small_study: Path) -> Path:
    """Six cases, of which three have no placement."""
    file = small_study.with_name("six.toml")
    file.write_text(small_study.read_text() + AXES)
    return file


@pytest.fixture(scope="module")
def done(study_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the study, done in Python in shards."""
    folder = tmp_path_factory.mktemp("done")
    study = stead.Study.read(study_file)
    assert [case.number for case in study.cases] == [1, 2, 3, 4, 5, 6]
    first = study.cases[0]
    assert first.values == {"robot.joints[1].stiffness_mnm_per_rad": 0.2, "height": "1"}
    assert len(first.id) == 64 and first.task.endswith(".csv") and first.weight == 1.0

    assert study.status(folder / "none") == stead.StudyStatus(6, 0, 0, 0, [], [], [])
    told: list[tuple[str, int, int]] = []
    some = study.run(folder, (2, 2), threads=1, progress=lambda *progress: told.append(progress))
    assert (some.planned, some.before, some.now) == (3, 0, 3) and not some.is_complete and not some.interrupted
    assert told[-1] == ("cases", 3, 3)
    assert study.merge(folder) is False and study.results(folder) is None
    with pytest.raises(stead.OutputError, match="only 3 of 6 cases of the study are done"):
        study.report(folder)
    status = study.status(folder)
    assert (status.done, [(shard.shard, shard.done, shard.is_running) for shard in status.shards]) == (
        3,
        [((1, 2), 0, False), ((2, 2), 3, False)],
    )
    rest = study.run(folder, "1/2")
    assert rest.is_complete and rest.problems == []
    assert study.run(folder) == stead.Finished(6, 6, 0, False, True, [])
    return folder


@pytest.fixture(scope="module")
def of_command(study_file: Path, command: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the study, done by the command."""
    folder = tmp_path_factory.mktemp("command")
    subprocess.run([*command, "study", "run", study_file, "--out", folder], capture_output=True, check=True)
    return folder


def check_same(ours: Path, theirs: Path) -> None:
    assert (ours / "study.csv").read_bytes() == (theirs / "study.csv").read_bytes()


def test_the_bytes_are_those_of_the_command(done: Path, of_command: Path) -> None:
    check_same(done, of_command)


def test_the_report_is_that_of_the_command(
    study_file: Path, done: Path, of_command: Path, command: list[str], tmp_path: Path
) -> None:
    study = stead.Study.read(study_file)
    arguments: list[str | Path] = ["study", "report", study_file, "--out", of_command]
    asked = ["--by", "cycle_s:max", "--front", "cycle_s,best_max_total_mm", "--noise-percent", "1.5"]
    asked += ["--map", "height,robot.joints[1].stiffness_mnm_per_rad"]
    printed = subprocess.run([*command, *arguments, *asked, "--json"], capture_output=True, text=True, check=True)
    axes = ("height", "robot.joints[1].stiffness_mnm_per_rad")
    report = study.report(done, "cycle_s:max", ["cycle_s", "best_max_total_mm"], axes, 1.5)
    assert report.to_json() == printed.stdout
    assert report.noise_percent == 1.5 and report.failures.to_dict()["infeasible"] == 3

    printed = subprocess.run([*command, *arguments], capture_output=True, text=True, check=True)
    report = study.report(done)
    assert printed.stdout == f"{report}\nresults in {of_command}\n"
    report.write(tmp_path)
    assert {"study-ranking", "study-effects"} <= report.tables.keys() and "study-effects" in report.pictures
    for name, data in report.files.items():
        assert data == (tmp_path / name).read_bytes() == (of_command / name).read_bytes(), name
    assert json.loads(report.to_json())["study"] == "six" == report.study


def rows_of(folder: Path) -> tuple[list[str], list[list[Value]]]:
    """Names and values of study.csv, as the guide describes them."""

    def value(name: str, text: str) -> Value:
        if text == "":
            return None
        return text if name in TEXTS else int(text) if name in COUNTS else float(text)

    names, *rows = csv.reader((folder / "study.csv").open(newline=""))
    return names, [[value(name, text) for name, text in zip(names, row, strict=True)] for row in rows]


def test_the_table_of_results(study_file: Path, done: Path) -> None:
    table = stead.Study.read(study_file).results(done)
    assert table is not None
    names, rows = rows_of(done)
    assert list(table) == names and table.row_count == 6
    # Labels are words, whatever they look like, and a number that is missing is no word.
    assert list(table["height"]) == ["1", "2"] * 3 and table["case"].dtype == np.int64
    assert table["objective_mm"].dtype == np.float64 and np.isnan(table["objective_mm"][1])
    assert [row[names.index("status")] for row in rows] == ["placed", "infeasible"] * 3
    frame = table.to_pandas()
    for name, column in zip(names, zip(*rows, strict=True), strict=True):
        assert [None if pd.isna(value) else value for value in frame[name]] == list(column), name


def test_what_is_refused(study_file: Path, done: Path, tmp_path: Path) -> None:
    study = stead.Study.read(study_file)
    for shard in ((3, 2), (0, 4), "1/0", "1", "1/10000"):
        with pytest.raises(stead.ArgumentError, match="no such shard, found .*; allowed: I/N with whole numbers"):
            study.run(tmp_path, shard)
    with pytest.raises(stead.ArgumentError, match="noise"):
        study.report(done, noise_percent=-1.0)
    with pytest.raises(stead.ArgumentError, match="objective_mm"):
        study.report(done, by="objectiv_mm")
    wrong = study_file.with_name("wrong.toml")
    wrong.write_text(study_file.read_text().replace("cell.z_mm", "cell.zz_mm"))
    with pytest.raises(stead.InputError) as caught:
        stead.Study.read(wrong)
    assert caught.value.file.endswith(".toml") and "zz_mm" in str(caught.value.field) and caught.value.is_bad_input
    assert "z_mm" in str(caught.value.allowed) and "case 1 of wrong.toml" in str(caught.value), caught.value
    other = study_file.with_name("other.toml")
    other.write_text(study_file.read_text())
    with pytest.raises(stead.OutputError, match="is of another study") as refused:
        stead.Study.read(other).run(done)
    assert refused.value.is_bad_input and not isinstance(refused.value, stead.Locked)


INTERRUPTED = """
import stead

study = stead.Study.read("{file}")
def progress(stage, done, total):
    print("under way", flush=True)

try:
    study.run("{folder}", threads=1, progress=progress)
except stead.Interrupted as stop:
    print(stop.result.interrupted, stop.result.now, study.status("{folder}").done)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_keeps_finished_cases_and_a_shard_has_one_process(study_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "stopped"
    script = INTERRUPTED.format(file=study_file, folder=folder)
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "under way\n"
        with pytest.raises(stead.Locked, match="is being worked on by another process"):
            stead.Study.read(study_file).run(folder)
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read().splitlines()[-1].split()
        assert process.wait(60) == 0
    is_interrupted, now, count = rest[0] == "True", int(rest[1]), int(rest[2])
    assert now == count and is_interrupted == (count < 6)
    stopped = stead.Study.read(study_file).run(folder, time_limit_s=0.0)
    assert stopped.interrupted == (count < 6) and stopped.now == 0 or stopped.is_complete


def module(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    call = [sys.executable, "-m", "stead.study", *map(str, arguments)]
    return subprocess.run(call, capture_output=True, text=True, check=False)


def test_the_module_gives_the_bytes_of_the_command(study_file: Path, of_command: Path, tmp_path: Path) -> None:
    ended = module(study_file, "--shards", "3", "--out", tmp_path, "--threads", "2")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout == f"study: 6 of 6 cases done, 6 of them now; results in {tmp_path / 'study.csv'}\n"
    check_same(tmp_path, of_command)


def test_the_module_refuses_in_one_line(
    study_file: Path, done: Path, command: list[str], tmp_path: Path
) -> None:
    other = study_file.with_name("other.toml")
    other.write_text(study_file.read_text())
    refused: list[tuple[list[str | Path], str]] = [
        ([study_file, "--shards", "0"], "--shards: found 0; allowed: a whole number from 1 to 9999"),
        ([study_file, "--shards", "10000"], "--shards: found 10000; allowed"),
        ([study_file, "--threads", "x"], "--threads: found x; allowed: a whole number from 1 to 1024"),
        ([study_file, "--engine", "slurm"], "--engine: invalid choice"),
        ([study_file, "--address", "127.0.0.1:1"], "--address is for --engine ray"),
        ([tmp_path / "none.toml"], "none.toml"),
        ([other, "--out", done], "is of another study"),
        ([], "FILE"),
    ]
    for arguments, part in refused:
        ended = module(*arguments)
        assert ended.returncode == 2 and ended.stdout == "", arguments
        assert ended.stderr.startswith("error: ") and part in ended.stderr and ended.stderr.count("\n") == 1, ended.stderr
    file = tmp_path / "file"
    file.write_text("")
    at_a_file: list[str | Path] = [study_file, "--out", file / "below"]
    of_command = subprocess.run([*command, "study", "run", *at_a_file], capture_output=True, text=True, check=False)
    ended = module(*at_a_file)
    assert (ended.returncode, ended.stderr) == (of_command.returncode, of_command.stderr) and ended.returncode > 0
    helped = module("--help")
    assert helped.returncode == 0 and "Exit codes:" in helped.stdout and "same paths" in helped.stdout


def test_ray_is_asked_for_where_it_is_missing(study_file: Path, tmp_path: Path) -> None:
    script = "import sys; sys.modules['ray'] = None; from stead.study import main; sys.exit(main(sys.argv[1:]))"
    call = [sys.executable, "-c", script, str(study_file), "--engine", "ray", "--out", str(tmp_path)]
    ended = subprocess.run(call, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr == "error: ray is not installed; allowed: --engine local, or pip install ray\n"


def test_the_usual_number_of_shards() -> None:
    from stead._ray import shard_count

    # At least four for each worker, at most twenty cases for each thread, and never more than cases or than there may be.
    assert shard_count(24, 2, 1) == 8
    assert shard_count(3, 16, 1) == 3
    assert shard_count(10_000, 8, 1) == 500
    assert shard_count(10_000, 8, 4) == 125
    assert shard_count(1_000_000, 8, 1) == 9999
    assert shard_count(0, 1, 1) == 1
