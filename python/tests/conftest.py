"""Where the repository, its command and small runs are."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def in_repository(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)


@pytest.fixture(scope="session")
def command() -> list[str]:
    """The command `stead`: of the environment variable STEAD, or built by cargo."""
    if given := os.environ.get("STEAD"):
        return [given]
    if not shutil.which("cargo"):
        pytest.skip("neither STEAD nor cargo: nothing to compare with")
    target = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
    subprocess.run(["cargo", "build", "--locked", "--quiet", "--bin", "stead"], cwd=REPOSITORY, check=True)
    return [str(target / "debug" / "stead")]


@pytest.fixture(scope="session")
def small_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The starter set with a smaller search: a second."""
    import stead

    folder = tmp_path_factory.mktemp("small")
    run = stead.init("place", folder)[0]
    return run


@pytest.fixture(scope="session")
def small_study(small_run: Path) -> Path:
    """A study file without axes, whose cases take a fraction of a second."""
    run = small_run.read_text()
    smaller = {
        "x_mm": "[0.0, 10.0]",
        "y_mm": "[-1645.0, -1640.0]",
        "z_mm": "[-220.0, -214.0]",
        "population": "8",
        "generations": "2",
        "basins": "1",
    }
    for key, value in smaller.items():
        run, changed = re.subn(rf"(?m)^{key} *=.*$", f"{key} = {value}", run)
        assert changed == 1, key
    small_run.with_name("smaller.toml").write_text(run)
    study = small_run.with_name("study.toml")
    study.write_text('base = "smaller.toml"\n')
    return study
