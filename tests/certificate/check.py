"""Checks a certificate by other means: `python3 tests/certificate/check.py RUN.toml RESULTS [PLACEMENTS [SEED]]`.

RESULTS is the folder that `stead place RUN.toml --certify GAP --out RESULTS` wrote. Everything else is read from the
run file, the robot file and the task; nothing of stead is used, and only the standard library of Python 3.11.

What a bound is about. It drops the limits of joints 1, 4 and 6, the steps and turns of the joints along the path, and
which of the two flips of the wrist is taken. It keeps reach, the limits of joints 2 and 3 and the wider one of joint 5,
the conditioning, one posture (front or back, elbow up or down) for each segment, and the rate of the free angle beta,
or the turn of the spindle where no rate is set. The *relaxed figure* of a placement is the least mean of the scores
with these constraints alone: the least of each point over beta where no limit joins the points, and otherwise that of
the best path of beta. It depends on the radius of the workpiece origin about axis 1, its height, and the yaw less its
azimuth. Here it is that of a path found on a grid of beta for every posture, and refined by smaller and smaller steps:
never below the true one, and some 0.01 % above it, up to 1 % where scores all but vanish. A bound that is above it at
any placement is wrong.

What is checked:

- What the certificate states of itself agrees: bound, gap, open boxes, and the digests of the input files.
- The plan in `best.csv`, computed anew, has the figure that is stated, within the limits that bounds keep.
- No figure is below the bound of the cell or of the open box that its placement is in, and none outside the open boxes
  is better than the placement found by more than the gap that was asked for: relaxed figures wherever one is computed,
  and those of plans with the limits of all joints, over a grid of beta, at the placement found and at that of the least
  relaxed figure met.
- Relaxed figures are sought by descent: in PLACEMENTS (12) open boxes, half of them those of least bound; and in the
  whole cell, from the placement found and from the best of placements drawn.

Each violation is computed a second time by other formulas (a product of matrices along the arm, and the inverse of the
Jacobian by elimination) before it is reported. Ends with 0 where there is none, with 1 and a line for each violation,
and with 2 where the run or the certificate is not covered.

`check.py --self-test [SEEDS] RUN RESULTS [PLACEMENTS [SEED]]` first plants bounds 1 % too high, for SEEDS (2) seeds: of
an open box (one that is listed, or one that is made up in the cell) and of the cell, whose placement found is withheld.
Each is 1 % above the least relaxed figure that another search knows, over lattices that become finer. All must be seen.

Covered: upright or hanging arms of six rows with a spherical wrist, upright tools, the directions wall, axis and total,
mean and root mean square, weights of segments, force errors, compliances that are constant or, of joints 2 and 3,
linear in the angle. Anything else is refused by its name: every key of the run file, the robot file and the task that
is not listed here, `name:` robots, and certificates that leave out what is not listed here.
"""

import csv
import hashlib
import json
import math
import random
import re
import sys
import tomllib
from pathlib import Path

INFINITE = float("inf")
TURN = 2 * math.pi
ROUNDING = 1e-9  # of angles at their limits
GRIDS = (60, 240)  # values of beta to begin with: the fewest, and the most
STEPS = [math.radians(step) for step in (3, 1.5, 0.75, 0.4, 0.2, 0.1, 0.05, 0.02)]  # by which beta is refined
QUICK = [math.radians(step) for step in (1.6, 0.5, 0.2, 0.07)]  # the same in descents
PLAN_GRID = 72  # values of beta of plans with all limits
SHOWN = 10  # violations that are shown
EDGE = 1e-4  # what rounding may have taken from the sides of a box: mm, deg


class Refused(Exception):
    """What this checker does not cover."""


class Contradiction(Exception):
    """Two ways to compute the same thing do not agree: an error of this checker."""


# Keys that are covered, or have no part in a certificate: a table of keys, or None where all values are.
SPINDLE = "xyz_mm rotation mass_kg centre_of_mass_mm inertia_kg_m2 power_kw torque_nm"
REDUNDANCY = """beta_step_deg feed_mm_per_s max_beta_rate_deg_per_mm max_spindle_turn_deg_per_mm
    max_spindle_turn_deg_per_s"""
ROW = """alpha_deg a_mm d_mm min_deg max_deg stiffness_mnm_per_rad compliance_urad_per_nm max_speed_deg_per_s
    max_acceleration_deg_per_s2 max_jerk_deg_per_s3 mass_kg centre_of_mass_mm inertia_kg_m2 damping_nms_per_rad
    half_backlash_arcsec bearing_mm orthogonal_stiffness_mnm_per_rad orthogonal_compliance_urad_per_nm
    orthogonal_damping_nms_per_rad"""
RUN_KEYS = {
    **dict.fromkeys("robot task search certificate transfer reference output guesses".split()),
    "spindle": dict.fromkeys(SPINDLE.split()),
    "cell": dict.fromkeys("x_mm y_mm z_mm q4 yaw_deg".split()),
    "constraints": dict.fromkeys("min_inverse_condition characteristic_length_mm".split()),
    "criterion": dict.fromkeys("direction aggregate force_uncertainty".split()),
    "redundancy": dict.fromkeys(REDUNDANCY.split()),
    "postures": {"tie_percent": None},
    "segment": dict.fromkeys("number weight".split()),
}
ABOUT = "name source controller root payload_kg price_eur unverified working_radius_mm stiffness_like flange_mm"
ROBOT_KEYS = {
    **dict.fromkeys(ABOUT.split()),
    **dict.fromkeys("stiffness_model stiffness_measured_from".split()),
    "joints": dict.fromkeys(ROW.split()),
}
COLUMNS = "segment x_mm y_mm z_mm feed_x feed_y feed_z axis_x axis_y axis_z force_x_n force_y_n force_z_n"
RELAXED = r"(steps|turns|steps and turns) of the joints between path points|limits of joints? [1456 ,and]+|" \
    "rate of beta|turn of the spindle|which yaw goes with which x and y"


def require_known(table, keys, within):
    for key, value in table.items():
        if key not in keys:
            raise Refused(f"the key {within}{key}")
        if keys[key] is not None:
            for inner in value if isinstance(value, list) else [value]:
                require_known(inner, keys[key], f"{within}{key}.")


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def norm(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return tuple(x / norm(a) for x in a)


def times(m, v):
    return tuple(dot(row, v) for row in m)


def product(a, b):
    columns = list(zip(*b))
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def transposed(m):
    return tuple(zip(*m))


def about_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))


def about_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def wrapped(angle):
    return (angle + math.pi) % TURN - math.pi


