"""Placements of long paths made at random: `python3 experiments/long_paths.py FIRST LAST STEAD [OTHER]` from the root of the
repository. STEAD and OTHER are commands, FIRST and LAST numbers of problems: 1 to 20 have 1000 to 5000 points.

Arm, mount of the spindle, path, forces and cell are drawn; no example or paper has them. Printed are the processor and the
wall time of each command (s) and the best and the worst mean deflection (um), and where there are two commands what those of the
first are to those of the second: the ratio of times, how much (relative) its best is larger, and its worst smaller. The
runs alternate. STEAD_SEED=n: another seed of the search than the drawn one.
"""

import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from leaning_problems import ARMS, MOUNTS, ROOT, write_task

KINDS = ["raster", "contour", "freeform", "spiral"]
UP = [0.0, 0.0, 1.0]


def unit(v):
    size = math.sqrt(sum(x * x for x in v))
    return [x / size for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def followed(places, axes):
    """Points of one segment with unit feeds, normal to the axes."""
    points = []
    for k, (place, axis) in enumerate(zip(places, axes)):
        before, after = places[max(k - 1, 0)], places[min(k + 1, len(places) - 1)]
        along = [b - a for a, b in zip(before, after)]
        part = sum(x * y for x, y in zip(along, axis))
        points.append((place, unit([x - part * y for x, y in zip(along, axis)]), axis))
    return points


def path(kind, draw, count):
    """Segments of points with feeds and tool axes. mm"""
    if kind == "raster":
        lines, length, step = draw.randint(8, 24), draw.uniform(200, 600), draw.uniform(8, 30)
        each = count // lines
        segments = []
        for line in range(lines):
            side = 1.0 if line % 2 == 0 else -1.0
            places = [[side * (k / (each - 1) - 0.5) * length, (line - lines / 2) * step, 0.0] for k in range(each)]
            segments.append(followed(places, [UP] * each))
        return segments
    if kind == "contour":
        # A closed contour, the tool upright, or level with its axis pointing away from the part.
        is_upright = draw.random() < 0.5
        a, b, wave, waves = draw.uniform(120, 350), draw.uniform(100, 250), draw.uniform(0.03, 0.12), draw.randint(2, 5)
        places, axes = [], []
        for k in range(count):
            t = 2 * math.pi * k / (count - 1)
            r = 1.0 + wave * math.sin(waves * t)
            places.append([a * r * math.cos(t), b * r * math.sin(t), 0.0])
            axes.append(UP if is_upright else unit([math.cos(t) / a, math.sin(t) / b, 0.0]))
        return [followed(places, axes)]
    if kind == "freeform":
        lines, length, step = draw.randint(10, 30), draw.uniform(200, 500), draw.uniform(8, 20)
        height, bend = draw.uniform(20, 60), draw.uniform(0.5, 1.2)
        each = count // lines
        segments = []
        for line in range(lines):
            side = 1.0 if line % 2 == 0 else -1.0
            places, axes = [], []
            for k in range(each):
                x, y = side * (k / (each - 1) - 0.5), line / lines - 0.5
                dx = -height * bend * math.pi * math.sin(math.pi * bend * x) * math.cos(2 * y) / length
                dy = -2 * height * math.cos(math.pi * bend * x) * math.sin(2 * y) / (step * lines)
                places.append([x * length, y * step * lines, height * math.cos(math.pi * bend * x) * math.cos(2 * y)])
                axes.append(unit([-dx, -dy, 1.0]))
            segments.append(followed(places, axes))
        return segments
    # A pocket from the inside out, in one segment.
    turns, pitch = draw.randint(4, 12), draw.uniform(8, 25)
    places = []
    for k in range(count):
        t = 2 * math.pi * turns * k / (count - 1)
        r = 15.0 + pitch * t / (2 * math.pi)
        places.append([r * math.cos(t), 0.7 * r * math.sin(t), 0.0])
    return [followed(places, [UP] * count)]


def problem(number, folder):
    """Writes a problem; returns its run file and what it is."""
    draw = random.Random(7000 + number)
    arm, mount, kind = draw.choice(sorted(ARMS)), draw.choice(sorted(MOUNTS)), KINDS[number % 4]
    count = draw.randint(1000, 5000)
    segments = path(kind, draw, count)
    tangential, radial, axial = draw.uniform(60, 400), draw.uniform(-250, 250), draw.uniform(-150, -20)
    task = []
    for index, points in enumerate(segments):
        for k, (place, feed, axis) in enumerate(points):
            side = cross(axis, feed)
            swing = 1.0 + 0.4 * math.sin(9.0 * k / len(points) + index)
            force = [swing * (-tangential * f + radial * s) + axial * a for f, s, a in zip(feed, side, axis)]
            task.append((index + 1, place, feed, axis, force))
    write_task(folder, task)
    rotation, tip = MOUNTS[mount]
    x, z = ARMS[arm]
    x, z = x + draw.uniform(-150, 150), z + draw.uniform(-150, 250)
    wide = [draw.uniform(300, 700), draw.uniform(300, 800), draw.uniform(0, 350)]
    cell = [[round(at - half, 1), round(at + half, 1)] for at, half in zip((x, 0.0, z), wide)]
    yaw = draw.choice(["", "yaw_deg = [-60.0, 100.0]\n"])
    text = f"""robot = "{ROOT}/configs/robots/{arm}.toml"
task = "task.csv"
[spindle]
xyz_mm = {tip}
rotation = {rotation}
[cell]
x_mm = {cell[0]}
y_mm = {cell[1]}
z_mm = {cell[2]}
{yaw}[constraints]
min_inverse_condition = 0.08
characteristic_length_mm = 700.0
[criterion]
direction = "{draw.choice(["total", "wall", "total"])}"
[redundancy]
beta_step_deg = 6.0
feed_mm_per_s = {draw.choice([30.0, 50.0, 80.0])}
max_beta_rate_deg_per_mm = 0.9
[search]
seed = {os.environ.get("STEAD_SEED", number)}
[output]
maps = false
"""
    return text, f"{number} | {arm}, {mount} | {kind}, {sum(map(len, segments))}"


def placed(stead, folder):
    """Processor and wall seconds, best and worst mean deflection (um)."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    command = [stead, "place", str(folder / "run.toml"), "--no-page", "--out", str(folder / "out")]
    ended = subprocess.run(command, capture_output=True, text=True)
    wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if ended.returncode != 0:
        return seconds, wall, None, None
    cases = json.loads((folder / "out/summary.json").read_text())["cases"]
    means = [case["objective_mm"] * 1e3 for case in cases]
    subprocess.run(["rm", "-r", str(folder / "out")], check=True)
    return seconds, wall, means[0], means[2] if len(means) > 2 else None


def main():
    first, last, *steads = sys.argv[1:]
    print("| no. | arm, spindle | path, points | CPU s, wall s, best um, worst um | ratios, best larger by, worst smaller by |")
    print("|---|---|---|---|---|")
    for number in range(int(first), int(last) + 1):
        with tempfile.TemporaryDirectory() as name:
            text, words = problem(number, Path(name))
            (Path(name) / "run.toml").write_text(text)
            done = [placed(stead, Path(name)) for stead in steads]
        said = ["no placement" if best is None else f"{cpu:.1f}, {wall:.1f}, {best:.5f}, {worst or 0:.4f}"
                for cpu, wall, best, worst in done]
        line = f"| {words} | {' ; '.join(said)} |"
        if len(done) == 2 and None not in (done[0][2], done[1][2]):
            (cpu, wall, best, worst), (old_cpu, old_wall, old_best, old_worst) = done
            line += f" {cpu / old_cpu:.3f}, {wall / old_wall:.3f}, {best / old_best - 1:+.2e}, {1 - worst / old_worst:+.2e} |"
        print(line, flush=True)


if __name__ == "__main__":
    main()
