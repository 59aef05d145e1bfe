"""Results are those of the commands, byte for byte."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import stead

AT = stead.Placement(0.0, -1640.0, -214.0, 79.0)
AT_OPTIONS = ["--x-mm", "0", "--y-mm", "-1640", "--z-mm", "-214", "--yaw-deg", "79"]


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def run_command(command: list[str], *arguments: str | Path) -> str:
    done = subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, check=True)
    return done.stdout


def check_same(result: stead.Result, command: list[str], folder: Path, *arguments: str | Path) -> None:
    """The result leaves the files that the command leaves, and tells them without writing them."""
    run_command(command, *arguments, "--out", folder / "command")
    written = result.write(folder / "python")
    ours, theirs = contents(folder / "python"), contents(folder / "command")
    assert ours.keys() == theirs.keys()
    for name in ours:
        # How long a simulation took is nothing that two runs have in common.
        assert ours[name] == theirs[name], name
    assert [path.name for path in written] == list(result.files)
    assert result.files == {name: data for name, data in ours.items() if name != "manifest.json"}


def test_place_writes_the_bytes_of_the_command(command: list[str], small_run: Path, tmp_path: Path) -> None:
    out = stead.Run.read(small_run, seed=7).place(threads=1)
    check_same(out, command, tmp_path, "place", small_run, "--seed", "7")


def test_score_writes_the_bytes_of_the_command(command: list[str], tmp_path: Path) -> None:
    file = "configs/caro-2013.toml"
    score = stead.Run.read(file).score(AT, deflection_map=True)
    check_same(score, command, tmp_path, "score", file, *AT_OPTIONS)


def test_documents_and_texts_are_those_of_the_command(command: list[str]) -> None:
    file = "configs/caro-2013.toml"
    run = stead.Run.read(file)
    assert run.score(AT).to_json() == run_command(command, "score", file, *AT_OPTIONS, "--json")
    explained = run.explain(AT, 30, 40.0)
    at = [*AT_OPTIONS, "--point", "30", "--beta-deg", "40"]
    assert explained.to_json() == run_command(command, "explain", file, *at, "--json")
    assert str(explained) == run_command(command, "explain", file, *at)
    assert explained.postures[0].violations and explained.files == {}


def test_the_other_commands(command: list[str], tmp_path: Path) -> None:
    points = "tasks/measured-groove.csv"
    found = stead.Profile.read(points).circularity([(350.0, 10.0)])
    check_same(found, command, tmp_path / "1", "circularity", points, "--exclude-deg", "350:10")
    assert found.mzc.circularity_mm <= found.lsc.circularity_mm

    file = "configs/compensate-caro-2013.toml"
    path = stead.CompensationRun.read(file).compensate()
    check_same(path, command, tmp_path / "2", "compensate", file)
    assert path.corrected == path.points == len(path.tables["corrected-path"]["status"])

    file = "configs/identify-example.toml"
    robot = stead.FitRun.read(file).fit()
    check_same(robot, command, tmp_path / "3", "identify", "fit", file)
    assert b"compliance" in robot.files["robot-identified.toml"]

    file = "configs/umons-aluminium.toml"
    simulated = stead.SimulationRun.read(file, spindle_rpm=18000.0).simulate()
    check_same(simulated, command, tmp_path / "4", "simulate", file, "--spindle-rpm", "18000")
    assert simulated.force_x.max_n > 0.0

    file = "configs/umons-aluminium.toml"
    analysis = stead.StabilityRun.read(file, variant="springs").analyse()
    check_same(analysis, command, tmp_path / "5", "stability", file, "--variant", "springs")


def test_assessment_and_measurement_plan(command: list[str], tmp_path: Path) -> None:
    file = "configs/horizontal-slot.toml"
    assessment = stead.AssessmentRun.read(file, accuracy_mm=0.1, force_n=100.0).assess()
    check_same(assessment, command, tmp_path / "1", "assess", file, "--accuracy-mm", "0.1", "--force-n", "100")

    file = "configs/identify-plan-example.toml"
    plan = stead.DesignRun.read(file).plan()
    check_same(plan, command, tmp_path / "2", "identify", "plan", file)
    assert len(plan.configurations) == 20


@pytest.fixture(scope="module")
def out(small_run: Path) -> stead.Placements:
    return stead.Run.read(small_run).place()


def test_cases_and_their_plans(out: stead.Placements, tmp_path: Path) -> None:
    assert [case.case for case in out.cases] == [1, 2, 3, 4]
    assert out.best.mean_mm == out.to_dict()["cases"][0]["mean_mm"] < out.worst.mean_mm
    assert out.best.deflection_mm.total.max >= out.best.deflection_mm.total.mean
    out.write(tmp_path)
    pd.testing.assert_frame_equal(out.best.to_pandas(), pd.read_csv(tmp_path / "best.csv"))
    plan = out.best.plan
    assert plan["theta1_deg"].dtype == np.float64 and plan["posture"].dtype == np.int64
    assert len(plan["score_mm"]) == plan.row_count == len(out.best.to_dict()["plan"])
    assert np.isclose(plan["score_mm"].max(), out.best.max_mm, atol=1e-6)


def test_every_table_is_what_pandas_reads(out: stead.Placements, tmp_path: Path) -> None:
    out.write(tmp_path)
    for name, table in out.tables.items():
        pd.testing.assert_frame_equal(table.to_pandas(), pd.read_csv(tmp_path / f"{name}.csv"), check_dtype=False)


def test_pictures_are_svg(out: stead.Placements, tmp_path: Path) -> None:
    cell = out.pictures["cell"]
    assert cell._repr_svg_().startswith("<svg") or "<svg" in cell.svg
    cell.save(tmp_path / "cell.svg")
    assert (tmp_path / "cell.svg").read_bytes() == out.files["cell.svg"]


def test_a_placement_found_can_be_scored_again(out: stead.Placements, small_run: Path, tmp_path: Path) -> None:
    run = stead.Run.read(small_run)
    out.write(tmp_path)
    again = run.score(tmp_path)
    assert again.best.mean_mm == out.best.mean_mm
    assert again.best.to_pandas().equals(out.best.to_pandas())
    assert run.score(out.best.placement_exact).best.mean_mm == pytest.approx(out.best.mean_mm, abs=2e-7)
    assert str(run.explain(tmp_path, 3, 40.0)) == str(run.explain(run.placement_of(tmp_path), 3, 40.0))
    assert run.placement_of(tmp_path, 3).x_mm == pytest.approx(out.worst.placement_exact.x_mm)
    at = out.best.placement_exact
    assert stead.Placement.from_q4(at.x_mm, at.y_mm, at.z_mm, at.q4).yaw_deg == pytest.approx(at.yaw_deg)


def test_results_know_their_names(out: stead.Placements) -> None:
    assert "mean_mm" in dir(out.best) and "refinements" in dir(out)
    assert out.certificate is None
    with pytest.raises(AttributeError, match="Case has no 'mean_um'; there are: "):
        _ = out.best.mean_um  # type: ignore[attr-defined]
    assert "mean mm" in str(out)
    assert out.notes == out.to_dict()["notes"]
    assert [str(warning) for warning in out.warnings] == out.to_dict()["warnings"]


def declared_keys(record: stead.Record) -> None:
    """Every key of a document is declared for type checkers, as far as its part is typed."""
    known = {name for kind in type(record).__mro__ for name in vars(kind)} | type(record)._declared
    if type(record) is not stead.Record:
        assert record._entries.keys() <= known, type(record)
    for name in record._entries:
        value = getattr(record, name)
        for part in value if isinstance(value, (list, tuple)) else [value]:
            if isinstance(part, stead.Record):
                declared_keys(part)


def test_every_key_is_declared(out: stead.Placements) -> None:
    results: list[stead.Result] = [
        out,
        stead.Run.read("configs/caro-2013.toml").score(AT),
        stead.Run.read("configs/caro-2013.toml").explain(AT, 30, 40.0),
        stead.FitRun.read("configs/identify-example.toml").fit(),
        stead.DesignRun.read("configs/identify-plan-example.toml").plan(),
        stead.CompensationRun.read("configs/compensate-caro-2013.toml").compensate(),
        stead.SimulationRun.read("configs/umons-aluminium.toml").simulate(),
        stead.StabilityRun.read("configs/umons-aluminium.toml").analyse(),
        stead.Profile.read("tasks/measured-groove.csv").circularity(),
        stead.AssessmentRun.read("configs/horizontal-slot.toml").assess(),
    ]
    for result in results:
        declared_keys(result)


def test_a_certificate() -> None:
    run = stead.Run.read("configs/caro-2013.toml", certify=50.0)
    found = run.place(certify=False)
    assert found.certificate is None
    certified = run.certify(found, time_limit_s=3.0)
    assert certified.certificate is not None
    assert certified.certificate.gap_percent_asked == 50.0
    declared_keys(certified)
    assert "certificate.json" in certified.files
    assert json.loads(certified.to_json())["certificate"] == certified.certificate.to_dict()


def test_starter_sets_and_schemas(tmp_path: Path) -> None:
    files = stead.init("simulate", tmp_path / "new")
    assert files[0].name == "simulate.toml" and all(file.is_file() for file in files)
    assert "cell" in stead.schema("run")["properties"]
