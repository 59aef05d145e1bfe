"""The command `stead` that comes with the package is the one that cargo builds."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

INSTALLED = Path(sys.executable).parent / "stead"


def run(command: list[str], *arguments: str | Path) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([*command, *map(str, arguments)], capture_output=True, check=False)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--version"],
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


def test_a_script_for_slurm_names_the_installed_command() -> None:
    script = run([str(INSTALLED)], "study", "slurm", "configs/study-k1.toml", "--shards", "2")
    assert script.returncode == 0, script.stderr
    assert str(INSTALLED) in script.stdout.decode()


def test_ctrl_c_ends_it_with_what_it_has(tmp_path: Path) -> None:
    call = [str(INSTALLED), "place", "configs/caro-2013.toml", "--out", str(tmp_path / "out")]
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        # Its progress: then it handles Ctrl-C.
        assert process.stderr is not None and process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    assert process.returncode == 130
