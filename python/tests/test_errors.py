"""Every way to go wrong is an exception that says what, where, and what is allowed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import stead

CARO = "configs/caro-2013.toml"


def test_bad_input_says_file_line_field_value_and_what_is_allowed(small_run: Path) -> None:
    text = small_run.read_text()
    lines = text.splitlines()
    line = next(number for number, line in enumerate(lines, 1) if line.startswith("x_mm"))
    lines[line - 1] = "x_mm = [900.0, -900.0]"
    wrong = small_run.with_name("wrong.toml")
    wrong.write_text("\n".join(lines))
    with pytest.raises(stead.InputError) as caught:
        stead.Run.read(wrong)
    error = caught.value
    assert (error.file, error.line, error.field) == (str(wrong), line, "cell.x_mm")
    assert error.found and error.allowed and error.problem
    assert str(error).startswith(f"{wrong}:{line}: cell.x_mm: ") and "\n" not in str(error)
    assert isinstance(error, stead.Error)


def test_a_missing_file_has_no_line() -> None:
    with pytest.raises(stead.InputError) as caught:
        stead.Run.read("configs/no-such-file.toml")
    assert caught.value.line is None and "no-such-file" in caught.value.file


def test_an_infeasible_placement_says_which_constraint_fails_where() -> None:
    with pytest.raises(stead.Infeasible) as caught:
        stead.Run.read(CARO).score(stead.Placement(0.0, -4000.0, 0.0, 0.0))
    document = caught.value.to_dict()
    assert document["feasible"] is False and document["findings"]
    assert "nothing is feasible" in str(caught.value)


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    found = stead.Profile.read("tasks/measured-groove.csv").circularity()
    with pytest.raises(stead.OutputError, match="results cannot be written here"):
        found.write(file)
    with stead.Folder(tmp_path / "held") as folder:
        with pytest.raises(stead.OutputError, match="another run of stead"):
            found.write(folder.path)
        assert len(found.write(folder)) == 4
    with pytest.raises(stead.ArgumentError, match="released"):
        found.write(folder)


def test_arguments_out_of_range() -> None:
    run = stead.Run.read(CARO)
    wrong_calls: list[tuple[Callable[[], object], str]] = [
        (lambda: run.place(threads=0), "threads, found 0; allowed: 1 to 1024"),
        (lambda: run.place(threads=2**40), "threads, found 1099511627776; allowed: 1 to 1024"),
        (lambda: run.place(threads=2.5), "threads, found 2.5; allowed: a whole number from 1 to 1024"),  # type: ignore[arg-type]
        (lambda: run.place(threads=True), "threads, found True; allowed: a whole number"),
        (lambda: run.place(time_limit_s=-1.0), "time limit, found -1 s"),
        (lambda: run.place(time_limit_s=float("nan")), "time limit, found NaN s"),
        (lambda: run.score(stead.Placement(0.0, float("nan"), 0.0, 0.0)), "placement"),
        (lambda: run.with_seed(-1), "seed, found -1"),
        (lambda: run.explain(stead.Placement(0.0, -1640.0, -214.0, 79.0), 105, 0.0), "found 105; allowed: 0 to 104"),
        (lambda: run.explain(stead.Placement(0.0, -1640.0, -214.0, 79.0), -1, 0.0), "found -1; allowed: 0 to 104"),
        (lambda: stead.Run.read(CARO, certify=-3.0), "gap, found -3 %; allowed"),
        (lambda: stead.schema("robbot"), "robot"),
        (lambda: stead.init("plaice", "x"), "found plaice; allowed: place"),  # type: ignore[arg-type]
        (lambda: stead.SimulationRun.read("configs/umons-aluminium.toml", spindle_rpm=0.0), "spindle speed, found 0"),
        (lambda: stead.StabilityRun.read("x.toml", variant="rigid"), "found rigid; allowed: springs"),  # type: ignore[arg-type]
        (lambda: stead.Profile.read("tasks/measured-groove.csv").circularity([(0.0, 400.0)]), "found \\(0, 400\\)"),
    ]
    for wrong, match in wrong_calls:
        with pytest.raises(stead.ArgumentError, match=match):
            wrong()


def test_a_starter_set_replaces_nothing(small_run: Path) -> None:
    with pytest.raises(stead.InputError, match="is there already"):
        stead.init("place", small_run.parent)
