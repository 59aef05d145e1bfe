"""Checks a certificate by other means: `python3 tests/certificate/check.py RUN.toml RESULTS [PLACEMENTS [SEED]]`.

RESULTS is the folder that `stead place RUN.toml --certify GAP --out RESULTS` wrote. Everything else is read from the
run file, the robot file and the task; nothing of stead is used, and only the standard library of Python 3.11.

A plan of a placement is made by dynamic programming over a grid of the free angle and all eight postures, with the
limits that the certificate says it keeps (reach, joints, conditioning, and the rate of the free angle or the turn of
the spindle where they are set). It is one of the plans that the certificate is about, so its figure may not be below
the bound: of the whole cell, or of the open box that the placement is in, and outside all open boxes not better than
the placement found by more than the gap. That is asked at

- the placement found, whose figure must also be the one that stead states, up to the grid;
- PLACEMENTS (12) placements: a third drawn from the cell, a third from the open boxes, and a third by descent from
  the placement found and from where the figure was least so far.

Ends with 1 and a line for each violation. `check.py --self-test RUN RESULTS` first raises the bound to where it is
wrong (6 % above the figure) and must see it.

Covered: upright arms of six rows with a spherical wrist, a tool axis that is the same at every point, wall and total,
mean, force errors, compliances that are constant or linear in the angle. Anything else is refused.
"""

import csv
import json
import math
import random
import sys
import tomllib
from pathlib import Path

GRID = 120  # values of the free angle
INFINITE = float("inf")


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def norm(a):
    return math.sqrt(dot(a, a))


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


class Refused(Exception):
    """What this checker does not cover."""


