#!/usr/bin/env python3
"""Writes the geometric half of cases as tasks of CoBRA: `cobra.py FOLDER CASE.json ..`.

Goals are poses of the tool, free to turn about its axis, in the order of the path. The base may stand where the cell
lets it be seen from the part: at its distances and heights, for a box of the part is no box of the base. Forces,
compliances, conditioning, the rate of the free angle and the value have no words there.
"""

import json
import math
import sys
from pathlib import Path

from verify import about_z, cross, unit


def cobra(case):
    """The task of CoBRA: metres, the frame of the task as the world."""
    (x0, x1), (y0, y1), (z0, z1) = [[v / 1e3 for v in side] for side in case["cell"]["xyz_mm"]]
    near = math.hypot(max(x0, -x1, 0.0), max(y0, -y1, 0.0))
    far = math.hypot(max(-x0, x1), max(-y0, y1))
    free = [-math.pi, math.pi]

    def pose(at, turn, projections, tolerances):
        return {"nominal": [[*row, v] for row, v in zip(turn, at)] + [[0.0, 0.0, 0.0, 1.0]],
                "toleranceProjection": projections, "tolerance": tolerances}

    goals, columns = [], case["task"]["columns"]
    for index, values in enumerate(case["task"]["points"]):
        value = dict(zip(columns, values))
        z = unit([-value[f"axis_{k}"] for k in "xyz"])
        x = unit(cross([value[f"feed_{k}"] for k in "xyz"], z))
        turn = [list(row) for row in zip(x, cross(z, x), z)]
        goals.append({"ID": f"{index + 1}", "type": "at", "goalPose": pose(
            [value[k] / 1e3 for k in "xyz"], turn, ["x", "y", "z", "N_x", "N_y", "N_z"],
            [[-1e-5, 1e-5]] * 3 + [[-1e-5, 1e-5]] * 2 + [free])})
    height = (z1 - z0) / 2 + 1e-9
    base = pose([0.0, 0.0, -(z0 + z1) / 2], about_z(0.0), ["r_cyl", "phi_cyl", "z", "N_x", "N_y", "N_z"],
                [[near, far], free, [-height, height], [-1e-6, 1e-6], [-1e-6, 1e-6], free])
    header = {"ID": f"placement/{case['name']}", "version": "2022", "taskName": case["name"], "tags": ["machining"],
              "date": "2026-12-01", "timeStepSize": 0.01, "gravity": [0.0, 0.0, -9.81], "author": [""], "email": [""],
              "affiliation": [""]}
    order = {"type": "allGoalsFulfilledInOrder", "order": [goal["ID"] for goal in goals]}
    return {"header": header, "obstacles": [], "goals": goals, "constraints": [
        {"type": "joint", "parts": ["q"]}, order, {"type": "basePlacement", "pose": base}]}


def main(folder, *files):
    for file in map(Path, files):
        (Path(folder) / file.name).write_text(json.dumps(cobra(json.loads(file.read_text())), indent=1) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("usage: cobra.py FOLDER CASE.json ..")
    main(*sys.argv[1:])