class Robot:
    def __init__(self, table):
        require_known(table, ROBOT_KEYS, "robot file: ")
        if table.get("stiffness_model") == "full":
            raise Refused("springs normal to the axes (stiffness_model = \"full\")")
        self.rows = table["joints"]
        if len(self.rows) != 6:
            raise Refused("an arm without six rows")
        self.alpha = [math.radians(row["alpha_deg"]) for row in self.rows]
        self.a = [row["a_mm"] / 1e3 for row in self.rows]
        self.d = [row["d_mm"] / 1e3 for row in self.rows]
        self.limits = [(math.radians(row["min_deg"]), math.radians(row["max_deg"])) for row in self.rows]
        self.signs = [round(math.sin(angle)) for angle in self.alpha]
        is_right = [abs(abs(self.signs[j]) - (j in (1, 3, 4, 5))) == 0 for j in range(6)]
        is_exact = all(abs(math.sin(2 * angle)) < 1e-9 for angle in self.alpha)
        if not all(is_right) or not is_exact or any(self.a[4:]) or self.d[4]:
            raise Refused("an arm whose axes are not upright, normal or parallel to each other with a spherical wrist")
        # Compliance where the angle is at its lower limit, and its change by the angle.
        self.compliances = [self.law(joint) for joint in range(6)]
        widest = max(abs(limit) for limit in self.limits[4]) + ROUNDING
        self.least_cosine5 = -1.0 if widest >= math.pi else math.cos(widest)

    def law(self, joint):
        row = self.rows[joint]
        if "stiffness_mnm_per_rad" in row:
            return 1e-6 / row["stiffness_mnm_per_rad"], 0.0
        value = row.get("compliance_urad_per_nm")
        if value is None:
            raise Refused(f"no compliance of joint {joint + 1}")
        if not isinstance(value, list):
            return 1e-6 * value, 0.0
        if joint not in (1, 2):
            raise Refused(f"a range of compliances of joint {joint + 1}")
        low, high = self.limits[joint]
        return 1e-6 * value[0], 1e-6 * (value[1] - value[0]) / (high - low)

    def compliance(self, joint, theta):
        value, slope = self.compliances[joint]
        return value + slope * (theta - self.limits[joint][0])

    def frames(self, theta):
        """Origins and rotations of the six rows in the base frame."""
        at, rotation, out = (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), []
        for j in range(6):
            c, s = math.cos(self.alpha[j]), math.sin(self.alpha[j])
            shift = times(rotation, (self.a[j], -s * self.d[j], c * self.d[j]))
            at = (at[0] + shift[0], at[1] + shift[1], at[2] + shift[2])
            rotation = product(rotation, product(about_x(self.alpha[j]), about_z(theta[j])))
            out.append((at, rotation))
        return out

    def inverse(self, at, rotation):
        """All joint angles that have frame 6 there, with the numbers of their postures."""
        alpha, a, d = self.alpha, self.a, self.d
        z6 = tuple(row[2] for row in rotation)
        wrist = tuple(at[k] - d[5] * z6[k] for k in range(3))
        x, y, z = times(transposed(about_x(alpha[0])), minus(wrist, (a[0], 0.0, 0.0)))
        lift, fold = self.signs[1], round(math.cos(alpha[2]))
        lateral = -lift * (d[1] + fold * d[2])
        rho2 = x * x + y * y - lateral * lateral
        if rho2 <= 0:
            return
        upper, fore = a[2], math.hypot(a[3], d[3])
        bar = math.atan2(-d[3] * self.signs[3], a[3])
        for front, side in enumerate((1.0, -1.0)):
            rho = side * math.sqrt(rho2)
            first = math.atan2(y, x) - math.atan2(lateral, rho)
            u, v = rho - a[1], lift * (z - d[0])
            cosine = (u * u + v * v - upper * upper - fore * fore) / (2 * upper * fore)
            if abs(cosine) > 1:
                continue
            for up, elbow in enumerate((1.0, -1.0)):
                delta = elbow * math.acos(cosine)
                second = math.atan2(v, u) - fold * math.atan2(fore * math.sin(delta), upper + fore * math.cos(delta))
                head = [first, second, delta - bar]
                base3 = self.frames(head + [0.0, 0.0, 0.0])[2][1]
                m = product(transposed(about_x(alpha[3])), product(transposed(base3), rotation))
                sign = self.signs[4] * self.signs[5]
                cosine5 = max(-1.0, min(1.0, -m[2][2] * sign))
                for flipped, flip in enumerate((1.0, -1.0)):
                    sine5 = flip * math.sqrt(1 - cosine5 * cosine5)
                    fifth = math.atan2(sine5, cosine5)
                    fourth = math.atan2(self.signs[5] * sine5 * m[1][2], self.signs[5] * sine5 * m[0][2])
                    hand = product(about_z(fifth), about_x(alpha[5]))
                    before = product(about_z(fourth), product(about_x(alpha[4]), hand))
                    last = product(transposed(before), m)
                    yield 4 * front + 2 * up + flipped, head + [fourth, fifth, math.atan2(last[1][0], last[0][0])]

    def within(self, theta, relaxed):
        """The angles with whole turns added, within the limits, or those that bounds keep; None where there are none.
        """
        out = []
        for joint, (value, (low, high)) in enumerate(zip(theta, self.limits)):
            value -= TURN * math.floor((value - low + ROUNDING) / TURN)
            if relaxed and joint == 4:
                if math.cos(value) < self.least_cosine5:
                    return None
            elif value > high + ROUNDING and not (relaxed and joint in (0, 3, 5)):
                return None
            out.append(value)
        return out


def inverse_condition(columns, length):
    """6 / (|N| |N^-1|) by Gauss and Jordan."""
    size = 6
    matrix = [[columns[j][k] / length if k < 3 else columns[j][k] for j in range(size)] for k in range(size)]
    of_matrix = sum(x * x for row in matrix for x in row)
    work = [row + [1.0 if k == r else 0.0 for k in range(size)] for r, row in enumerate(matrix)]
    for column in range(size):
        pivot = max(range(column, size), key=lambda r: abs(work[r][column]))
        if abs(work[pivot][column]) < 1e-12:
            return 0.0
        work[column], work[pivot] = work[pivot], work[column]
        lead = work[column][column]
        work[column] = [x / lead for x in work[column]]
        for r in range(size):
            factor = work[r][column]
            if r != column and factor:
                work[r] = [x - factor * y for x, y in zip(work[r], work[column])]
    of_inverse = sum(x * x for row in work for x in row[size:])
    return 6 / math.sqrt(of_matrix * of_inverse)


