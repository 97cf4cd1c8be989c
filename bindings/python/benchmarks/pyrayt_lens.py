"""Rays per second through a biconvex lens, compared with PyRayT's `intersect`: hits and surfaces, checks included.

    python pyrayt_lens.py PYTHON_OF_PYRAYT [RAYS ...]

PyRayT 0.3.1 needs a Python of its own (3.8):

    python3.8 -m venv peer && peer/bin/pip install pyrayt==0.3.1 'numpy<2' 'pandas<2' 'scipy<1.12'

The two run alternately on the same rays, and the minimum time of each is reported. The last line is JSON.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

ROUNDS = 5


def least_time(work, rounds):
    """The minimum time of several rounds, in seconds."""
    times = []
    for _ in range(rounds):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def serve():
    """The process with PyRayT: for each input line, a file of rays (2, 4, N), prints the seconds and writes the hits to
    a file."""
    import tinygfx.g3d as cg

    front, back = cg.Sphere(50.0).move_z(48.0), cg.Sphere(50.0).move_z(-48.0)
    rim = cg.Cylinder(radius=12.0, min_height=-10.0, max_height=10.0)
    lens = cg.csg.intersect(cg.csg.intersect(front, back), rim)
    for line in sys.stdin:
        path = line.strip()
        rays = np.load(path)
        seconds = least_time(lambda: lens.intersect(rays), 1)
        np.save(path, np.sort(lens.intersect(rays)[0], axis=0)[:2])
        print(seconds, flush=True)


def beam(count):
    """Rays of a wide, slightly inclined beam, all of which pass through the lens."""
    rng = np.random.default_rng(1)
    angle, radius = rng.uniform(0, 2 * np.pi, count), 11 * np.sqrt(rng.uniform(size=count))
    through = np.stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)), axis=1)
    directions = rng.normal(scale=0.02, size=(count, 3)) + [0, 0, 1]
    return through - 100 * directions, directions


def compare(peer, count):
    """Rays per second of both, and whether they agree."""
    import rayweave as rw

    lens = rw.sphere(50).translate([0, 0, 48]) & rw.sphere(50).translate([0, 0, -48]) & rw.cylinder(12, 20)
    origins, directions = beam(count)
    columns = np.zeros((2, 4, count))
    columns[0, :3], columns[0, 3], columns[1, :3] = origins.T, 1, directions.T
    out = np.empty((2, count)), np.empty((2, count), np.int32)
    calls = {
        "one thread": lambda: lens.hits(origins, directions, return_surfaces=True, threads=1),
        "all cores": lambda: lens.hits(origins, directions, return_surfaces=True),
        "all cores, given arrays": lambda: lens.hits(origins, directions, return_surfaces=True, out=out),
    }
    best = dict.fromkeys(("PyRayT", *calls), np.inf)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "rays.npy")
        for _ in range(ROUNDS):
            np.save(path, columns)
            peer.stdin.write(path + "\n")
            peer.stdin.flush()
            best["PyRayT"] = min(best["PyRayT"], float(peer.stdout.readline()))
            for name, call in calls.items():
                best[name] = min(best[name], least_time(call, 3))
        theirs = np.load(path)
    ours = lens.hits(origins, directions)
    agree = np.isclose(ours, theirs, rtol=0, atol=1e-9).all(axis=0).mean()
    return {name: count / seconds for name, seconds in best.items()}, agree


def main(python, counts):
    """Prints the comparison."""
    results = []
    with subprocess.Popen([python, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as peer:
        for count in counts:
            rates, agree = compare(peer, count)
            for name, rate in rates.items():
                print(f"{count} rays: {name}: {rate / 1e6:.2f} Mray/s, {rate / rates['PyRayT']:.0f} x")
            print(f"{count} rays: the same hits for {agree:.4%}")
            results.append({"rays": count, "rays_per_second": rates, "agree": agree})
    print(json.dumps(results))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1], [int(float(text)) for text in sys.argv[2:]] or [100_000, 1_000_000])
    else:
        serve()
