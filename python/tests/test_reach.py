"""Everything that the command line does can be done from Python, and the whole arm, too."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import stead

CARO = "configs/caro-2013.toml"
BEST = "results/caro-2013/best.csv"
URDF = "crates/format/src/urdf/fixtures/kuka.urdf"
PLACE = {"x_mm": 0, "y_mm": -1640, "z_mm": -214, "yaw_deg": 79}


def calls(out: Path, small_run: Path, small_study: Path) -> list[tuple[str, tuple[str | Path, ...], dict[str, Any]]]:
    """A call of every command, with its files and options."""
    return [
        ("place", (small_run,), {"out": out / "place"}),
        ("page", (out / "place",), {}),
        ("score", (CARO,), {**PLACE, "json": True}),
        ("explain", (CARO,), {**PLACE, "point": 3, "beta_deg": 60, "json": True}),
        ("study run", (small_study,), {"out": out / "study"}),
        ("study status", (small_study,), {"out": out / "study", "json": True}),
        ("study report", (small_study,), {"out": out / "study"}),
        ("study slurm", (small_study,), {"shards": 2}),
        ("assess", ("configs/horizontal-slot.toml",), {"out": out / "assess"}),
        ("identify plan", ("configs/identify-plan-example.toml",), {"out": out / "plan"}),
        ("identify fit", ("configs/identify-example.toml",), {"out": out / "fit"}),
        ("forces", ("configs/forces-pocket.toml",), {"out": out / "pocket.csv"}),
        ("compensate", ("configs/compensate-caro-2013.toml",), {"out": out / "compensate"}),
        ("simulate", ("configs/umons-aluminium.toml",), {"out": out / "simulate"}),
        ("stability", ("configs/umons-steel.toml",), {"out": out / "stability"}),
        ("export", (CARO, BEST), {"format": "csv", "out": out / "PART", "spindle_on": "S ON"}),
        ("export", (CARO, BEST), {"check": out / "PART.csv", "json": True}),
        ("circularity", ("tasks/measured-groove.csv",), {"json": True}),
        ("check", (CARO,), {"json": True}),
        ("pose", ("name:kuka-kr210-r2700",), {"controller_deg": "0,-90,90,0,0,0", "json": True}),
        ("robots", (), {"json": True}),
        ("import robot", (URDF,), {"out": out / "arm.toml"}),
        ("import path", ("tasks/pocket.cls",), {"out": out / "pocket-path.csv", "step_mm": 10}),
        ("init", ("place", out / "init"), {}),
        ("schema", ("run",), {}),
        ("completions", ("bash",), {}),
        ("man", (out / "man",), {}),
    ]


def test_every_command_is_reached(tmp_path: Path, small_run: Path, small_study: Path) -> None:
    all_calls = calls(tmp_path, small_run, small_study)
    for name, arguments, options in all_calls:
        done = stead.command(name, *arguments, **options)
        if options.get("json"):
            assert done.document(), name
        if "out" in options and name != "export":
            assert Path(options["out"]).exists(), name
    # Of each command and each of its own: those that the help has.
    for group in ["", "study", "identify", "import"]:
        listed = re.findall(r"(?m)^  ([a-z]+)  +\S", stead.command(group or "help", help=bool(group)).output)
        known = {name.split()[1 if group else 0] for name, _, _ in all_calls if name.startswith(group)}
        assert set(listed) - {"help"} == known, group


def test_a_command_that_refuses_says_why() -> None:
    for name, arguments, words in [
        ("check", ("configs/no-such-file.toml",), "no-such-file"),
        ("page", ("configs",), "manifest.json"),
        ("import robot", (CARO,), "--out"),
        ("pose", ("name:kuka-kr500",), "--joints-deg"),
        ("no-command", (), "no-command"),
    ]:
        with pytest.raises(stead.CommandError) as caught:
            stead.command(name, *arguments)
        assert caught.value.is_bad_input and words in "\n".join(caught.value.messages), name
        assert not str(caught.value).startswith(("error", "For more")), name


def test_the_whole_arm_says_what_yields() -> None:
    small = {"search.population": 12, "search.generations": 2, "search.basins": 1}
    out = stead.Run.read("configs/whole-arm.toml", set=small).place()
    case = out.cases[0]
    origins = case.by_origin_mm
    assert origins is not None
    parts = [origins.axes_mm, origins.normal_mm, origins.base_mm, origins.mount_mm, origins.tip_mm, origins.part_mm]
    assert sum(parts) == pytest.approx(case.mean_mm, abs=1e-5)
    assert origins.normal_mm == pytest.approx(sum(origins.normal_by_joint_mm), abs=1e-5)
    columns = [f"from_{name}_mm" for name in ("axes", "normal", "base", "mount", "tip", "part")]
    assert sum(out.best.plan[column] for column in columns) == pytest.approx(out.best.plan["score_mm"], abs=1e-5)
    assert case.objective_by_stiffness is not None and len(case.objective_by_stiffness) > 6