class Run:
    """What is placed, and the figures of plans by the plain formulas."""

    def __init__(self, file):
        table = tomllib.loads(file.read_text())
        require_known(table, RUN_KEYS, "run file: ")
        for key in ("robot", "task"):
            if table[key].startswith("name:") or Path(table[key]).suffix != {"robot": ".toml", "task": ".csv"}[key]:
                raise Refused(f"{key} = \"{table[key]}\"")
        self.files = {"config": file, **{key: file.parent / table[key] for key in ("robot", "task")}}
        self.robot = Robot(tomllib.loads(self.files["robot"].read_text()))
        self.read_task(list(csv.DictReader(self.files["task"].read_text().splitlines())))
        numbers = {row["number"]: row["weight"] for row in table.get("segment", [])}
        self.weights = [numbers.get(int(segment), 1.0) for segment in self.segments]
        self.read_spindle(table["spindle"])
        cell = table["cell"]
        self.cell = [tuple(v / 1e3 for v in cell[key]) for key in ("x_mm", "y_mm", "z_mm")]
        q4 = [2 * math.asin(v) for v in cell.get("q4", [-1.0, 1.0])]
        self.cell.append(tuple(math.radians(v) for v in cell["yaw_deg"]) if "yaw_deg" in cell else tuple(q4))
        self.least = table["constraints"]["min_inverse_condition"]
        self.length = table["constraints"]["characteristic_length_mm"] / 1e3
        criterion = table.get("criterion", {})
        self.direction = criterion.get("direction", "wall")
        self.errors = criterion.get("force_uncertainty", 0.0)
        aggregate = criterion.get("aggregate", "mean")
        if self.direction not in ("wall", "axis", "total") or aggregate not in ("mean", "rms"):
            raise Refused(f"direction = \"{self.direction}\" with aggregate = \"{aggregate}\"")
        self.power = {"mean": 1, "rms": 2}[aggregate]
        self.read_limits(table.get("redundancy", {}))

    def read_task(self, rows):
        if set(rows[0]) != set(COLUMNS.split()):
            names = ", ".join(sorted(set(rows[0]) ^ set(COLUMNS.split())))
            raise Refused(f"a task with, or without, the columns {names}")
        number = lambda row, *names: tuple(float(row[name]) for name in names)
        self.segments = [row["segment"] for row in rows]
        self.points = [tuple(x / 1e3 for x in number(row, "x_mm", "y_mm", "z_mm")) for row in rows]
        self.axes = [unit(number(row, "axis_x", "axis_y", "axis_z")) for row in rows]
        if any(norm(minus(axis, (0.0, 0.0, round(self.axes[0][2])))) > 1e-6 for axis in self.axes):
            raise Refused("a tool that leans")
        sides = [unit(cross(axis, number(row, "feed_x", "feed_y", "feed_z"))) for axis, row in zip(self.axes, rows)]
        self.sides, self.feeds = sides, [cross(side, axis) for side, axis in zip(sides, self.axes)]
        self.forces = [number(row, "force_x_n", "force_y_n", "force_z_n") for row in rows]
        starts = [k for k in range(len(rows)) if k == 0 or self.segments[k] != self.segments[k - 1]]
        self.spans = list(zip(starts, starts[1:] + [len(rows)]))

    def read_spindle(self, spindle):
        if "rotation" not in spindle:
            raise Refused("a spindle without rotation")
        self.tool_at = tuple(x / 1e3 for x in spindle["xyz_mm"])
        # Rotations are given with few digits: made orthonormal.
        x, _, z = [tuple(float(row[k]) for row in spindle["rotation"]) for k in range(3)]
        z = unit(z)
        x = unit(minus(x, tuple(dot(x, z) * c for c in z)))
        self.tool_turn = transposed((x, cross(z, x), z))

    def read_limits(self, limits):
        """Of each point the ranges within which beta may change to it, middle and half: with the rate of beta, and with
        the turn of the spindle."""
        by_length, by_time = [limits.get(f"max_spindle_turn_deg_per_{unit}") for unit in ("mm", "s")]
        self.rate = limits.get("max_beta_rate_deg_per_mm")
        self.has_turn = by_length is not None or by_time is not None
        self.rates, self.turns = [None], [None]
        for before, here in zip(range(len(self.points)), range(1, len(self.points))):
            length = norm(minus(self.points[here], self.points[before])) * 1e3
            self.rates.append(None if self.rate is None else (0.0, math.radians(self.rate * length)))
            reach = [90.0]
            reach += [] if by_length is None else [by_length * length]
            reach += [] if by_time is None else [by_time * length / limits["feed_mm_per_s"]]
            # The spindle turns with the feed, less beta, whose sign is that of Rx(pi).
            old, new, axis = self.feeds[before], self.feeds[here], self.axes[here]
            turned = math.atan2(dot(cross(old, new), axis), dot(old, new))
            self.turns.append((turned, math.radians(min(reach))) if self.has_turn else None)

    def score(self, force, direction, velocities, compliances):
        """The deflection that counts. m"""
        matrix = [[0.0] * 3 for _ in range(3)]
        for v, compliance in zip(velocities, compliances):
            for row, part in zip(matrix, v):
                row[0] += compliance * part * v[0]
                row[1] += compliance * part * v[1]
                row[2] += compliance * part * v[2]
        moved = lambda f: times(matrix, f)
        size = self.errors * norm(force)
        if self.direction != "total":
            return abs(dot(moved(force), direction)) + size * norm(moved(direction))
        total, before = moved(force), 0.0
        while size and norm(total) > before * (1 + 1e-10):
            # The worst error lies along C C (f + e).
            before, along = norm(total), moved(total)
            by = size / max(norm(along), 1e-300)
            total = moved([f + by * x for f, x in zip(force, along)])
        return norm(total)

    def placed(self, placement, point):
        """Tool centre point, feed, side, axis and force in the base frame."""
        x, y, z, yaw = placement
        about = about_z(yaw)
        tip = tuple(a + b for a, b in zip(times(about, self.points[point]), (x, y, z)))
        return tip, *(times(about, of[point]) for of in (self.feeds, self.sides, self.axes, self.forces))

    def state(self, placement, point, beta, relaxed=False, slack=ROUNDING):
        """Of one value of beta the scores by posture: infinite where a limit is violated, or one that bounds keep. m"""
        tip, feed, side, axis, force = self.placed(placement, point)
        turned = product(product(transposed((feed, side, axis)), about_x(math.pi)), about_z(beta))
        rotation = product(turned, transposed(self.tool_turn))
        at = minus(tip, times(rotation, self.tool_at))
        scores, known = [INFINITE] * 8, {}
        for posture, theta in self.robot.inverse(at, rotation):
            real = self.robot.within(theta, relaxed)
            if real is not None:
                # A flip of the wrist turns axes over and no more.
                if posture // 2 not in known:
                    direction = axis if self.direction == "axis" else side
                    known[posture // 2] = self.of(theta, real, tip, force, direction, slack)
                scores[posture] = known[posture // 2]
        return scores

    def of(self, theta, real, tip, force, direction, slack):
        frames = self.robot.frames(theta)
        axes = [tuple(row[2] for row in rotation) for _, rotation in frames]
        velocities = [cross(z, minus(tip, at)) for z, (at, _) in zip(axes, frames)]
        if inverse_condition([v + z for v, z in zip(velocities, axes)], self.length) < self.least - slack:
            return INFINITE
        compliances = [self.robot.compliance(j, value) for j, value in enumerate(real)]
        return self.score(force, direction, velocities, compliances)

    def cost(self, point, score):
        return self.weights[point] * score**self.power

    def joined(self, cost):
        """The figure of a path from the sum of what its points cost. m"""
        return (cost / sum(self.weights)) ** (1 / self.power)

    def figure(self, placement):
        """That of the best plan over the grid, with the limits of all joints. m"""
        total = 0.0
        for start, end in self.spans:
            best = None
            for point in range(start, end):
                states = [self.state(placement, point, TURN * step / PLAN_GRID) for step in range(PLAN_GRID)]
                costs = [[self.cost(point, score) for score in scores] for scores in states]
                if best is not None:
                    steps = [step for step in range(PLAN_GRID) if self.allows(point, TURN * step / PLAN_GRID)]
                    sums = [[min((best[k - step][posture] for step in steps), default=INFINITE) for posture in range(8)]
                            for k in range(PLAN_GRID)]
                    costs = [[a + b for a, b in zip(*rows)] for rows in zip(sums, costs)]
                best = costs
            total += min(min(row) for row in best)
        return self.joined(total)

    def allows(self, point, change):
        """Whether beta may change so much to a point from the one before."""
        ranges = [limit for limit in (self.rates[point], self.turns[point]) if limit is not None]
        return all(abs(wrapped(change - middle)) <= half + ROUNDING for middle, half in ranges)


class Relaxed:
    """Relaxed figures of placements, by closed formulas of an upright arm in the frame that turns with joint 1."""

    def __init__(self, run, steps):
        """With the ranges within which beta may change to each point."""
        self.run, self.steps = run, steps
        # Two steps of the grid within the narrowest range, where that is possible.
        narrowest = min((limit[1] for limit in steps if limit is not None), default=math.pi)
        self.grid = max(GRIDS[0], min(GRIDS[1], math.ceil(TURN / max(narrowest / 2, 1e-3))))
        robot = run.robot
        self.turned_over = transposed(about_x(robot.alpha[0]))
        fold = round(math.cos(robot.alpha[2]))
        bar = math.atan2(-robot.d[3] * robot.signs[3], robot.a[3])
        lateral = -robot.signs[1] * (robot.d[1] + fold * robot.d[2])
        # Forearm along and across axis 4; the sign of cos(theta_5) against the cosine between axes 4 and 6.
        fore = math.hypot(robot.a[3], robot.d[3])
        self.arm = (robot.signs[1], fold, lateral, robot.a[1], robot.d[0], robot.a[2], fore, bar,
                    -robot.signs[3] * fold * robot.a[3], robot.d[3], -robot.signs[3] * robot.signs[4])
        flange = transposed(run.tool_turn)
        self.axis6 = tuple(row[2] for row in flange)
        self.lever = tuple(a + robot.d[5] * b for a, b in zip(times(flange, run.tool_at), self.axis6))

    def placed(self, placement):
        """Of every point tool centre point, feed, side, axis, direction scored and force, in the frame of axis 1."""
        out = []
        for point in range(len(self.run.points)):
            tip, *others = self.run.placed(placement, point)
            tip = minus(tip, (self.run.robot.a[0], 0.0, 0.0))
            tip, feed, side, axis, force = [times(self.turned_over, v) for v in (tip, *others)]
            out.append((tip, feed, side, axis, axis if self.run.direction == "axis" else side, force))
        return out

    def score(self, placed, beta, posture):
        """The score, infinite where a limit is violated that bounds keep; with its sign where one part of the
        deflection is scored without force errors. m"""
        (px, py, pz), (fx, fy, fz), (sx, sy, sz), (ax, ay, az), direction, force = placed
        lift, fold, lateral, shoulder, height, upper, fore, bar, across, along, sign5 = self.arm
        run, robot = self.run, self.run.robot
        c, s = math.cos(beta), math.sin(beta)
        # The lever from the wrist to the tool centre point, and axis 6.
        x, y, z = self.lever
        x, y, z = c * x - s * y, -s * x - c * y, -z
        tx, ty, tz = fx * x + sx * y + ax * z, fy * x + sy * y + ay * z, fz * x + sz * y + az * z
        x, y, z = self.axis6
        x, y, z = c * x - s * y, -s * x - c * y, -z
        x6, y6, z6 = fx * x + sx * y + ax * z, fy * x + sy * y + ay * z, fz * x + sz * y + az * z
        # The wrist in the plane of the arm, and the angles of joints 2 and 3.
        wx, wy = px - tx, py - ty
        away2 = wx * wx + wy * wy
        rho2 = away2 - lateral * lateral
        if rho2 <= 0:
            return INFINITE
        rho = -math.sqrt(rho2) if posture & 2 else math.sqrt(rho2)
        u, v = rho - shoulder, lift * (pz - tz - height)
        cosine = (u * u + v * v - upper * upper - fore * fore) / (2 * upper * fore)
        if abs(cosine) > 1:
            return INFINITE
        sine = -math.sqrt(1 - cosine * cosine) if posture & 1 else math.sqrt(1 - cosine * cosine)
        second = math.atan2(v, u) - fold * math.atan2(fore * sine, upper + fore * cosine)
        third = math.atan2(sine, cosine) - bar
        (low2, high2), (low3, high3) = robot.limits[1:3]
        second -= TURN * math.floor((second - low2 + ROUNDING) / TURN)
        third -= TURN * math.floor((third - low3 + ROUNDING) / TURN)
        if second > high2 + ROUNDING or third > high3 + ROUNDING:
            return INFINITE
        # From here on x is along the arm, y normal to its plane, z along axis 1.
        ex, ey = (wx * rho + wy * lateral) / away2, (wy * rho - wx * lateral) / away2
        tx, ty = ex * tx + ey * ty, ex * ty - ey * tx
        x6, y6 = ex * x6 + ey * y6, ex * y6 - ey * x6
        du, dv = u - upper * math.cos(second), v - upper * math.sin(second)
        x4 = (along * du - across * dv) / (fore * fore)
        z4 = lift * (along * dv + across * du) / (fore * fore)
        dot46 = x4 * x6 + z4 * z6
        sine2 = 1 - dot46 * dot46
        if sign5 * dot46 < robot.least_cosine5 or sine2 < 1e-12:
            return INFINITE
        root = math.sqrt(sine2)
        x5, y5, z5 = -z4 * y6 / root, (z4 * x6 - x4 * z6) / root, x4 * y6 / root
        # How the tool centre point moves with each joint; joints 2 and 3 turn about y.
        x2, z2, x3, z3 = lift * v, -u, lift * dv, -du
        v1x, v1y, v2x, v2z, v3x, v3z = -lateral - ty, rho + tx, x2 + tz, z2 - tx, x3 + tz, z3 - tx
        v4x, v4y, v4z = -z4 * ty, z4 * tx - x4 * tz, x4 * ty
        v5x, v5y, v5z = y5 * tz - z5 * ty, z5 * tx - x5 * tz, x5 * ty - y5 * tx
        v6x, v6y, v6z = y6 * tz - z6 * ty, z6 * tx - x6 * tz, x6 * ty - y6 * tx
        # The norm of the Jacobian, and that of its inverse: joints 1 to 3 move the wrist, 4 to 6 turn the tool back.
        det = z2 * x3 - x2 * z3
        if det * det < 1e-20:
            return INFINITE
        length2 = run.length * run.length
        of_jacobian = 6 + (v1x * v1x + v1y * v1y + v2x * v2x + v2z * v2z + v3x * v3x + v3z * v3z
                           + v4x * v4x + v4y * v4y + v4z * v4z + v5x * v5x + v5y * v5y + v5z * v5z
                           + v6x * v6x + v6y * v6y + v6z * v6z) / length2
        q1y, q2x, q2z, q3x, q3z = 1 / rho, -z3 / det, x3 / det, z2 / det, -x2 / det
        q2y, q3y = q2x * lateral / rho, q3x * lateral / rho
        c1x, c1z = q1y * tz, -q1y * tx
        c2x, c2y, c2z = q2y * tz - q2z * ty, q2z * tx - q2x * tz, q2x * ty - q2y * tx
        c3x, c3y, c3z = q3y * tz - q3z * ty, q3z * tx - q3x * tz, q3x * ty - q3y * tx
        by_shift = (q1y * q1y + q2x * q2x + q2y * q2y + q2z * q2z + q3x * q3x + q3y * q3y + q3z * q3z)
        by_turn = (c1x * c1x + c1z * c1z + c2x * c2x + c2y * c2y + c2z * c2z + c3x * c3x + c3y * c3y + c3z * c3z)
        qx, qy, qz, cx, cy, cz = q2x + q3x, q2y + q3y, q2z + q3z, c2x + c3x, c2y + c3y, c2z + c3z
        for x, y, z in (((x4 - dot46 * x6) / sine2, -dot46 * y6 / sine2, (z4 - dot46 * z6) / sine2), (x5, y5, z5),
                        ((x6 - dot46 * x4) / sine2, y6 / sine2, (z6 - dot46 * z4) / sine2)):
            a, b, d = y * qx, y * qy + z * q1y, y * qz
            by_shift += a * a + b * b + d * d
            a, b, d = x - y * cx - z * c1x, y - y * cy, z - y * cz - z * c1z
            by_turn += a * a + b * b + d * d
        if run.least * run.least * of_jacobian * (length2 * by_shift + by_turn) > 36:
            return INFINITE
        (k1, _), (k2, slope2), (k3, slope3), (k4, _), (k5, _), (k6, _) = robot.compliances
        k2, k3 = k2 + slope2 * (second - low2), k3 + slope3 * (third - low3)
        (nx, ny, nz), (gx, gy, gz) = direction, force
        nx, ny, gx, gy = ex * nx + ey * ny, ex * ny - ey * nx, ex * gx + ey * gy, ex * gy - ey * gx
        if run.errors or run.direction == "total":
            moves = ((v1x, v1y, 0.0), (v2x, 0.0, v2z), (v3x, 0.0, v3z), (v4x, v4y, v4z), (v5x, v5y, v5z),
                     (v6x, v6y, v6z))
            return run.score((gx, gy, gz), (nx, ny, nz), moves, (k1, k2, k3, k4, k5, k6))
        return (k1 * (v1x * nx + v1y * ny) * (v1x * gx + v1y * gy)
                + k2 * (v2x * nx + v2z * nz) * (v2x * gx + v2z * gz)
                + k3 * (v3x * nx + v3z * nz) * (v3x * gx + v3z * gz)
                + k4 * (v4x * nx + v4y * ny + v4z * nz) * (v4x * gx + v4y * gy + v4z * gz)
                + k5 * (v5x * nx + v5y * ny + v5z * nz) * (v5x * gx + v5y * gy + v5z * gz)
                + k6 * (v6x * nx + v6y * ny + v6z * nz) * (v6x * gx + v6y * gy + v6z * gz))

    def cost(self, placed, point, beta, posture):
        return self.run.cost(point, abs(self.score(placed[point], beta, posture)))

    def on_grid(self, placed, span, posture):
        """About the least cost of a segment over a grid of beta, and the path."""
        start, end = span
        count, shift, rows, betas = self.grid, 0.0, [], []
        grid = TURN / count
        for point in range(start, end):
            middle, half = (self.steps[point] if point > start else None) or (0.0, INFINITE)
            # Shifted by what the middle of the range is, so that staying where it was is allowed.
            shift += middle
            betas.append([shift + grid * k for k in range(count)])
            scores = [self.score(placed[point], beta, posture) for beta in betas[-1]]
            # Where the sign changes from one value to the next there is a zero in between.
            changes = lambda a, b: -INFINITE < a * b < 0
            scores = [0.0 if changes(here, scores[k - 1]) or changes(here, scores[k + 1 - count]) else abs(here)
                      for k, here in enumerate(scores)]
            costs = [self.run.cost(point, score) for score in scores]
            if rows:
                sums, reach = rows[-1][0], int(min((half + ROUNDING) / grid, count // 2))
                if reach == count // 2:
                    backs = [min(range(count), key=sums.__getitem__)] * count
                else:
                    near = range(-reach, reach + 1)
                    backs = [min([(k + j) % count for j in near], key=sums.__getitem__) for k in range(count)]
                costs = [cost + sums[back] for cost, back in zip(costs, backs)]
                rows.append((costs, backs))
            else:
                rows.append((costs, None))
            if min(costs) == INFINITE:
                return INFINITE, None
        k, path = min(range(count), key=rows[-1][0].__getitem__), []
        for (_, backs), row in zip(reversed(rows), reversed(betas)):
            path.append(row[k])
            k = backs[k] if backs else k
        return min(rows[-1][0]), path[::-1]

    def refined(self, placed, span, posture, path, steps):
        """The least cost of a segment by paths about one, each point of which moves by a step at a time."""
        points, least = range(*span), INFINITE
        known = [{} for _ in points]

        def cost(k, beta):
            if beta not in known[k]:
                known[k][beta] = self.cost(placed, points[k], beta, posture)
            return known[k][beta]

        for step in steps:
            for _ in range(4):
                choices = [(beta, beta - step, beta + step) for beta in path]
                sums, backs = [cost(0, beta) for beta in choices[0]], []
                for k in range(1, len(path)):
                    limit = self.steps[points[k]]
                    row, back = [], []
                    for beta in choices[k]:
                        best, number = INFINITE, 0
                        for j, before in enumerate(choices[k - 1]):
                            if sums[j] < best and (limit is None
                                                   or abs(wrapped(beta - before - limit[0])) <= limit[1] + ROUNDING):
                                best, number = sums[j], j
                        row.append(best + cost(k, beta) if best < INFINITE else INFINITE)
                        back.append(number)
                    sums = row
                    backs.append(back)
                least = min(sums)
                if least == INFINITE:
                    return INFINITE, None
                numbers = [sums.index(least)]
                for back in reversed(backs):
                    numbers.append(back[numbers[-1]])
                path = [choice[number] for choice, number in zip(choices, reversed(numbers))]
                if not any(numbers):
                    break
        return least, path

    def figure(self, placement, plan=None, steps=QUICK):
        """The relaxed figure (m) and its plan, a posture and a path for each segment; with a plan that is known, those
        near to it alone."""
        placed, total, out = self.placed(placement), 0.0, []
        for number, span in enumerate(self.run.spans):
            if plan is None:
                ways = [(*self.on_grid(placed, span, posture), posture) for posture in range(4)]
                least = min(cost for cost, _, _ in ways)
                ways = [(posture, path) for cost, path, posture in ways if cost < INFINITE and cost <= 1.1 * least]
            else:
                ways = [plan[number]]
            found = [(*self.refined(placed, span, posture, path, steps), posture) for posture, path in ways]
            cost, path, posture = min(found, key=lambda way: way[0], default=(INFINITE, None, 0))
            if cost == INFINITE:
                return INFINITE, None
            total += cost
            out.append((posture, path))
        return self.run.joined(total), out

    def rough(self, placement):
        """About the relaxed figure, from some points and values of beta: by which placements are ranked. m"""
        placed, total, count = self.placed(placement), 0.0, 24
        for start, end in self.run.spans:
            ways = [0.0] * 4
            for point in range(start, end, max(1, min(4, (end - start) // 3))):
                for posture in range(4):
                    if ways[posture] < INFINITE:
                        ways[posture] += min(self.cost(placed, point, TURN * k / count, posture) for k in range(count))
            total += min(ways)
        return total

    def confirmed(self, placement, plan, slack=ROUNDING):
        """The figure of a plan by the plain formulas, within the limits of beta. m"""
        total = 0.0
        for (start, end), (posture, path) in zip(self.run.spans, plan):
            for point, beta in zip(range(start, end), path):
                scores = self.run.state(placement, point, beta, True, slack)
                total += self.run.cost(point, min(scores[2 * posture:2 * posture + 2]))
                limit = self.steps[point] if point > start else None
                if limit and abs(wrapped(beta - path[point - start - 1] - limit[0])) > limit[1] + 2 * slack:
                    return INFINITE
        return self.run.joined(total)


class Coordinates:
    """Radius about axis 1 and height (m) of the workpiece origin, and the yaw less its azimuth (rad)."""

    def __init__(self, run):
        self.axis, self.cell = run.robot.a[0], run.cell
        (x0, x1), (y0, y1), heights = [tuple(v - self.axis for v in run.cell[0]), *run.cell[1:3]]
        gap = lambda a, b: max(a, -b, 0.0)
        far = math.hypot(max(abs(x0), abs(x1)), max(abs(y0), abs(y1)))
        self.low = (math.hypot(gap(x0, x1), gap(y0, y1)), heights[0], -math.pi)
        self.high = (far, heights[1], math.pi)
        corners = [math.atan2(y, x) for x in (x0, x1) for y in (y0, y1)]
        self.azimuths = [math.radians(k / 2) for k in range(-360, 360)] + corners

    def of(self, placement):
        x, y, z, yaw = placement
        return math.hypot(x - self.axis, y), z, wrapped(yaw - math.atan2(y, x - self.axis))

    def placement(self, at):
        """A placement of the cell, None where none is there."""
        radius, z, turn = at
        for azimuth in self.azimuths:
            out = (self.axis + radius * math.cos(azimuth), radius * math.sin(azimuth), z, wrapped(azimuth + turn))
            if all(low - 1e-7 <= v <= high + 1e-7 for v, (low, high) in zip(out, self.cell)):
                return out
        return None


class Claims:
    """What a certificate states: in open boxes their bounds, and elsewhere another. m"""

    def __init__(self, boxes, elsewhere, bound=0.0):
        self.boxes, self.elsewhere, self.bound = boxes, elsewhere, bound

    def least_allowed(self, at):
        inside = []
        for low, high, bound in self.boxes:
            edges = (EDGE / 1e3, EDGE / 1e3, math.radians(EDGE))
            middle = [0.5 * (a + b) for a, b in zip(low, high)]
            off = [at[0] - middle[0], at[1] - middle[1], wrapped(at[2] - middle[2])]
            if all(abs(x) <= 0.5 * (b - a) + edge for x, a, b, edge in zip(off, low, high, edges)):
                inside.append(bound)
        return max(self.bound, min(inside, default=self.elsewhere))


class Search:
    """Seeks placements with a figure below what is stated."""

    def __init__(self, relaxed, claims, seed, until_first=False):
        self.relaxed, self.claims, self.until_first = relaxed, claims, until_first
        self.coordinates = Coordinates(relaxed.run)
        self.drawn = random.Random(seed)
        self.violations = []
        self.least = (INFINITE, None, None)

    def is_done(self):
        return self.until_first and bool(self.violations)

    def ask(self, at, plan=None):
        """The figure in terms of what it may not be below, and its plan."""
        placement = self.coordinates.placement(at)
        if placement is None:
            return INFINITE, None
        figure, plan = self.relaxed.figure(placement, plan)
        if plan is None:
            return INFINITE, None
        self.least = min(self.least, (figure, placement, plan), key=lambda known: known[0])
        allowed = self.claims.least_allowed(at)
        if figure < allowed * (1 - 1e-6):
            by_other_means = self.relaxed.confirmed(placement, plan)
            if not abs(by_other_means - figure) <= 1e-7 * figure:
                raise Contradiction(f"{figure} and {by_other_means} m at {placement}")
            self.violations.append((placement, figure, allowed))
        return figure / max(allowed, 1e-12), plan

    def descend(self, at, low, high, size, tries, plan=None):
        """From a placement down within a box; the least value of `ask`. Steps are along one coordinate at a time,
        longer where they led down and shorter where not, and every fourth one is drawn in any direction."""
        least, plan = (INFINITE, None) if self.is_done() else self.ask(at, plan)
        first = [size * (b - a) for a, b in zip(low, high)]
        reach, looked, left = first, tries, tries if plan else 0
        while left > 0 and not self.is_done():
            if looked - left > 50:
                # Other postures and paths, and longer steps again.
                (found, other), looked = self.ask(at), left
                least, plan = (found, other) if found < least else (least, plan)
                reach = [max(now, 0.2 * begin) for now, begin in zip(reach, first)]
            for side in range(4):
                step = [self.drawn.uniform(0.5, 1) * reach[k] * (k == side) for k in range(3)]
                step = step if side < 3 else [self.drawn.gauss(0, 0.7) * length for length in reach]
                is_lower = False
                for sign in (1, -1):
                    while left > 0 or not is_lower:
                        there = [min(b, max(a, v + sign * s)) for v, s, a, b in zip(at, step, low, high)]
                        found, other = self.ask(there, plan) if there != at else (INFINITE, None)
                        left -= 1
                        if found >= least:
                            break
                        at, least, plan, is_lower, step = there, found, other, True, [2 * s for s in step]
                    if is_lower:
                        break
                if side < 3:
                    reach = [(max(now, step[k]) if is_lower else 0.6 * now) if k == side else now
                             for k, now in enumerate(reach)]
        return least

    def in_box(self, box):
        low, high = inner(box)
        starts = [[0.5 * (a + b) for a, b in zip(low, high)]]
        starts += [[self.drawn.uniform(a, b) for a, b in zip(low, high)] for _ in range(20)]
        for start in starts:
            least = self.descend(start, low, high, 0.3, 60)
            if least < INFINITE:
                return least
        return INFINITE

    def in_boxes(self, count):
        """The least value of `ask` in some open boxes, half of them those of least bound."""
        ranked = sorted(self.claims.boxes, key=lambda box: box[2])
        chosen = ranked[:(count + 1) // 2]
        chosen += self.drawn.sample(ranked[len(chosen):], min(len(ranked), count) - len(chosen))
        return [self.in_box(box) for box in chosen]

    def in_cell(self, starts, count):
        """From some placements down, and from the best of others that are drawn."""
        low, high = self.coordinates.low, self.coordinates.high
        ranked = []
        for _ in range(50 * count):
            at = [self.drawn.uniform(a, b) for a, b in zip(low, high)]
            placement = self.coordinates.placement(at)
            if placement is not None:
                ranked.append((self.relaxed.rough(placement), at))
        ranked = [at for value, at in sorted(ranked) if value < INFINITE]
        # A turn has no end.
        low, high = (*low[:2], 2 * low[2]), (*high[:2], 2 * high[2])
        for at, plan in starts + [(at, None) for at in ranked[:count]]:
            self.descend(at, low, high, 0.05, 60, plan)
        if self.least[1]:
            self.descend(self.coordinates.of(self.least[1]), low, high, 0.02, 150, self.least[2])


def inner(box):
    """The sides of a box less what rounding may have moved them. m, rad"""
    edges = (EDGE / 1e3, EDGE / 1e3, math.radians(EDGE))
    return [a + edge for a, edge in zip(box[0], edges)], [b - edge for b, edge in zip(box[1], edges)]


class Certificate:
    def __init__(self, run, results):
        table = json.loads((results / "certificate.json").read_text())
        proof = table["best"]
        if proof is None:
            raise Refused(f"a run without a bound of the best placement: {table['best_reason']}")
        for entry in table["inputs"]:
            file = run.files.get(entry["role"])
            if file is None:
                raise Refused(f"an input that is a {entry['role']}")
            if hashlib.sha256(file.read_bytes()).hexdigest() != entry["sha256"]:
                raise Refused(f"a certificate of another {file}")
        unknown = [words for words in proof["limits_relaxed"] if not re.fullmatch(RELAXED, words)]
        if unknown or proof["status"] == "segments_apart":
            raise Refused(f"a bound that leaves out: {', '.join(unknown) or 'that segments share a placement'}")
        place = proof["placement"]
        self.found = (*(place[key] / 1e3 for key in ("x_mm", "y_mm", "z_mm")), math.radians(place["yaw_deg"]))
        self.value, self.bound = proof["value_mm"] / 1e3, proof["bound_mm"] / 1e3
        self.gap, self.asked, self.status = [
            proof["gap_percent"] / 100, table["gap_percent_asked"] / 100, proof["status"]]
        # The rate of beta is kept alone where it is set.
        turn = run.turns if "turn of the spindle" not in proof["limits_relaxed"] else [None] * len(run.points)
        self.steps = run.rates if proof["with_beta_rate"] else turn
        self.boxes = []
        with open(results / "open-region.csv") as file:
            for row in csv.DictReader(file):
                if row["orientation"] or row["segment"]:
                    raise Refused("orientations, or segments that are bounded one by one")
                sides = [[float(row[f"{name}_{end}_{unit}"]) for name, unit in
                          (("radius", "mm"), ("z", "mm"), ("yaw_less_azimuth", "deg"))] for end in ("from", "to")]
                low, high = [(r / 1e3, z / 1e3, math.radians(turn)) for r, z, turn in sides]
                if row["search"] == "best":
                    self.boxes.append((low, high, float(row["bound_mm"] or "inf") / 1e3))
        self.stated_boxes = proof["open_boxes"]
        # Outside all open boxes nothing is better by more than the gap that was asked for.
        self.elsewhere = self.value * (1 - self.asked) * (1 - 1e-6)

    def contradictions(self):
        """Where it does not agree with itself."""
        least = min([box[2] for box in self.boxes], default=INFINITE)
        if self.bound > min(least, self.value) + 1e-10:
            yield "the bound is above that of an open box, or above the figure of the placement found"
        if self.gap < 1 - self.bound / self.value - 2e-6 - 2e-10 / self.value:
            yield "the gap stated is less than that between bound and figure"
        if self.stated_boxes != len(self.boxes):
            yield "the number of open boxes is not that of the table"
        if self.status == "reached" and (self.boxes or self.gap > self.asked + 2e-6):
            yield "the gap is said to be reached, and is not"


def stated_plan(run, results):
    """The plan in `best.csv`, where beta turns the other way."""
    with open(results / "best.csv") as file:
        rows = list(csv.DictReader(file))
    return [((int(rows[start]["posture"]) - 1) // 2, [-math.radians(float(row["beta_deg"])) for row in rows[start:end]])
            for start, end in run.spans]


def checked(run, results, certificate, count, seed):
    violations = list(certificate.contradictions())
    relaxed = Relaxed(run, certificate.steps)
    claims = Claims(certificate.boxes, certificate.elsewhere, certificate.bound)
    search = Search(relaxed, claims, seed)
    at = search.coordinates.of(certificate.found)
    value = certificate.value
    in_mm = lambda *figures: " ".join(f"{figure * 1e3:.7f}" for figure in figures)

    plan = stated_plan(run, results)
    stated = relaxed.confirmed(certificate.found, plan, slack=1e-5)
    print(f"placement found: {in_mm(value)} mm stated, {in_mm(stated)} by its plan computed anew")
    if not abs(stated - value) <= 1e-4 * value:
        violations.append(f"the plan found has {in_mm(stated)} mm, and {in_mm(value)} mm are stated")
    sought, plan = relaxed.figure(certificate.found, None, STEPS)
    print(f"its relaxed figure: {in_mm(sought)} mm, bound {in_mm(certificate.bound)} mm")
    if sought > 1.001 * value:
        print(f"note: paths of beta are not found to better than {100 * (sought / value - 1):.2f} % here")

    margins = search.in_boxes(count)
    if margins:
        shown = ", ".join(f"{100 * (margin - 1):.2f}" if margin < 100 else "more" for margin in sorted(margins))
        print(f"{len(margins)} of {len(certificate.boxes)} open boxes: least figure met above the bound of the box by "
              f"{shown} %")
    search.in_cell([(at, plan)], count)
    least, placement, _ = search.least
    above = f"{100 * (least / certificate.bound - 1):.2f} %" if certificate.bound > 0 else "infinitely much"
    print(f"least relaxed figure met in the cell: {in_mm(least)} mm, above the bound by {above}")
    plans = {certificate.found: "found", **({placement: "of least figure"} if least < sought * (1 - 1e-6) else {})}
    for one, name in plans.items():
        figure = run.figure(one)
        print(f"plan over a grid, with the limits of all joints, at the placement {name}: {in_mm(figure)} mm")
        allowed = claims.least_allowed(search.coordinates.of(one))
        if figure < allowed * (1 - 1e-6):
            search.violations.append((one, figure, allowed))
    search.violations.sort(key=lambda one: one[1] / one[2])
    if len(search.violations) > SHOWN:
        print(f"{len(search.violations)} violations, of which the {SHOWN} largest are shown")
    for placement, figure, allowed in search.violations[:SHOWN]:
        x, y, z = [f"{v * 1e3:.4f}" for v in placement[:3]]
        violations.append(f"x {x} y {y} z {z} mm, yaw {math.degrees(placement[3]):.4f} deg: {in_mm(figure)} mm, "
                          f"and at least {in_mm(allowed)} mm is stated")
    return violations


def known_least(relaxed, low, high):
    """The least relaxed figure in a box over lattices of 27 placements that become finer, by other means than the
    search that is tested. m"""
    coordinates = Coordinates(relaxed.run)
    middle, half = [0.5 * (a + b) for a, b in zip(low, high)], [0.5 * (b - a) for a, b in zip(low, high)]
    least = (INFINITE, middle, None)
    for level in range(4):
        origin = least[1]
        for number in range(27):
            corner = [number // 9 - 1, number // 3 % 3 - 1, number % 3 - 1]
            at = [min(b, max(a, v + s * h)) for v, s, h, a, b in zip(origin, corner, half, low, high)]
            placement = coordinates.placement(at)
            # All postures and paths at the corners and in the middle of the box.
            is_new = level == 0 and (0 not in corner or not any(corner))
            if placement is not None and (is_new or least[2]):
                figure, plan = relaxed.figure(placement, None if is_new else least[2])
                least = min(least, (figure, at, plan), key=lambda known: known[0])
        half = [0.5 * h for h in half]
    if least[2] is None:
        return INFINITE
    placement = coordinates.placement(least[1])
    figure, plan = relaxed.figure(placement, least[2], STEPS)
    return relaxed.confirmed(placement, plan)


def box_to_plant(coordinates, relaxed, boxes, drawn):
    """A box that is listed, or one made up in the cell, with its least figure."""
    while True:
        if boxes and drawn.random() < 0.5:
            box = drawn.choice(boxes)
        else:
            half = [drawn.uniform(0.002, 0.03), drawn.uniform(0.002, 0.03), math.radians(drawn.uniform(0.3, 3))]
            at = [drawn.uniform(a + h, b - h) for a, b, h in zip(coordinates.low, coordinates.high, half)]
            box = [v - h for v, h in zip(at, half)], [v + h for v, h in zip(at, half)], 0.0
        least = known_least(relaxed, *inner(box))
        if least < INFINITE:
            return box[0], box[1], least


def tested_itself(run, certificate, seeds, first):
    """Plants bounds that are 1 % too high; the number of those that were not seen."""
    relaxed, missed, results = Relaxed(run, certificate.steps), 0, []
    coordinates = Coordinates(run)
    at = coordinates.of(certificate.found)
    near = (0.05, 0.05, math.radians(5))
    low = [max(a, v - n) for a, v, n in zip(coordinates.low[:2], at, near)] + [at[2] - near[2]]
    high = [min(b, v + n) for b, v, n in zip(coordinates.high[:2], at, near)] + [at[2] + near[2]]
    in_cell = min(known_least(relaxed, low, high), relaxed.figure(certificate.found, None, STEPS)[0])
    for seed in range(first, first + seeds):
        low, high, least = box_to_plant(coordinates, relaxed, certificate.boxes, random.Random(seed))
        of_box = Search(relaxed, Claims([(low, high, 1.01 * least)], 0.0), seed, until_first=True)
        of_box.in_boxes(1)
        # The placement found is withheld.
        of_cell = Search(relaxed, Claims([], 1.01 * in_cell), seed, until_first=True)
        of_cell.in_cell([], 4)
        for name, search, least in (("box", of_box, least), ("cell", of_cell, in_cell)):
            seen = f"seen at {search.least[0] * 1e3:.7f} mm" if search.violations else "NOT SEEN"
            missed += not search.violations
            print(f"self-test {seed}: bound of a {name} planted at {1.01 * least * 1e3:.7f} mm, 1 % above the least "
                  f"known: {seen}", flush=True)
    print(f"self-test: {2 * seeds - missed} of {2 * seeds} bounds planted were seen")
    return missed


def main():
    arguments, seeds = sys.argv[1:], 0
    if arguments[:1] == ["--self-test"]:
        has_number = len(arguments) > 1 and arguments[1].isdigit()
        seeds = int(arguments[1]) if has_number else 2
        arguments = arguments[1 + has_number:]
    run, results = Run(Path(arguments[0])), Path(arguments[1])
    count = int(arguments[2]) if len(arguments) > 2 else 12
    seed = int(arguments[3]) if len(arguments) > 3 else 1
    certificate = Certificate(run, results)
    missed = tested_itself(run, certificate, seeds, seed) if seeds else 0
    violations = checked(run, results, certificate, count, seed)
    for violation in violations:
        print(f"violated: {violation}")
    print("no violation" if not violations else f"{len(violations)} violations")
    return 1 if violations or missed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Refused as reason:
        print(f"not covered by this checker: {reason}")
        sys.exit(2)
    except Contradiction as what:
        print(f"this checker contradicts itself: {what}")
        sys.exit(1)
