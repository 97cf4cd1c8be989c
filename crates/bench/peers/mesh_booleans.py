"""Volumes of booleans of meshes by manifold3d: the rows of the table in crates/trace/tests/meshes/oracle.rs.

The meshes are made by the formulas of crates/trace/tests/meshes/shapes.rs, number by number.

    python crates/bench/peers/mesh_booleans.py
"""

import importlib.metadata
from math import cos, pi, sin, sqrt

import manifold3d as m
import numpy as np


def cuboid(lo, hi):
    corners = [[(hi if k >> axis & 1 else lo)[axis] for axis in range(3)] for k in range(8)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return corners, [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def torus(major, minor, rows, columns):
    points, triangles = [], []
    for i in range(rows):
        for j in range(columns):
            u, v = i / rows * 2 * pi, j / columns * 2 * pi
            rho = major + minor * cos(v)
            points.append([rho * cos(u), rho * sin(u), minor * sin(v)])
            at = lambda i, j: (i % rows) * columns + j % columns
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [[a, b, c], [a, c, d]]
    return points, triangles


def ball(times, radius):
    g = 0.5 * (1 + sqrt(5))
    points = []
    for k in range(12):
        a, b = (1 if k & 1 == 0 else -1), (g if k & 2 == 0 else -g)
        points.append(np.array([[0, a, b], [a, b, 0], [b, 0, a]][k >> 2], float))
    near = lambda a, b: abs(np.linalg.norm(points[a] - points[b]) - 2) < 1e-9
    triangles = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                if near(a, b) and near(b, c) and near(c, a):
                    p, q, r = points[a], points[b], points[c]
                    triangles.append([a, b, c] if np.cross(q - p, r - p) @ p > 0 else [a, c, b])
    for _ in range(times):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(0.5 * (points[a] + points[b]))
            return middles[key]

        for a, b, c in triangles:
            p, q, r = middle(a, b), middle(b, c), middle(c, a)
            finer += [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
        triangles = finer
    units = [p / np.linalg.norm(p) for p in points]
    return [radius(d) * d for d in units], triangles


def potato(times):
    return ball(times, lambda d: 1 + 0.3 * sin(5 * d[0] + 2 * d[1]) * cos(4 * d[2]))


def angle(points, triangles):
    """An L: a block without one of its quarters."""
    base = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    corners = [[x, y, z] for z in (0, 1) for x, y in base]
    lids = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    sides = [t for k in range(6) for t in ([k, (k + 1) % 6, (k + 1) % 6 + 6], [k, (k + 1) % 6 + 6, k + 6])]
    return corners, [[c, b, a] for a, b, c in lids] + [[a + 6, b + 6, c + 6] for a, b, c in lids] + sides


def moved(mesh, by, degrees=0.0, about=2):
    turn, k = degrees / 180 * pi, about
    out = []
    for p in np.array(mesh[0], float):
        q, i, j = p.copy(), (k + 1) % 3, (k + 2) % 3
        q[i], q[j] = cos(turn) * p[i] - sin(turn) * p[j], sin(turn) * p[i] + cos(turn) * p[j]
        out.append(q + np.array(by, float))
    return out, mesh[1]


CUBE = cuboid([0, 0, 0], [1, 1, 1])
SMALL = cuboid([0, 0, 0], [0.5, 0.5, 0.5])
BALL = ball(3, lambda d: 0.7)
RING = torus(1.0, 0.4, 32, 16)
ANGLE = angle([], [])

PAIRS = [
    ("cubes shifted along the diagonal", CUBE, moved(CUBE, [0.5, 0.5, 0.5])),
    ("cubes shifted along x: four faces in common planes", CUBE, moved(CUBE, [0.5, 0, 0])),
    ("cubes side by side: a face in common", CUBE, moved(CUBE, [1, 0, 0])),
    ("a cube in the corner of a cube: three faces in common", CUBE, SMALL),
    ("a cube turned about z: top and bottom in common planes", CUBE, moved(CUBE, [0.5, -0.2, 0], 45)),
    ("a cube and a ball about its middle", CUBE, moved(BALL, [0.5, 0.5, 0.5])),
    ("a cube and a ball about its corner", CUBE, BALL),
    ("a ring and a cube", RING, CUBE),
    ("two rings as in a chain", RING, moved(RING, [1, 0, 0], 90, 0)),
    ("two balls", BALL, moved(BALL, [0.5, 0.1, 0.2])),
    ("a ball and itself", BALL, BALL),
    ("a ball in a ring", RING, BALL),
    ("a potato and a cube", potato(3), CUBE),
    ("a potato and a ring", potato(3), RING),
    ("a cube within a cube", CUBE, moved(SMALL, [0.25, 0.25, 0.25])),
    ("a ball and a cube that do not meet", BALL, moved(CUBE, [3, 0, 0])),
    ("an L and what fills it: two faces and two planes in common", ANGLE, moved(CUBE, [1, 1, 0])),
    ("an L and a cube across its edge", ANGLE, moved(CUBE, [0.5, 0.5, 0.5])),
    ("a potato turned against itself", potato(3), moved(potato(3), [0.1, 0, 0], 30)),
    ("a cube on a plate: part of a face in common", cuboid([0, 0, 0], [3, 2, 0.5]), moved(CUBE, [1, 0.5, 0.5])),
]


def manifold(mesh):
    points, triangles = (np.array(mesh[0], np.float64), np.array(mesh[1], np.uint64))
    solid = m.Manifold(m.Mesh64(points, triangles))
    assert solid.status() == m.Error.NoError and solid.volume() > 0, solid.status()
    return solid


print(f"// manifold3d {importlib.metadata.version('manifold3d')}")
for name, a, b in PAIRS:
    a, b = manifold(a), manifold(b)
    print(f'    ("{name}", [{(a + b).volume():.12}, {(a ^ b).volume():.12}, {(a - b).volume():.12}]),')
