"""The command `stead` that comes with the package is the one that cargo builds."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import stead

INSTALLED = Path(sys.executable).parent / "stead"


def run(command: list[str], *arguments: str | Path) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([*command, *map(str, arguments)], capture_output=True, check=False)


@pytest.mark.parametrize(
    "arguments",
    [
        ["place", "--help"],
        ["robots"],
        ["place", "configs/no-such-file.toml"],
        ["place", "--no-such-option"],
        ["score", "configs/caro-2013.toml", "--x-mm=1300", "--y-mm=-200", "--z-mm=750", "--yaw-deg=30", "--json"],
    ],
)
def test_does_and_says_the_same(command: list[str], arguments: list[str]) -> None:
    installed, built = run([str(INSTALLED)], *arguments), run(command, *arguments)
    assert (installed.returncode, installed.stdout) == (built.returncode, built.stdout)
    assert installed.stderr == built.stderr


def test_both_are_of_one_version(command: list[str]) -> None:
    said = [run(of, "--version").stdout.decode().split(" (commit ")[0] for of in ([str(INSTALLED)], command)]
    assert said == [f"stead {stead.__version__}"] * 2


def test_a_script_for_slurm_names_the_installed_command() -> None:
    script = run([str(INSTALLED)], "study", "slurm", "configs/study-k1.toml", "--shards", "2")
    assert script.returncode == 0, script.stderr
    assert str(INSTALLED) in script.stdout.decode()


def test_ctrl_c_ends_it_with_what_it_has(tmp_path: Path) -> None:
    call = [str(INSTALLED), "place", "configs/caro-2013.toml", "--notes", "--out", str(tmp_path / "out")]
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        # Its notes on what was read: then it handles Ctrl-C.
        assert process.stderr is not None and process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    assert process.returncode == 130


def test_any_command_can_be_run_from_python(tmp_path: Path) -> None:
    arm = stead.command("robots", "kuka-kr210-r2700")
    assert "[[joints]]" in arm.output and not arm.messages
    pose = stead.command("pose", "name:kuka-kr210-r2700", controller_deg="0,-90,90,0,0,0", json=True).document()
    assert pose["frames"]
    out = tmp_path / "PART"
    call = ("configs/caro-2013.toml", "results/caro-2013/best.csv")
    exported = stead.command("export", *call, format="csv", out=out, spindle_on="S ON")
    assert (tmp_path / "PART.csv").is_file() and str(tmp_path / "PART.csv") in exported.output
    checked = stead.command("export", *call, check=out.with_suffix(".csv"), json=True).document()
    assert checked["moves"]
    with pytest.raises(stead.CommandError, match="is there already") as caught:
        stead.command("export", *call, format="csv", out=out)
    assert caught.value.exit_code == 2 and caught.value.is_bad_input
    imported = tmp_path / "pocket.csv"
    stead.command("import path", "tasks/pocket.cls", out=imported, step_mm=10)
    assert imported.is_file()


def test_values_take_the_place_of_those_of_the_file() -> None:
    file, values = "configs/caro-2013.toml", {"robot.joints[1].stiffness_mnm_per_rad": 0.8, "cell.z_mm": [-602, -402]}
    place = stead.Placement(0.0, -1640.0, -500.0, 79.0)
    ours = stead.Run.read(file, set=values).score(place)
    other = stead.Run.read(file, set=[f"{key}={value}" for key, value in values.items()]).score(place)
    assert ours == other and ours != stead.Run.read(file).score(place)
    with pytest.raises(stead.InputError, match="cell.z_mm"):
        stead.Run.read(file, set={"cell.z_mm": [-402, -602]})
    with pytest.raises(stead.ArgumentError, match="set: "):
        stead.Run.read(file, set=["no value"])
    with pytest.raises(stead.ArgumentError, match="no value of a file"):
        stead.Run.read(file, set={"cell.z_mm": None})


def test_runs_and_results_can_be_pickled(small_run: Path) -> None:
    run = stead.Run.read(small_run, seed=5).without_worst()
    again = pickle.loads(pickle.dumps(run))
    placed = run.place()
    best = placed.cases[0].placement
    assert again.place().cases[0].placement == best
    kept = pickle.loads(pickle.dumps(placed))
    assert type(kept) is stead.Placements and kept == placed and str(kept) == str(placed)
    assert kept.files == placed.files and kept.notes == placed.notes and kept.best.plan["theta1_deg"].size
    assert pickle.loads(pickle.dumps(kept)) == placed
    with pytest.raises(stead.ArgumentError, match="pickled"):
        kept.write(small_run.parent / "kept")
    pickled = pickle.dumps(run)
    task = small_run.with_name("task.csv")
    task.write_text(task.read_text() + "\n")
    with pytest.raises(stead.InputError, match="changed since"):
        pickle.loads(pickled)