class Robot:
    def __init__(self, table):
        if table.get("stiffness_model") == "full":
            raise Refused("a full arm")
        self.rows = table["joints"]
        if len(self.rows) != 6:
            raise Refused("an arm without six rows")
        self.alpha = [math.radians(row["alpha_deg"]) for row in self.rows]
        self.a = [row["a_mm"] / 1e3 for row in self.rows]
        self.d = [row["d_mm"] / 1e3 for row in self.rows]
        self.limits = [(math.radians(row["min_deg"]), math.radians(row["max_deg"])) for row in self.rows]
        self.signs = [round(math.sin(angle)) for angle in self.alpha]
        if any(abs(row.get("offset_deg", 0.0)) > 0 for row in self.rows):
            raise Refused("joint offsets")

    def compliance(self, joint, theta):
        row = self.rows[joint]
        low, high = self.limits[joint]
        if "stiffness_mnm_per_rad" in row:
            value = row["stiffness_mnm_per_rad"]
            if isinstance(value, list):
                raise Refused("a range of stiffness")
            return 1e-6 / value
        value = row.get("compliance_urad_per_nm")
        if value is None:
            raise Refused(f"no compliance of joint {joint + 1}")
        if isinstance(value, list):
            return 1e-6 * (value[0] + (value[1] - value[0]) * (theta - low) / (high - low))
        return 1e-6 * value

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

    def within(self, theta):
        """The angles with whole turns added, within the limits; None where there are none."""
        out = []
        for value, (low, high) in zip(theta, self.limits):
            value -= 2 * math.pi * math.floor((value - low + 1e-9) / (2 * math.pi))
            if value > high + 1e-9:
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
    def __init__(self, file):
        table = tomllib.loads(file.read_text())
        for key in ("mount", "external_axis", "base_compliance", "part_compliance", "orientations"):
            if key in table:
                raise Refused(f"[{key}]")
        if set(table.get("postures", {})) - {"tie_percent"}:
            raise Refused("[postures]")
        self.robot = Robot(tomllib.loads((file.parent / table["robot"]).read_text()))
        rows = list(csv.DictReader((file.parent / table["task"]).read_text().splitlines()))
        known = "segment x_mm y_mm z_mm feed_x feed_y feed_z axis_x axis_y axis_z force_x_n force_y_n force_z_n"
        if set(rows[0]) != set(known.split()):
            raise Refused("these columns of the task")
        number = lambda row, *names: tuple(float(row[name]) for name in names)
        self.segments = [row["segment"] for row in rows]
        self.points = [tuple(x / 1e3 for x in number(row, "x_mm", "y_mm", "z_mm")) for row in rows]
        self.feeds = [number(row, "feed_x", "feed_y", "feed_z") for row in rows]
        self.axes = [number(row, "axis_x", "axis_y", "axis_z") for row in rows]
        if any(norm(minus(axis, self.axes[0])) > 1e-9 for axis in self.axes):
            raise Refused("a tool axis that changes along the path")
        self.forces = [number(row, "force_x_n", "force_y_n", "force_z_n") for row in rows]
        spindle = table["spindle"]
        if "mount_matrix" in spindle or "tip_um_per_n" in spindle:
            raise Refused("a spindle that yields")
        self.tool_at = tuple(x / 1e3 for x in spindle["xyz_mm"])
        turn = [tuple(map(float, row)) for row in spindle["rotation"]]
        # Rotations are given with few digits: made orthonormal.
        z = tuple(x / norm(turn_z) for turn_z in [tuple(row[2] for row in turn)] for x in turn_z)
        x = tuple(row[0] for row in turn)
        x = minus(x, tuple(dot(x, z) * c for c in z))
        x = tuple(c / norm(x) for c in x)
        self.tool_turn = transposed((x, cross(z, x), z))
        self.cell = [tuple(v / 1e3 for v in table["cell"][key]) for key in ("x_mm", "y_mm", "z_mm")]
        q4 = table["cell"].get("q4", [-1.0, 1.0])
        self.yaw = tuple(2 * math.asin(v) for v in q4)
        self.least = table["constraints"].get("min_inverse_condition", 0.0)
        self.length = table["constraints"].get("characteristic_length_mm", 682.0) / 1e3
        criterion = table.get("criterion", {})
        self.direction = criterion.get("direction", "wall")
        self.errors = criterion.get("force_uncertainty", 0.0)
        if self.direction not in ("wall", "total") or set(criterion) - {"direction", "force_uncertainty"}:
            raise Refused("this criterion")
        limits = table.get("redundancy", {})
        self.rate = limits.get("max_beta_rate_deg_per_mm")
        self.turn = limits.get("max_spindle_turn_deg_per_mm")

    def score(self, force, normal, velocities, compliances):
        """The deflection that counts. m"""
        def moved(f):
            parts = [k * dot(v, f) for v, k in zip(velocities, compliances)]
            return tuple(sum(p * v[c] for p, v in zip(parts, velocities)) for c in range(3))

        size = self.errors * norm(force)
        if self.direction == "wall":
            return abs(dot(moved(force), normal)) + size * norm(moved(normal))
        total = moved(force)
        for _ in range(30 if size else 0):
            # The worst error lies along C C (f + e).
            along = moved(total)
            by = size / max(norm(along), 1e-300)
            total = moved(tuple(f + by * x for f, x in zip(force, along)))
        return norm(total)

    def states(self, placement, point):
        """Of each value of the free angle the heading of the spindle and the scores by posture."""
        x, y, z, yaw = placement
        about = about_z(yaw)
        tip = tuple(a + b for a, b in zip(times(about, self.points[point]), (x, y, z)))
        feed, axis = times(about, self.feeds[point]), times(about, self.axes[point])
        side = cross(axis, feed)
        side = tuple(c / norm(side) for c in side)
        feed = cross(side, axis)
        base_point = transposed((feed, side, axis))
        force = times(about, self.forces[point])
        out = []
        for step in range(GRID):
            turned = product(product(base_point, about_x(math.pi)), about_z(2 * math.pi * step / GRID))
            rotation = product(turned, transposed(self.tool_turn))
            at = minus(tip, times(rotation, self.tool_at))
            scores = [INFINITE] * 8
            for posture, theta in self.robot.inverse(at, rotation):
                scores[posture] = self.of(theta, tip, force, side)
            out.append(scores)
        return out

    def of(self, theta, tip, force, normal):
        real = self.robot.within(theta)
        if real is None:
            return INFINITE
        frames = self.robot.frames(theta)
        axes = [tuple(row[2] for row in rotation) for _, rotation in frames]
        velocities = [cross(z, minus(tip, at)) for z, (at, _) in zip(axes, frames)]
        if inverse_condition([v + z for v, z in zip(velocities, axes)], self.length) < self.least:
            return INFINITE
        compliances = [self.robot.compliance(j, value) for j, value in enumerate(real)]
        return self.score(force, normal, velocities, compliances)

    def figure(self, placement):
        """The mean of the best plan over the grid. m"""
        total, start = 0.0, 0
        while start < len(self.points):
            end = start
            while end < len(self.points) and self.segments[end] == self.segments[start]:
                end += 1
            best = None
            for point in range(start, end):
                states = self.states(placement, point)
                if best is None:
                    best = states
                    continue
                best = [
                    [self.least_before(best, step, posture, point) + score for posture, score in enumerate(scores)]
                    for step, scores in enumerate(states)
                ]
            least = min(min(row) for row in best)
            if least == INFINITE:
                return INFINITE
            total, start = total + least, end
        return total / len(self.points)

    def least_before(self, best, step, posture, point):
        length = norm(minus(self.points[point], self.points[point - 1])) * 1e3
        grid = 360 / GRID
        middle = 0.0
        if self.rate is not None:
            reach = self.rate * length
        elif self.turn is not None:
            # The spindle turns with the feed, less the free angle, whose sign is that of Rx(pi).
            reach = self.turn * length
            axis = self.axes[point]
            before, here = (minus(f, tuple(dot(f, axis) * c for c in axis))
                            for f in (self.feeds[point - 1], self.feeds[point]))
            middle = math.degrees(math.atan2(dot(cross(before, here), axis), dot(before, here)))
        else:
            reach = 180.0
        low, high = math.ceil((middle - reach) / grid - 1e-9), math.floor((middle + reach) / grid + 1e-9)
        if high - low >= GRID:
            low, high = 0, GRID - 1
        return min((best[(step - k) % GRID][posture] for k in range(low, high + 1)), default=INFINITE)


