"""A tool that leans, from Python: the run of the command, its leans and the map over them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import stead

LEANING = {
    "search.population": 12,
    "search.generations": 2,
    "search.basins": 1,
    "search.worst": False,
    "redundancy.beta_step_deg": 12.0,
    "lean.lead_step_deg": 5.0,
    "lean.tilt_step_deg": 7.5,
}


@pytest.fixture(scope="module")
def leaned() -> stead.Placements:
    return stead.Run.read(Path(__file__).parents[2] / "configs/leaning-tool.toml", set=LEANING).place()


def test_a_leaning_tool_is_that_of_the_command(command: list[str], leaned: stead.Placements, tmp_path: Path) -> None:
    values = [f"{key}={str(value).lower()}" for key, value in LEANING.items()]
    options = [option for value in values for option in ("--set", value)]
    run = [*command, "place", "configs/leaning-tool.toml", *options, "--out", str(tmp_path)]
    subprocess.run(run, capture_output=True, check=True)
    for name in ("best.csv", "lean-map.csv"):
        assert leaned.files[name] == (tmp_path / name).read_bytes(), name


def test_the_plan_leans_no_farther_than_it_may(leaned: stead.Placements) -> None:
    lead, tilt = (np.radians(leaned.best.plan[name]) for name in ("lead_deg", "tilt_deg"))
    angles = np.degrees(np.arccos(np.cos(lead) * np.cos(tilt)))
    assert 1.0 < angles.max() <= 15.0 + 1e-3


def test_the_map_over_leans_is_about_the_worst_point(leaned: stead.Placements) -> None:
    lean_map, plan = leaned.tables["lean-map"], leaned.best.plan
    assert set(lean_map["point"]) == {float(np.argmax(plan["score_mm"]))}
    allowed = np.isfinite(lean_map["score_mm"])
    assert 0 < allowed.sum() < lean_map.row_count
    assert set(lean_map["reason"][~allowed]) == {"lean"}
    assert np.isfinite(lean_map["beta_deg"]).tolist() == allowed.tolist()
