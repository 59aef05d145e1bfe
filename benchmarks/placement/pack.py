#!/usr/bin/env python3
"""Makes the cases of the open set with stead, from `cases.toml` and the robot and task files of this repository.

`pack.py STEAD [NAME ..]` places and certifies and writes NAME.json (all: a quarter of an hour on two cores);
`pack.py STEAD --again [NAME ..]` plans the stated placement anew and says where the file would be another, byte for
byte, but for bound and seconds.

stead reads a run that is made of the case alone: what a case file does not contain cannot play a part.
"""

import csv
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from verify import digest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
UNITS = ("mm, deg, N; compliances in urad/(N m), a pair is linear in the joint angle, from min_deg to max_deg;"
         " placement: where the origin of the task stands in the base frame, turned about z by yaw_deg")


def number(text):
    return int(float(text)) if float(text) == int(float(text)) else float(text)


def compliance(joint):
    stated = joint.get("compliance_urad_per_nm")
    return 1.0 / joint["stiffness_mnm_per_rad"] if stated is None else stated


def problem(case):
    """What is to be solved, from the files of this repository."""
    robot = tomllib.loads((ROOT / f"configs/robots/{case['robot']}.toml").read_text())
    with open(ROOT / case["task"], encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    columns = [re.sub("_(mm|n)$", "", name) for name in rows[0]]
    points = [dict(zip(columns, map(number, row.values()))) for row in rows]
    for point in points:
        point.update(zip(("axis_x", "axis_y", "axis_z"), case.get("axis", [point[f"axis_{k}"] for k in "xyz"])))
    joints = [{key: joint[key] for key in ("alpha_deg", "a_mm", "d_mm", "min_deg", "max_deg")}
              | {"compliance_urad_per_nm": compliance(joint)} for joint in robot["joints"]]
    made = {
        "format": "placement case 1", "name": case["name"], "about": case["about"], "units": UNITS, "digest": "",
        "robot": {"name": robot["name"], "convention": "modified Denavit-Hartenberg, base first",
                  "source": robot["source"].strip(), "rows": joints},
        "tool": {"xyz_mm": case["tool_mm"], "rotation": case["rotation"]},
        "cell": {"xyz_mm": case["cell_mm"], "yaw": "free"},
        "constraints": {"min_inverse_condition": case["min_inverse_condition"], "characteristic_length_mm": 682.0},
        "redundancy": case["redundancy"],
        "criterion": {key: case.get(key, "mean") for key in ("direction", "aggregate", "force_uncertainty")},
        "task": {"columns": columns, "points": [list(point.values()) for point in points]}}
    return made | {"digest": digest(made)}


def toml(table, keys):
    return "".join(f"{key} = {json.dumps(table[key])}\n" for key in keys)


def run(case, folder, certificate):
    """The run file of a case, with robot and task beside it."""
    rows = "".join("[[joints]]\n" + toml(row, row) for row in case["robot"]["rows"])
    (folder / "robot.toml").write_text(f'name = "arm"\nsource = "the case"\n{rows}')
    names = [name + ("_mm" if name in "xyz" else "_n" if name.startswith("force") else "")
             for name in case["task"]["columns"]]
    with open(folder / "task.csv", "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([names, *case["task"]["points"]])
    cell = dict(zip(("x_mm", "y_mm", "z_mm"), case["cell"]["xyz_mm"]))
    redundancy = {"beta_step_deg": 3.0, "feed_mm_per_s": 50.0} | case["redundancy"]
    tables = {"spindle": case["tool"], "cell": cell, "redundancy": redundancy, "postures": {"tie_percent": 0.0},
              "output": {"maps": False, "page": False}, "search": {"seed": 1}}
    tables |= {name: case[name] for name in ("constraints", "criterion")} | certificate
    text = "".join(f"[{name}]\n{toml(table, table)}" for name, table in tables.items())
    (folder / "run.toml").write_text(f'robot = "robot.toml"\ntask = "task.csv"\n{text}')
    return folder / "run.toml"


def stead(program, folder, *arguments):
    done = subprocess.run([program, *map(str, arguments), "--out", folder / "out"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"pack.py: stead {arguments[0]}: {done.stderr.strip()[-300:]}")


def solved(program, case, wanted):
    """What stead finds and proves of a case; the plan is that of the placement as it is written."""
    with tempfile.TemporaryDirectory() as name:
        limits = {"certificate": {key: wanted[key] for key in ("gap_percent", "time_limit_s")}}
        file, begun = run(case, Path(name), limits), time.time()
        stead(program, Path(name), "place", file, "--no-worst")
        found = json.loads((Path(name) / "out/certificate.json").read_text())["best"]
        if found is None:
            sys.exit(f"pack.py: {case['name']}: no bound")
        at, seconds = found["placement"], round(time.time() - begun)
        version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    stated = {"placement": {"xyz_mm": [at[k] for k in ("x_mm", "y_mm", "z_mm")], "yaw_deg": at["yaw_deg"]},
              "joints_deg": [], "value_mm": 0.0, "bound_mm": found["bound_mm"], "gap_percent": 0.0,
              "relaxed": found["limits_relaxed"], "by": version, "seconds": seconds}
    return planned(program, case, stated)


def planned(program, case, stated):
    """The stated placement with the plan that stead makes for it, its value, and how far that is above the bound."""
    with tempfile.TemporaryDirectory() as name:
        at = stated["placement"]
        flags = [f"--{k}-mm={v!r}" for k, v in zip("xyz", at["xyz_mm"])] + [f"--yaw-deg={at['yaw_deg']!r}"]
        stead(program, Path(name), "score", run(case, Path(name), {}), *flags)
        value = json.loads((Path(name) / "out/score.json").read_text())["best"]["objective_mm"]
        with open(Path(name) / "out/best-plan.csv", encoding="utf-8", newline="") as plan:
            joints = [[float(row[f"theta{k}_deg"]) for k in range(1, 7)] for row in csv.DictReader(plan)]
        gap = round(100 * (1 - stated["bound_mm"] / value), 4)
        return stated | {"joints_deg": joints, "value_mm": value, "gap_percent": gap}


def written(case):
    """Numbers of a list on one line."""
    text = re.sub(r"\[\s+((?:-?[\d.e+-]+,?\s+)+)\]", lambda m: "[" + " ".join(m[1].split()) + "]",
                  json.dumps(case, indent=1))
    return text + "\n"


def main(arguments):
    cases = {case["name"]: case for case in tomllib.loads((HERE / "cases.toml").read_text())["case"]}
    program, *names = [name for name in arguments if name != "--again"] or [None]
    if not shutil.which(program or "") or not set(names) <= set(cases):
        sys.exit(f"usage: pack.py STEAD [--again] [NAME ..]; names: {', '.join(cases)}")
    failed = 0
    for name in names or cases:
        file, case = HERE / f"{name}.json", problem(cases[name])
        if "--again" in arguments:
            old = file.read_text()
            same = written(case | {"stated": planned(program, case, json.loads(old)["stated"])}) == old
            failed += not same
            print(f"{name}: {'the same bytes' if same else 'ANOTHER FILE'}", flush=True)
        else:
            case["stated"] = solved(program, case, cases[name])
            file.write_text(written(case))
            print(f"{name}: gap {case['stated']['gap_percent']:.3f} %, {case['stated']['seconds']} s", flush=True)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
