"""Gaps of certificates over cells of twelve arms: `python3 experiments/certified_cells.py [STEAD [NAME ..]]` (a quarter
of an hour on two cores; NAME .. are parts of the names of cells). STEAD is the command, by default
`target/release/stead`.

On a machine that does other work the processor seconds tell more than the clock: 120 are a minute on two cores.

Every cell is placed with the criterion that `stead init` writes (the whole deflection, force errors of 10 % covered,
the turn of the spindle limited) where its name does not say otherwise, and certified to 1 % within 60 s on the clock.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SLANTED = [[0.0, -0.70710678, 0.70710678], [1.0, 0.0, 0.0], [0.0, 0.70710678, 0.70710678]]
ALONG = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
ACROSS = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
TURNED_60 = [[0.5, 0.0, 0.8660254037844386], [0.0, 1.0, 0.0], [-0.8660254037844386, 0.0, 0.5]]
TURNED_30 = [[0.8660254037844387, 0.0, 0.5], [0.0, 1.0, 0.0], [-0.5, 0.0, 0.8660254037844387]]
TOTAL = 'direction = "total"\nforce_uncertainty = 0.1'
WALL = 'direction = "wall"\nforce_uncertainty = 0.0'
PUBLISHED = ([-300, 300], [-2240, -1640], [-602, -214])

# Name, robot, task, rotation and place of the tool (mm), cell (mm), least inverse condition, criterion, changes of the
# robot file.
CELLS = [
    ("KR 270, spindle at 45 deg", "kuka-kr270-2", "five-segments", SLANTED, [0, 0, 684], PUBLISHED, 0.2, TOTAL, []),
    ("KR 270, the same, plain wall", "kuka-kr270-2", "five-segments", SLANTED, [0, 0, 684], PUBLISHED, 0.2, WALL, []),
    ("KR 270, the same, conditioning 0.1", "kuka-kr270-2", "five-segments", SLANTED, [0, 0, 684], PUBLISHED, 0.1, TOTAL,
     []),
    ("KR 270, spindle along the flange", "kuka-kr270-2", "five-segments", ALONG, [0, 0, 684], PUBLISHED, 0.2, TOTAL,
     []),
    ("KR 270, lateral offset of 150 mm, across", "kuka-kr270-2", "raster", ACROSS, [0, 200, 350],
     ([-300, 300], [-2000, -1500], [-600, -200]), 0.1, TOTAL, [2]),
    ("KR 270, forces from the stock", "kuka-kr270-2", "slots", SLANTED, [0, 0, 684],
     ([-200, 200], [-2240, -1640], [-602, -214]), 0.2, TOTAL, []),
    ("KR 10, spindle across", "kuka-kr10-r1100", "raster", ACROSS, [0, 80, 60],
     ([400, 800], [-300, 300], [100, 400]), 0.1, TOTAL, []),
    ("TX200, spindle at 60 deg, beside", "staubli-tx200", "raster", TURNED_60, [201, 0, 317],
     ([700, 1300], [-500, 500], [100, 600]), 0.1, TOTAL, []),
    ("TX200, the same, conditioning 0.2", "staubli-tx200", "raster", TURNED_60, [201, 0, 317],
     ([700, 1300], [-500, 500], [100, 600]), 0.2, TOTAL, []),
    ("KR 100, along the flange, path with plunges", "kuka-kr100-ha", "plunging", ALONG, [0, 0, 300],
     ([1200, 1700], [-300, 300], [300, 700]), 0.2, TOTAL, []),
    ("KR 240, spindle across, path with plunges", "kuka-kr240-2", "plunging", ACROSS, [0, 200, 200],
     ([1100, 1700], [-400, 400], [300, 700]), 0.2, TOTAL, []),
    ("KR 210, beside the flange", "kuka-kr210-r2700", "raster", SLANTED, [250, 0, 350],
     ([1000, 1600], [-400, 400], [300, 700]), 0.1, TOTAL, []),
    ("KR 500, joint 2 yields by its angle", "kuka-kr500", "raster", SLANTED, [0, 0, 400],
     ([1100, 1700], [-400, 400], [300, 700]), 0.1, TOTAL, []),
    ("KR 360, spindle across", "kuka-kr360-l240", "raster", ACROSS, [0, 250, 150],
     ([1200, 1800], [-400, 400], [400, 800]), 0.2, TOTAL, []),
    ("KR 210-2, whole arm", "kuka-kr210-2-full", "five-segments", SLANTED, [0, 0, 454],
     ([-300, 300], [-2240, -1640], [148, 536]), 0.2, TOTAL, []),
    # Tried once, when all was done: nothing was changed for them.
    ("KR 120 R3900, spindle at 30 deg, path with plunges", "kuka-kr120-r3900", "plunging", TURNED_30, [60, 0, 300],
     ([1500, 2100], [-400, 400], [400, 800]), 0.15, TOTAL, []),
    ("KR 210-2, spindle across", "kuka-kr210-2", "raster", ACROSS, [0, 150, 200],
     ([1100, 1600], [-350, 350], [400, 800]), 0.15, TOTAL, []),
    ("TX200 of Huynh, spindle along", "staubli-tx200-huynh", "raster", ALONG, [0, 0, 250],
     ([800, 1300], [-400, 400], [300, 700]), 0.2, TOTAL, []),
    ("KR 270 R2700, beside, forces from the stock", "kuka-kr270-r2700", "slots", SLANTED, [150, 0, 300],
     ([1300, 1800], [-300, 300], [400, 800]), 0.2, TOTAL, []),
    ("KR 270, 500 points", "kuka-kr270-2", "many", SLANTED, [0, 0, 684],
     ([-200, 200], [-2240, -1640], [-500, -300]), 0.2, TOTAL, []),
    ("KR 270, 3+2: tool leans 20 deg", "kuka-kr270-2", "leaning", SLANTED, [0, 0, 684], PUBLISHED, 0.2, TOTAL, []),
    ("KR 270, 3+2, smaller", "kuka-kr270-2", "leaning", SLANTED, [0, 0, 684],
     ([-150, 150], [-1940, -1640], [-402, -214]), 0.2, TOTAL, []),
    ("KR 210, turntable with a place for each segment", "kuka-kr210-r2700", "raster", SLANTED, [250, 0, 350],
     ([1000, 1600], [-200, 200], [300, 700]), 0.2, TOTAL, []),
    ("KR 210, rail with a place for each segment", "kuka-kr210-r2700", "raster", SLANTED, [250, 0, 350],
     ([1000, 1600], [-200, 200], [300, 700]), 0.2, TOTAL, []),
    ("KR 210, rail at one place", "kuka-kr210-r2700", "raster", SLANTED, [250, 0, 350],
     ([1000, 1600], [-200, 200], [300, 700]), 0.2, TOTAL, []),
]


def robot(name, folder, changes):
    """The robot file, with the second row shifted sideways where asked for."""
    source = ROOT / "configs/robots" / f"{name}.toml"
    if not changes:
        return source
    rows = source.read_text().split("[[joints]]")
    for row in changes:
        lines = [line for line in rows[row].splitlines() if not line.startswith("d_mm")]
        rows[row] = "\n".join([lines[0], "d_mm = 150.0", *lines[1:]]) + "\n"
    target = folder / f"{name}-offset.toml"
    target.write_text("[[joints]]".join(rows))
    return target


def task(name, folder):
    """The task file: a shipped one, or one made of it."""
    if (ROOT / f"tasks/{name}.csv").exists():
        return ROOT / f"tasks/{name}.csv"
    target = folder / f"{name}.csv"
    head = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n"
    rows = []
    if name == "slots":
        head = head.partition(",force")[0]
        for line in range(3):
            side = 1 if line % 2 == 0 else -1
            rows += [f"{line + 1},{side * (-90 + 15 * k)},{-40 + 40 * line},0,{side},0,0,0,0,1" for k in range(13)]
    elif name == "plunging":
        head = head.replace(",force", ",scored,force", 1)
        for line in range(6):
            side, y = (1 if line % 2 == 0 else -1), -50 + 20 * line
            rows += [f"{line + 1},{side * -90},{y},{z},{side},0,0,0,0,1,0,0,0,0" for z in (30, 15)]
            rows += [f"{line + 1},{side * (-90 + 20 * k)},{y},0,{side},0,0,0,0,1,1,{-120 * side},{-80 * side},-40"
                     for k in range(10)]
    elif name == "many":
        for line in range(10):
            side = 1 if line % 2 == 0 else -1
            for k in range(50):
                x, y = side * (-245 + 10 * k), -90 + 20 * line
                rows.append(f"{line + 1},{x},{y},0,{side},0,0,0,0,1,{-120 * side},{-80 * side},-40")
    else:
        for row in (ROOT / "tasks/raster.csv").read_text().splitlines()[1:]:
            cells = row.split(",")
            cells[7:10] = ["0", "-0.342020143325669", "0.939692620785908"]
            rows.append(",".join(cells))
    target.write_text("\n".join([head, *rows]) + "\n")
    return target


STOCK = """[stock]
box_mm = [260.0, 140.0, 10.0]
xyz_mm = [0.0, 0.0, 0.0]
[tool]
cutter_diameter_mm = 20.0
flute_length_mm = 40.0
teeth = 2
helix_deg = 30.0
kt_mpa = 900.0
kr = 0.3
kte_n_per_mm = 12.0
kre_n_per_mm = 15.0
[cut]
spindle_rpm = 9000.0
"""


AXIS = """[[external_axis]]
name = "axis"
kind = "{}"
carries = "{}"
{}
use = "{}"
"""


def axis(name):
    """The external axis that the name of a cell states."""
    if "rail" in name:
        rail = "direction = [0.0, 1.0, 0.0]\nrange_mm = [-200.0, 200.0]\nspeed_mm_per_s = 500.0"
        return AXIS.format("rail", "robot", rail, "indexed" if "segment" in name else "fixed")
    table = "axis = [0.0, 0.0, 1.0]\nxyz_mm = [1300.0, 0.0, 0.0]\nrange_deg = [-180.0, 180.0]\nspeed_deg_per_s = 60.0"
    return AXIS.format("turntable", "workpiece", table, "indexed") if "turntable" in name else ""


def run_file(cell, folder):
    name, arm, path, rotation, place, (x, y, z), condition, criterion, changes = cell
    target = folder / "run.toml"
    target.write_text(f"""robot = "{robot(arm, folder, changes)}"
