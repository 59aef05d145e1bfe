"""Long jobs: progress, threads, the GIL, Ctrl-C."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import stead

CARO = "configs/caro-2013.toml"


def test_progress_is_told_on_the_calling_thread(small_run: Path) -> None:
    told: list[tuple[str, int, int]] = []

    def progress(stage: str, done: int, total: int) -> None:
        assert threading.current_thread() is threading.main_thread()
        told.append((stage, done, total))

    started = time.monotonic()
    stead.Run.read(small_run).place(progress=progress)
    seconds = time.monotonic() - started
    assert told and all(0 <= done <= total for _, done, total in told)
    assert len(told) <= 10.0 * seconds + 1


def test_what_progress_raises_stops_the_job() -> None:
    class Enough(Exception):
        pass

    def progress(stage: str, done: int, total: int) -> None:
        raise Enough

    with pytest.raises(Enough):
        stead.Run.read(CARO).place(progress=progress)


def test_threads_do_not_change_the_result(small_run: Path) -> None:
    run = stead.Run.read(small_run)
    one, two = run.place(threads=1), run.place(threads=2)
    assert one.files == two.files
    assert (one.threads, two.threads) == (1, 2)


def test_other_threads_run_during_a_job() -> None:
    counted, is_over = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not is_over.wait(0.002):
            counted += 1

    counter = threading.Thread(target=count)
    counter.start()
    started = time.monotonic()
    stead.Run.read(CARO).place(threads=1)
    seconds = time.monotonic() - started
    is_over.set()
    counter.join()
    # Free to run for the whole time; a loaded machine may take nine tenths of it.
    assert counted > 50.0 * seconds


def test_two_jobs_run_side_by_side(small_run: Path) -> None:
    run, found = stead.Run.read(small_run), {}

    def place(seed: int) -> None:
        found[seed] = run.with_seed(seed).place(threads=1)

    jobs = [threading.Thread(target=place, args=(seed,)) for seed in (1, 2)]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    assert found[1].files == run.with_seed(1).place().files


def test_a_time_limit_leaves_the_best_found_so_far() -> None:
    try:
        out = stead.Run.read(CARO).place(time_limit_s=0.7)
        assert out.interrupted or out.wall_s < 5.0
    except stead.Infeasible as nothing:
        assert nothing.to_dict()["interrupted"]


INTERRUPTED = """
import stead

def progress(stage, done, total):
    print("under way", flush=True)

try:
    stead.Run.read("{file}", certify=0.01).place(progress=progress)
except KeyboardInterrupt as error:
    assert isinstance(error, stead.Interrupted)
    found = error.result
    print("nothing" if found is None else f"found {{found.best.mean_mm}}")
else:
    print("not interrupted")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_leaves_the_best_found_so_far() -> None:
    script = INTERRUPTED.format(file=CARO)
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "under way\n"
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read()
        assert process.wait(120) == 0, rest
    last = rest.splitlines()[-1]
    assert last.startswith("found ") or last == "nothing", rest


STOCK = """
[stock]
box_mm = [400, 440, 10]
xyz_mm = [0, 200, 0]
[tool]
cutter_diameter_mm = 16
teeth = 4
flute_length_mm = 4
kt_mpa = 800
kr = 0.4
kte_n_per_mm = 20
kre_n_per_mm = 20
[cut]
spindle_rpm = 20000
"""


def test_forces_of_a_stock_are_a_job_of_reading_the_run(tmp_path: Path) -> None:
    text = Path(CARO).read_text()
    for name, file in (("robot", "configs/robots/kuka-kr270-2.toml"), ("task", "tasks/five-segments-path.csv")):
        (tmp_path / Path(file).name).write_bytes(Path(file).read_bytes())
        text = re.sub(rf"(?m)^{name} = .*$", f'{name} = "{Path(file).name}"', text)
    run = tmp_path / "run.toml"
    run.write_text(text + STOCK)
    told: list[tuple[str, int, int]] = []
    read = stead.Run.read(run, progress=lambda *step: told.append(step), threads=1)
    assert [warning.kind for warning in read.warnings] == ["starts-in-stock", "above-flutes"]
    assert told and all(0 <= done <= total for _, done, total in told)
    with pytest.raises(stead.Error, match="deadline"):
        stead.Run.read(run, time_limit_s=0.0)
    score = read.score(stead.Placement(0.0, -1640.0, -214.0, 8.6))
    assert score.warnings[:3] == read.warnings
    held = score.best.at_held_feed
    assert held is not None and held.mean_mm <= score.best.mean_mm * (1.0 + 1e-9)
