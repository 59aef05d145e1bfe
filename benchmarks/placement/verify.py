#!/usr/bin/env python3
"""Checks cases of the open set, and answers: `verify.py CASE.json ..`, `verify.py CASE.json --answer MINE.json`.

Of every case: that the stated joint angles carry out the task at the stated placement (reach, tool axis, joint limits,
conditioning, rate of the free angle, one posture class in a segment), that they have the stated value, and that bound
and gap are what they say. A bound cannot be proved so: whoever finds a plan below it has refuted it. Standard library
alone, written from README.md and the case files: nothing here comes from stead.
"""

import hashlib
import json
import math
import sys

POSITION_UM, AXIS_URAD, JOINT_DEG, CONDITION, RATE, VALUE = 10.0, 10.0, 1e-5, 1e-6, 1e-4, 1e-6
COLUMNS = ["segment", "x", "y", "z", "feed_x", "feed_y", "feed_z", "axis_x", "axis_y", "axis_z", "force_x", "force_y",
           "force_z"]


class Wrong(Exception):
    """What is wrong with a file: its key, and why."""


# Reading: a shape is a type, a list of values allowed, a [shape] of any length, a (length, shape), or a table.

NUMBER, TEXT = float, str
VECTOR = (3, NUMBER)
ROW = {"alpha_deg": NUMBER, "a_mm": NUMBER, "d_mm": NUMBER, "min_deg": NUMBER, "max_deg": NUMBER,
       "compliance_urad_per_nm": lambda value: (2, NUMBER) if isinstance(value, list) else NUMBER}
PLAN = {"placement": {"xyz_mm": VECTOR, "yaw_deg": NUMBER}, "joints_deg": [(6, NUMBER)]}
STATED = PLAN | {"value_mm": NUMBER, "bound_mm": NUMBER, "gap_percent": NUMBER, "relaxed": [TEXT], "by": TEXT,
                 "seconds": NUMBER}
CASE = {"format": ["placement case 1"], "name": TEXT, "about": TEXT, "units": TEXT, "digest": TEXT,
        "robot": {"name": TEXT, "convention": TEXT, "source": TEXT, "rows": (6, ROW)},
        "tool": {"xyz_mm": VECTOR, "rotation": (3, VECTOR)},
        "cell": {"xyz_mm": (3, (2, NUMBER)), "yaw": ["free"]},
        "constraints": {"min_inverse_condition": NUMBER, "characteristic_length_mm": NUMBER},
        "redundancy": {"max_beta_rate_deg_per_mm?": NUMBER, "max_spindle_turn_deg_per_mm?": NUMBER},
        "criterion": {"direction": ["wall", "total"], "aggregate": ["mean"], "force_uncertainty": NUMBER},
        "task": {"columns": [TEXT], "points": [[NUMBER]]}, "stated": STATED}
ANSWER = PLAN | {"format": ["placement answer 1"], "case": TEXT, "digest": TEXT, "by?": TEXT}


def need(holds, key, why):
    if not holds:
        raise Wrong(f"{key}: {why}")


def shaped(value, shape, key):
    """Refuses a value that is not of that shape, and keys that are missing or unknown."""
    if callable(shape) and not isinstance(shape, type):
        shape = shape(value)
    if isinstance(shape, dict):
        need(isinstance(value, dict), key or "file", "must be a table")
        path = f"{key}." if key else ""
        for name in value:
            need(name in shape or name + "?" in shape, path + name, "unknown key")
        for name, inner in shape.items():
            bare = name.removesuffix("?")
            need(bare in value or bare != name, path + bare, "missing")
            if bare in value:
                shaped(value[bare], inner, path + bare)
    elif shape is NUMBER:
        need(type(value) in (int, float) and abs(value) < 1e300, key, f"must be a finite number, is {value!r:.40}")
    elif shape is TEXT:
        need(isinstance(value, str), key, "must be text")
    elif isinstance(shape, list) and isinstance(shape[0], str):
        need(value in shape, key, f"must be {' or '.join(shape)}, is {value!r:.40}")
    else:
        need(isinstance(value, list) and value, key, "must be a list")
        if isinstance(shape, tuple):
            need(len(value) == shape[0], key, f"must have {shape[0]} entries, has {len(value)}")
        for index, entry in enumerate(value):
            shaped(entry, shape[-1], f"{key}[{index}]")


