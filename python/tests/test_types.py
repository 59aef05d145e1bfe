"""The package and these tests, checked by mypy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

PYTHON = Path(__file__).resolve().parents[1]


def test_types() -> None:
    mypy = [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", "package/stead", "tests"]
    done = subprocess.run(mypy, cwd=PYTHON, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stubs_are_those_of_the_compiled_half() -> None:
    stubtest = [sys.executable, "-m", "mypy.stubtest", "stead._stead", "--ignore-disjoint-bases"]
    done = subprocess.run(stubtest, cwd=PYTHON / "tests", capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
