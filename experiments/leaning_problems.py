"""Placements of a leaning tool on problems made at random: `python3 experiments/leaning_problems.py [STEAD [FIRST
[LAST]]]` from the root of the repository. STEAD is the command, by default `target/release/stead`, FIRST and LAST are numbers of
problems, by default 1 to 12.

Arm, mount of the spindle, path, cutter, cone, forces, cell and obstacles are drawn; no example or paper has them. Each
problem is placed with the axis of the task, with a tool that may lean, and once more by an independent search: another
seed, three times as many drawn placements and twice as many starts. Printed are the mean deflections, by how much
the independent search is better, and the processor time of each.
"""

import json
import math
import random
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOUNTS = {
    "45 deg": ([[0.0, -0.70710678, 0.70710678], [1.0, 0.0, 0.0], [0.0, 0.70710678, 0.70710678]], [0.0, 0.0, 420.0]),
    "across": ([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], [320.0, 0.0, 130.0]),
    "60 deg": ([[0.5, 0.0, 0.8660254037844386], [0.0, 1.0, 0.0], [-0.8660254037844386, 0.0, 0.5]], [300.0, 0.0, 300.0]),
}
# With the middle of the cell, x and z. mm
ARMS = {
    "kuka-kr100-ha": (1400, 600),
    "kuka-kr120-r3900": (1900, 700),
    "kuka-kr210-r2700": (1400, 500),
    "kuka-kr240-2": (1500, 600),
    "kuka-kr270-r2700": (1400, 500),
    "kuka-kr360-l240": (1600, 700),
    "staubli-tx200": (1100, 300),
}
PATHS = ["raster", "arc", "wave", "slope"]
# Radius and length of spindle and holder, and how far their middle is above the tip. mm
BODIES = {"spindle": (75.0, 300.0, 260.0), "holder": (28.0, 65.0, 77.5)}
SEARCHES = {
    "closed": "seed = 1",
    "open": "seed = 1",
    "independent": "seed = {seed}\npopulation = 360\ngenerations = 51\nbasins = 8",
}


def path(kind, draw):
    """Points and unit feeds by segment (mm), and the tool axis."""
    axis = [0.0, 0.0, 1.0]
    if kind == "raster":
        length, step, lines = draw.uniform(80, 180), draw.uniform(8, 25), 3
        return [[([side * (k / 14 - 0.5) * length, (line - 1) * step, 0.0], [side, 0.0, 0.0]) for k in range(15)]
                for line in range(lines) for side in [1.0 if line % 2 == 0 else -1.0]], axis
    if kind == "arc":
        radius, first, turn = draw.uniform(50, 120), draw.uniform(0, 2 * math.pi), draw.uniform(2.0, 4.5)
        angles = [first + turn * k / 44 for k in range(45)]
        return [[([radius * math.cos(a), radius * math.sin(a), 0.0], [-math.sin(a), math.cos(a), 0.0])
                 for a in angles]], axis
    if kind == "wave":
        length, height, waves = draw.uniform(150, 280), draw.uniform(10, 30), draw.uniform(0.7, 1.6)
        points = []
        for k in range(45):
            x = k / 44
            slope = height * 2 * math.pi * waves * math.cos(2 * math.pi * waves * x) / length
            size = math.hypot(1.0, slope)
            points.append(([(x - 0.5) * length, height * math.sin(2 * math.pi * waves * x), 0.0],
                           [1 / size, slope / size, 0.0]))
        return [points], axis
    # A line up a slope with the axis turned aside from its normal.
    length, rise, aside = draw.uniform(120, 250), draw.uniform(5, 20), draw.uniform(-15, 15)
    c, s = math.cos(math.radians(rise)), math.sin(math.radians(rise))
    a, b = math.cos(math.radians(aside)), math.sin(math.radians(aside))
    return [[([(k / 39 - 0.5) * length * c, 0.0, (k / 39 - 0.5) * length * s], [c, 0.0, s]) for k in range(40)]], \
        [-s * a, b, c * a]


def write_task(folder, points):
    """A task file of points: number of the segment, position (mm), feed, tool axis, force (N)."""
    rows = ["segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n"]
    for segment, place, feed, axis, force in points:
        rows.append(",".join(str(round(v, 9)) for v in [segment, *place, *feed, *axis, *force]))
    (folder / "task.csv").write_text("\n".join(rows) + "\n")


