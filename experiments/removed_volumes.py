"""Exact volumes that paths remove of their stock, by Booleans of meshes: the constants of
crates/removal/src/forces/tests/volumes.rs.

    python3 -m venv venv && venv/bin/pip install manifold3d numpy
    venv/bin/python experiments/removed_volumes.py

A move sweeps the hull of the cutter at both of its ends, in small parts where the tool axis turns. The cutters are
turned of polygons whose area is that of their circles. Nothing else needs this file.
"""

import math

import manifold3d
import numpy as np
from manifold3d import CrossSection, Manifold, OpType

AROUND = 360  # corners of a circle
ARC = 48  # chords of a corner
HEIGHT = 60.0  # of a cutter with its shank, mm
TURN = math.radians(0.1)  # of a part of a move


def cutter(diameter, corner=0.0, taper=0.0):
    """A flat, bull, ball or tapered cutter from its tip up along z."""
    radius = diameter / 2
    taper = math.radians(taper)
    # Chords of the corner as long in area as its arc.
    outside = corner * (1 + ((math.pi / 2 - taper) / ARC) ** 2 / 12)
    outline = [(0.0, 0.0)]
    for k in range(ARC + 1):
        angle = (math.pi / 2 - taper) * k / ARC
        r = corner if k in (0, ARC) else outside
        outline.append((radius - corner + r * math.sin(angle), corner - r * math.cos(angle)))
        if corner == 0:
            break
    r, h = outline[-1]
    outline += [(r + (HEIGHT - h) * math.tan(taper), HEIGHT), (0.0, HEIGHT)]
    step = 2 * math.pi / AROUND
    wider = math.sqrt(step / math.sin(step))
    return Manifold.revolve(CrossSection([[(r * wider, h) for r, h in outline]]), AROUND)


def placed(tool, at, axis):
    """The cutter with its tip at a place and its axis along a direction."""
    z = np.array(axis, float) / np.linalg.norm(axis)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    return tool.transform(np.column_stack([x, np.cross(z, x), z, np.array(at, float)]))


def swept(tool, knots):
    """What a path through places with axes sweeps: TCP straight, axis turning evenly."""
    parts = []
    for (a, u), (b, v) in zip(knots, knots[1:]):
        u, v = (np.array(w, float) / np.linalg.norm(w) for w in (u, v))
        angle = math.atan2(np.linalg.norm(np.cross(u, v)), u @ v)
        count = max(1, math.ceil(angle / TURN))

        def pose(k):
            s = k / count
            axis = u if angle == 0 else (math.sin((1 - s) * angle) * u + math.sin(s * angle) * v) / math.sin(angle)
            return placed(tool, np.array(a) * (1 - s) + np.array(b) * s, axis)

        parts += [Manifold.batch_hull([pose(k), pose(k + 1)]) for k in range(count)]
    return Manifold.batch_boolean(parts, OpType.Add)


def box(low, high):
    return Manifold.cube([b - a for a, b in zip(low, high)]).translate(low)


def prism(outline, holes, low, high):
    """A prism along z of an outline (anticlockwise) with holes (clockwise)."""
    return CrossSection([outline, *holes]).extrude(high - low).translate([0, 0, low])


UP = (0, 0, 1)
LEAD = (math.sin(math.radians(15)), -0.1, math.cos(math.radians(15)))


def leaning(x):
    """The axis of the swarf cut."""
    return (0.0, math.sin(math.radians(0.25 * x)), math.cos(math.radians(0.25 * x)))


def shapes():
    corner = [((-70, -20, -5), UP), ((20, -20, -5), UP), ((20, 45, -5), UP)]
    yield "flat, a corner in a box", box([-60, -40, -15], [60, 40, 0]), [(cutter(16), corner)]
    lying = Manifold.cylinder(80, 30 * math.sqrt((2 * math.pi / 720) / math.sin(2 * math.pi / 720)), -1, 720)
    lying = lying.rotate([-90, 0, 0]).translate([0, -40, -30])
    raster = [[((-25, y, -3), LEAD), ((25, y, -3), LEAD)] for y in (-6, -3, 0)]
    yield "ball, three leaning lines over a cylinder", lying, [(cutter(10, 5), line) for line in raster]
    ramp = [((-45, 3, 2), UP), ((35, 3, -7), UP), ((35, -25, -7), UP)]
    yield "bull nose, a ramp into a box", box([-60, -40, -15], [60, 40, 0]), [(cutter(12, 2), ramp)]
    ell = prism([(-40, -30), (40, -30), (40, -5), (0, -5), (0, 30), (-40, 30)], [], -20, 0)
    across = [((-50, -35, -6), UP), ((50, 20, -6), UP)]
    yield "tapered ball, across a mesh like an L", ell, [(cutter(4, 2, 10), across)]
    frame = prism([(-50, -30), (50, -30), (50, 0), (-50, 0)], [[(-15, -22), (-15, -2), (20, -2), (20, -22)]], 2, 22)
    wall = [((x, -3.0, 0.0), leaning(x)) for x in range(-56, 57, 4)]
    yield "swarf, five axes, along a mesh with a hole", frame, [(cutter(12), wall)]


if __name__ == "__main__":
    print("manifold3d", getattr(manifold3d, "__version__", ""))
    for name, stock, cuts in shapes():
        removed = Manifold.batch_boolean([swept(tool, knots) for tool, knots in cuts], OpType.Add)
        print(f"{name:48} {(stock ^ removed).volume():.3f} mm3 of {stock.volume():.3f}")