def pairs(entries):
    table = {}
    for name, value in entries:
        need(table.setdefault(name, value) is value, name, "given twice")
    return table


def read(file, shape):
    """The table in a file, refused in one line."""
    try:
        with open(file, encoding="utf-8") as text:
            table = json.load(text, object_pairs_hook=pairs)
    except (OSError, ValueError, RecursionError) as error:
        raise Wrong(f"cannot be read: {str(error).splitlines()[0]}") from error
    shaped(table, shape, "")
    return table


def digest(case):
    """SHA-256 of the problem: of all but the description and what is stated of it, keys sorted, without spaces."""
    problem = {key: value for key, value in case.items() if key not in ("about", "digest", "stated")}
    return hashlib.sha256(json.dumps(problem, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


# Geometry: vectors and matrices as lists, metres, newtons and radians.

def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plus(a, b, factor=1.0):
    return [x + factor * y for x, y in zip(a, b)]


def length(a):
    return math.sqrt(dot(a, a))


def unit(a, key="vector"):
    need(length(a) > 1e-9, key, "has no direction")
    return [x / length(a) for x in a]


def times(matrix, vector):
    return [dot(row, vector) for row in matrix]


def product(a, b):
    return [list(row) for row in zip(*(times(a, column) for column in zip(*b)))]


def about_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]


def frames(rows, joints_deg):
    """Origin and rotation of every frame: modified Denavit-Hartenberg, base first."""
    at, turn, all_frames = [0.0] * 3, about_z(0.0), []
    for row, joint in zip(rows, joints_deg):
        c, s = math.cos(math.radians(row["alpha_deg"])), math.sin(math.radians(row["alpha_deg"]))
        at = plus(at, times(turn, [row["a_mm"] / 1e3, -s * row["d_mm"] / 1e3, c * row["d_mm"] / 1e3]))
        turn = product(product(turn, [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]), about_z(math.radians(joint)))
        all_frames.append((at, turn))
    return all_frames


def inverse_condition(jacobian):
    """6 / sqrt(|J|^2 |J^-1|^2), Frobenius norms."""
    wide = [row[:] + [float(i == j) for j in range(6)] for i, row in enumerate(jacobian)]
    for k in range(6):
        pivot = max(range(k, 6), key=lambda i: abs(wide[i][k]))
        if abs(wide[pivot][k]) < 1e-12:
            return 0.0
        wide[k], wide[pivot] = wide[pivot], wide[k]
        wide[k] = [x / wide[k][k] for x in wide[k]]
        for i in range(6):
            if i != k:
                wide[i] = plus(wide[i], wide[k], -wide[i][k])
    return 6.0 / math.sqrt(sum(x * x for row in jacobian for x in row) * sum(x * x for row in wide for x in row[6:]))


def posture(frame):
    """Signs that change only where the arm is singular: shoulder (wrist centre in front of axis 1 or behind it), elbow,
    wrist."""
    at, axes = [f[0] for f in frame], [[row[2] for row in f[1]] for f in frame]
    to_wrist = plus(at[4], at[2], -1.0)
    signs = (dot(plus(at[4], at[0], -1.0), cross(axes[1], axes[0])),
             dot(axes[1], cross(plus(at[2], at[1], -1.0), to_wrist)), dot(axes[5], cross(axes[3], axes[4])))
    return tuple(sign > 0 for sign in signs)


def deflection(criterion, arms, joints, side, force):
    """The scored deflection of a point (m): the largest that an error of the force up to its share can cause."""
    def compliance(load):
        return [sum(c * dot(arm, load) * arm[k] for arm, c in zip(arms, joints)) for k in range(3)]

    error, moved = criterion["force_uncertainty"] * length(force), compliance(force)
    if criterion["direction"] == "wall":
        return abs(dot(moved, side)) + error * length(compliance(side))
    for _ in range(500 if error and length(moved) else 0):  # grows to the largest |C (f + e u)|: signs of C f are kept
        before, back = length(moved), compliance(moved)
        moved = compliance(plus(force, back, error / length(back)))
        if length(moved) - before <= 1e-13 * before:
            break
    return length(moved)


def examine(case, plan, key):
    """The value (mm) of a plan of a case; `Wrong` if it is none."""
    at, yaw = plan["placement"]["xyz_mm"], about_z(math.radians(plan["placement"]["yaw_deg"]))
    for name, value, (low, high) in zip("xyz", at, case["cell"]["xyz_mm"]):
        need(low - 1e-6 <= value <= high + 1e-6, f"{key}placement.xyz_mm", f"{name} = {value} is outside the cell")
    columns, points, rows = case["task"]["columns"], case["task"]["points"], case["robot"]["rows"]
    need(len(plan["joints_deg"]) == len(points), f"{key}joints_deg",
         f"has {len(plan['joints_deg'])} points, the task {len(points)}")
    z = unit([row[2] for row in case["tool"]["rotation"]], "tool.rotation")
    x = [row[0] for row in case["tool"]["rotation"]]
    x = unit(plus(x, z, -dot(x, z)), "tool.rotation")
    mount = list(zip(x, cross(z, x), z))
    scale = case["constraints"]["characteristic_length_mm"] / 1e3
    sum_, count, before = 0.0, 0.0, None
    for number, (values, joints) in enumerate(zip(points, plan["joints_deg"])):
        where, value = f"{key}joints_deg[{number}]", dict(zip(columns, values))
        feed, axis, force = (times(yaw, [value[f"{name}_{k}"] for k in "xyz"]) for name in ("feed", "axis", "force"))
        goal = plus(times(yaw, [value[k] / 1e3 for k in "xyz"]), [v / 1e3 for v in at])
        axis, frame = unit(axis, f"task.points[{number}]"), frames(rows, joints)
        side = unit(cross(axis, feed), f"task.points[{number}]")
        for k, (row, joint) in enumerate(zip(rows, joints)):
            need(row["min_deg"] - JOINT_DEG <= joint <= row["max_deg"] + JOINT_DEG, f"{where}[{k}]",
                 f"{joint} is outside {row['min_deg']} to {row['max_deg']}")
        tip = plus(frame[5][0], times(frame[5][1], [v / 1e3 for v in case["tool"]["xyz_mm"]]))
        tool = product(frame[5][1], mount)
        x = [row[0] for row in tool]
        off = 1e6 * length(plus(tip, goal, -1.0))
        need(off <= POSITION_UM, where, f"the tool is {off:.1f} um off its point")
        off = 1e6 * length(plus([row[2] for row in tool], axis))
        need(off <= AXIS_URAD, where, f"the tool axis is {off:.1f} urad off")
        arms = [cross([row[2] for row in turn], plus(goal, origin, -1.0)) for origin, turn in frame]
        jacobian = [[arm[k] / scale for arm in arms] for k in range(3)]
        condition = inverse_condition(jacobian + [[turn[k][2] for _, turn in frame] for k in range(3)])
        least = case["constraints"]["min_inverse_condition"]
        need(condition >= least - CONDITION, where, f"inverse condition {condition:.6f}, at least {least}")
        now = (value["segment"], goal, math.atan2(-dot(x, side), dot(x, cross(side, axis))), x, posture(frame))
        if before and before[0] == now[0]:
            need(before[4] == now[4], where, "the posture class changes within a segment")
            step = 1e3 * length(plus(goal, before[1], -1.0))
            turned = math.atan2(dot(cross(before[3], x), axis), dot(before[3], x))
            for name, turn in (("max_beta_rate", now[2] - before[2]), ("max_spindle_turn", turned)):
                name, turn = name + "_deg_per_mm", abs(math.degrees(math.remainder(turn, math.tau)))
                most = step * case["redundancy"].get(name, math.inf)
                need(turn <= most * (1 + RATE) + 2e-5, where, f"turns by {turn:.5f} deg in {step:.5f} mm: {name}")
        before = now
        ranges = [row["compliance_urad_per_nm"] for row in rows]
        soft = [1e-6 * (c if not isinstance(c, list) else c[0] + (c[1] - c[0]) * (joint - row["min_deg"])
                        / (row["max_deg"] - row["min_deg"])) for c, row, joint in zip(ranges, rows, joints)]
        if value.get("scored", 1):
            sum_, count = sum_ + deflection(case["criterion"], arms, soft, side, force), count + 1
    need(sum_ > 0, "task.points", "none counts")
    return 1e3 * sum_ / count


def checked(file):
    """A case that holds, and its value."""
    case = read(file, CASE)
    need(case["digest"] == digest(case), "digest", f"is not that of this problem: {digest(case)}")
    columns, points, stated = case["task"]["columns"], case["task"]["points"], case["stated"]
    need(sorted(set(columns) - {"scored"}) == sorted(COLUMNS) and len(set(columns)) == len(columns), "task.columns",
         f"must be {', '.join(COLUMNS)}, and scored where points do not count")
    for number, values in enumerate(points):
        need(len(values) == len(columns), f"task.points[{number}]", f"has {len(values)} values of {len(columns)}")
    value = examine(case, stated, "stated.")
    need(abs(value / stated["value_mm"] - 1) <= VALUE, "stated.value_mm", f"the plan has {value:.9f}")
    need(0 <= stated["bound_mm"] <= value, "stated.bound_mm", "must lie between 0 and the value")
    gap = 100 * (1 - stated["bound_mm"] / stated["value_mm"])
    need(abs(gap - stated["gap_percent"]) <= 1e-4, "stated.gap_percent", f"must be {gap:.6f}, 1 - bound / value")
    return case, value


def answered(case, value, file):
    """What an answer is worth against the stated plan and the bound."""
    answer = read(file, ANSWER)
    need(answer["digest"] == case["digest"], "digest", f"belongs to another case than {case['name']}")
    mine, bound = examine(case, answer, ""), case["stated"]["bound_mm"]
    than = "the same as" if abs(mine / value - 1) < 1e-9 else "better than" if mine < value else "worse than"
    refuted = ", BELOW THE BOUND, which is refuted: please send it" if mine < bound else ""
    return f"{mine:.9f} mm, {than} the stated plan ({100 * (mine / value - 1):+.4f} %){refuted}; bound {bound} mm"


def main(arguments):
    answer = None
    if len(arguments) == 3 and arguments[1] == "--answer":
        arguments, answer = arguments[:1], arguments[2]
    if not arguments or any(name.startswith("-") for name in arguments):
        print("usage: verify.py CASE.json .. | verify.py CASE.json --answer MINE.json", file=sys.stderr)
        return 2
    failed = 0
    for file in arguments:
        at = file
        try:
            case, value = checked(file)
            print(f"{case['name']}: {value:.9f} mm, bound {case['stated']['bound_mm']} mm, gap"
                  f" {case['stated']['gap_percent']:.4f} %: holds")
            if answer:
                at = answer
                print(f"{answer}: {answered(case, value, answer)}")
        except (Wrong, ArithmeticError) as wrong:
            failed = 1
            print(f"{at}: {wrong}", file=sys.stderr)
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