def problem(number, folder):
    """Writes a problem; returns its run file as a text without `[lean]` and `[search]`, and what it is."""
    draw = random.Random(number)
    arm = draw.choice(sorted(ARMS))
    mount, kind = draw.choice(sorted(MOUNTS)), PATHS[number % 4]
    cutter, cone = ["ball", "bull"][number // 4 % 2], draw.choice([10, 15])
    segments, axis = path(kind, draw)
    force = [draw.uniform(-150, 150), draw.uniform(-150, 150), draw.uniform(-80, -20)]
    write_task(folder, ((index + 1, *point, axis, force) for index, points in enumerate(segments) for point in points))
    radius = draw.choice([5.0, 8.0]) if cutter == "ball" else draw.choice([10.0, 12.5])
    corner = radius if cutter == "ball" else draw.choice([2.0, 4.0])
    rotation, tip = MOUNTS[mount]
    forward = [row[2] for row in rotation]
    x, z = ARMS[arm]
    x, y, z = x + draw.uniform(-100, 100), draw.uniform(-300, 300), z + draw.uniform(-150, 150)
    wide = [draw.uniform(100, 300), draw.uniform(150, 400), draw.uniform(80, 200)]
    cell = [[round(at - half, 1), round(at + half, 1)] for at, half in zip((x, y, z), wide)]
    text = f"""robot = "{ROOT}/configs/robots/{arm}.toml"
task = "task.csv"
[spindle]
xyz_mm = {tip}
rotation = {rotation}
[tool]
cutter_diameter_mm = {2 * radius}
corner_radius_mm = {corner}
[cell]
x_mm = {cell[0]}
y_mm = {cell[1]}
z_mm = {cell[2]}
yaw_deg = [{draw.choice([-180.0, -90.0, -30.0])}, {draw.choice([45.0, 90.0, 180.0])}]
[constraints]
min_inverse_condition = 0.08
characteristic_length_mm = 700.0
[criterion]
direction = "{draw.choice(["total", "wall"])}"
force_uncertainty = 0.1
[redundancy]
beta_step_deg = 6.0
feed_mm_per_s = 30.0
max_beta_rate_deg_per_mm = 0.9
[output]
maps = false
"""
    for name, (body, length, above) in BODIES.items():
        middle = [round(t - above * f, 6) for t, f in zip(tip, forward)]
        text += f"""[[shape]]
name = "{name}"
attached = "flange"
cylinder_mm = {{ radius = {body}, length = {length} }}
xyz_mm = {middle}
rotation = {rotation}
"""
    # Clamps and walls beside the path, as near as the spindle is thick or nearer.
    places = [place for points in segments for place, _ in points]
    for wall in range(draw.choice([2, 3])):
        across, low = wall % 2, [min(p[k] for p in places) for k in range(2)]
        high = [max(p[k] for p in places) for k in range(2)]
        side, gap, thick = draw.choice([-1, 1]), draw.uniform(45, 100), draw.uniform(20, 60)
        height, span = draw.uniform(90, 170), draw.uniform(40, 160)
        at = [draw.uniform(low[k], high[k]) for k in range(2)]
        at[1 - across] = (high[1 - across] + gap + thick / 2) if side > 0 else (low[1 - across] - gap - thick / 2)
        size = [span, thick] if across == 0 else [thick, span]
        text += f"""[[shape]]
name = "wall {wall + 1}"
attached = "workpiece"
box_mm = {[round(v, 1) for v in (*size, height)]}
xyz_mm = {[round(v, 1) for v in (*at, height / 2 - 20)]}
"""
    return text, cone, f"{number} | {arm}, {mount} | {kind} | {cutter} {radius:g}/{corner:g}, {cone} deg"


def placed(stead, folder, name, text, cone):
    """The mean deflection (mm), none where there is no plan, and processor seconds."""
    half = 0.0 if name == "closed" else float(cone)
    lean = f"[lean]\nlead_deg = [{-half}, {half}]\ntilt_deg = [{-half}, {half}]\nmax_lean_deg = {cone}\n"
    search = f"[search]\nworst = false\n{SEARCHES[name]}\n".format(seed=1000)
    run = folder / f"{name}.toml"
    run.write_text(text + lean + search)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [stead, "place", str(run), "--no-page", "--out", str(folder / name)]
    ended = subprocess.run(command, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if ended.returncode != 0:
        if "placement" not in ended.stderr:
            sys.exit(f"{command}: {ended.stderr}")
        return None, seconds
    summary = json.loads((folder / name / "summary.json").read_text())
    return summary["cases"][0]["objective_mm"], seconds


def main():
    arguments = sys.argv[1:]
    stead = arguments[0] if arguments else str(ROOT / "target/release/stead")
    first = int(arguments[1]) if len(arguments) > 1 else 1
    last = int(arguments[2]) if len(arguments) > 2 else 12
    print("| no. | arm, spindle | path | cutter, cone | axis of the task, mm | leaning, mm | gain | "
          "independent search, mm | better by | s | s | s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    figure = "{:.5f}".format
    for number in range(first, last + 1):
        with tempfile.TemporaryDirectory() as folder:
            text, cone, words = problem(number, Path(folder))
            done = [placed(stead, Path(folder), name, text, cone) for name in SEARCHES]
        (closed, _), (lean, _), (other, _) = done
        cells = [figure(mean) if mean else "no plan" for mean, _ in done]
        share = [f"{100 * (1 - b / a):.1f} %" if a and b else "-" for a, b in ((closed, lean), (lean, other))]
        seconds = " | ".join(f"{seconds:.0f}" for _, seconds in done)
        print(f"| {words} | {cells[0]} | {cells[1]} | {share[0]} | {cells[2]} | {share[1]} | {seconds} |", flush=True)


if __name__ == "__main__":
    main()