def checked(run, results, count, seed, raised=None):
    proof = json.loads((results / "certificate.json").read_text())["best"]
    if proof is None:
        raise Refused("a run without a bound of the best placement")
    place = proof["placement"]
    found = (place["x_mm"] / 1e3, place["y_mm"] / 1e3, place["z_mm"] / 1e3, math.radians(place["yaw_deg"]))
    value, bound = proof["value_mm"] / 1e3, proof["bound_mm"] / 1e3
    if raised:
        bound = value * raised
    boxes = []
    with open(results / "open-region.csv") as file:
        for row in csv.DictReader(file):
            if row["search"] == "best":
                keys = [key for key, text in row.items() if key not in ("search", "orientation", "segment") and text]
                boxes.append({key: float(row[key]) for key in keys})
    closed = bound
    asked = json.loads((results / "certificate.json").read_text())["gap_percent_asked"] / 100
    if not raised:
        closed = value * (1 - asked) * (1 - 1e-6)

    a0 = run.robot.a[0]
    violations = []

    def least_allowed(placement):
        """What no plan of a placement may be below. m"""
        x, y, z, yaw = placement
        radius, azimuth = math.hypot(x - a0, y) * 1e3, math.atan2(y, x - a0)
        turn = math.degrees(yaw - azimuth)
        inside = []
        for box in boxes:
            middle = 0.5 * (box["yaw_less_azimuth_from_deg"] + box["yaw_less_azimuth_to_deg"])
            half = 0.5 * (box["yaw_less_azimuth_to_deg"] - box["yaw_less_azimuth_from_deg"])
            off = abs((turn - middle + 180) % 360 - 180)
            if (box["radius_from_mm"] <= radius <= box["radius_to_mm"] and box["z_from_mm"] <= z * 1e3 <= box["z_to_mm"]
                    and off <= half):
                inside.append(box["bound_mm"] / 1e3)
        # Outside all open boxes nothing is better by more than the gap that was asked for.
        return max(bound, min(inside) if inside else closed)

    def ask(placement):
        figure = run.figure(placement)
        if figure < least_allowed(placement) * (1 - 1e-6):
            violations.append((placement, figure, least_allowed(placement)))
        return figure

    own = ask(found)
    print(f"found: {own * 1e3:.5f} mm by the grid, {value * 1e3:.5f} mm stated, bound {bound * 1e3:.5f} mm")
    if not (value * (1 - 1e-4) <= own <= value * 1.05):
        violations.append((found, own, value))
    drawn = random.Random(seed)
    best = (own, found)
    ranges = [*run.cell, run.yaw]
    for k in range(count if not raised else 0):
        if k % 3 == 0:
            placement = tuple(drawn.uniform(low, high) for low, high in ranges)
        elif k % 3 == 1 and boxes:
            box = drawn.choice(boxes)
            radius, turn = [drawn.uniform(box[f"{name}_from_{unit}"], box[f"{name}_to_{unit}"])
                            for name, unit in (("radius", "mm"), ("yaw_less_azimuth", "deg"))]
            azimuth = math.atan2(found[1], found[0] - a0)
            z = drawn.uniform(box["z_from_mm"], box["z_to_mm"]) / 1e3
            placement = (a0 + radius / 1e3 * math.cos(azimuth), radius / 1e3 * math.sin(azimuth), z,
                         math.radians(turn) + azimuth)
            if any(not low - 1e-9 <= v <= high + 1e-9 for v, (low, high) in zip(placement[:3], run.cell)):
                continue
        else:
            size = 0.1 * 0.5 ** (k / 6)
            placement = tuple(min(high, max(low, v + size * (high - low) * drawn.uniform(-1, 1)))
                              for v, (low, high) in zip(best[1], ranges))
        figure = ask(placement)
        if figure < best[0]:
            best = (figure, placement)
    return violations


def main():
    arguments = sys.argv[1:]
    test_itself = arguments[:1] == ["--self-test"]
    arguments = arguments[test_itself:]
    run, results = Run(Path(arguments[0])), Path(arguments[1])
    count = int(arguments[2]) if len(arguments) > 2 else 12
    seed = int(arguments[3]) if len(arguments) > 3 else 1
    if test_itself and not checked(run, results, 0, seed, raised=1.06):
        print("a bound above the figure is not seen")
        return 1
    violations = checked(run, results, count, seed)
    for placement, figure, least in violations:
        print(f"violated at {placement}: {figure * 1e3:.6f} mm, and at least {least * 1e3:.6f} mm was stated")
    print("no violation" if not violations else f"{len(violations)} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Refused as reason:
        print(f"not covered by this checker: {reason}")
        sys.exit(2)