task = "{task(path, folder)}"
[spindle]
xyz_mm = {[float(v) for v in place]}
rotation = {rotation}
[cell]
x_mm = {x}
y_mm = {y}
z_mm = {z}
[constraints]
min_inverse_condition = {condition}
characteristic_length_mm = 682.0
[criterion]
{criterion}
[redundancy]
beta_step_deg = 3.0
feed_mm_per_s = 50.0
max_spindle_turn_deg_per_mm = 0.9
[search]
seed = 1
[certificate]
gap_percent = 1.0
time_limit_s = 60.0
[output]
maps = false
{STOCK if path == "slots" else ""}{axis(name)}""")
    return target


def processor_seconds():
    """What the commands so far took, placing included."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    stead = sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/stead"
    wanted = sys.argv[2:]
    print("| cell | m3 | gap | ended | s | processor s | what keeps it open |", flush=True)
    print("|---|---|---|---|---|---|---|", flush=True)
    for cell in CELLS:
        if wanted and not any(part in cell[0] for part in wanted):
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            file = run_file(cell, folder)
            size = 1.0
            for low, high in cell[5]:
                size *= (high - low) / 1e3
            begun, used = time.time(), processor_seconds()
            out = folder / "out"
            command = [str(stead), "place", str(file), "--out", str(out), "--no-worst"]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                print(f"| {cell[0]} | {size:.2f} | {done.stderr.strip()[-200:]} |", flush=True)
                continue
            found = json.loads((out / "certificate.json").read_text())
            best = found.get("best")
            if best is None:
                print(f"| {cell[0]} | {size:.2f} | none | {found.get('best_reason')} | | | |", flush=True)
                continue
            gap = "none" if best["bound_mm"] <= 0 else f"{best['gap_percent']:.2f} %"
            kept = (found.get("best_reason") or "").partition("; of the states")[2]
            kept = f"of the states{kept}" if kept else ""
            seconds = time.time() - begun
            used = processor_seconds() - used
            print(f"| {cell[0]} | {size:.2f} | {gap} | {best['status']} | {seconds:.0f} | {used:.0f} | {kept} |",
                  flush=True)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    print(f"\nMemory at most {peak:.1f} GB.")


if __name__ == "__main__":
    main()
