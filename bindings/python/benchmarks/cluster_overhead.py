"""Overhead of long runs that are divided into parts: the processor time of all parts and of their merge, relative to one run.

    python cluster_overhead.py RAYWEAVE [--parts 1 2 4 8] [--repeat 3] [--scale 1] [--only NAME ...]

RAYWEAVE is the path of the `rayweave` command; the rays are traced with the installed package. Each part is a process with one
thread, and all parts of a run start together. Processor time counts everything: start, reading and compiling of the model, the
work, the writing of parts, and the merge. Of several runs, the one with the least time counts; whole runs and runs in parts
alternate. A whole run is a single part. `--scale` multiplies the sizes of all runs. Output: a Markdown table.
"""

import argparse
import datetime
import os
import platform
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import photon_detectors

MODELS = Path(__file__).resolve().parents[3] / "models"

#: A process that traces a range of random rays through the die, a million at a time, and writes the number of hits to a file.
RAYS = """
import sys
import numpy as np
import rayweave as rw

first, last, out = int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
solid = rw.load(sys.argv[1]).regions[0].solid
hits = 0
for start in range(first, last, 1_000_000):
    size = min(1_000_000, last - start)
    random = np.random.Generator(np.random.Philox(start))
    origins = random.uniform(-2, 2, (size, 3))
    hits += int(np.isfinite(solid.nearest(origins, -origins, threads=1).t).sum())
open(out, "w").write(str(hits))
"""


class Run:
    """A run of `total` items that `part` computes between two numbers, in multiples of `step`."""

    def __init__(self, name, total, step, part, merge):
        self.name, self.total, self.step, self.part, self.merge = name, total, step, part, merge

    def ranges(self, parts):
        """The ranges of a number of parts of equal length."""
        ends = [self.total * k // parts // self.step * self.step for k in range(parts)] + [self.total]
        return list(zip(ends, ends[1:]))


def runs(rayweave, folder, scale):
    """All runs; their files are in `folder`."""
    (crystals,) = [row for row in photon_detectors.write(folder) if row[0] == "crystals"]
    _, detector, wavelength, at = crystals
    script = folder / "rays.py"
    script.write_text(RAYS)

    def by_command(name, total, ending, *arguments):
        command = [str(rayweave), *map(str, arguments), "--threads", "1", "--quiet"]

        def part(first, last, out):
            return [*command, "--range", f"{first}:{last}", "-o", f"{out}{ending}"]

        def merge(outs, whole):
            return [str(rayweave), "merge", *[f"{out}{ending}" for out in outs], "-o", f"{whole}{ending}"]

        return Run(name, total, 1, part, merge)

    def rays(first, last, out):
        return [sys.executable, str(script), str(MODELS / "die.toml"), str(first), str(last), out]

    def add(outs, whole):
        return [sys.executable, "-c", f"print(sum(int(open(out).read()) for out in {outs}), file=open({whole!r}, 'w'))"]

    count, rows, traced, photons = (max(64, int(size * scale)) for size in (1e8, 2160, 2e7, 1e7))
    volume = ["volume", MODELS / "gear.toml", "--total", traced]
    cells = cells_of([str(rayweave), *map(str, volume)], folder)
    point = ["--at", ",".join(map(str, at)), "--wavelength", wavelength, "-n", photons, "--seed", 1]
    return [
        Run(f"{count:,} rays, nearest hits of the die", count, 1_000_000, rays, add),
        by_command(f"picture of the lens, 3840 x {rows}", rows, ".png", "render", MODELS / "lens.toml", "--size", f"3840x{rows}"),
        by_command(f"volumes of the gear, {traced:,} rays", cells, ".sums", *volume),
        by_command(f"{photons:,} photons in crystals", photons, ".npy", "photons", detector, *point),
    ]


def cells_of(volume, folder):
    """The number of cells of a call of `volume`, which the error about a range that is too long names."""
    call = [*volume, "--range", f"0:{2**34}", "-o", str(folder / "none.sums")]
    message = subprocess.run(call, capture_output=True, text=True).stderr
    return int(re.search(r"rays are (\d+) cells", message)[1])


def processor_time(calls):
    """Starts all calls together, waits, and returns their processor time in seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    processes = [subprocess.Popen(call, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for call in calls]
    for process in processes:
        _, message = process.communicate()
        if process.returncode != 0:
            sys.exit(f"{' '.join(process.args)}: {message.decode()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(run, parts, folder):
    """The processor time in seconds of a run in parts, with the merge unless there is one part."""
    outs = [str(folder / f"part{number}") for number in range(parts)]
    seconds = processor_time([run.part(first, last, out) for (first, last), out in zip(run.ranges(parts), outs)])
    if parts > 1:
        seconds += processor_time([run.merge(outs, str(folder / "whole"))])
    return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rayweave", type=Path)
    parser.add_argument("--parts", type=int, nargs="+", default=[2, 4, 8])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--scale", type=float, default=1)
    parser.add_argument("--only", nargs="+", default=[""])
    asked = parser.parse_args()
    print(f"{datetime.date.today()}, {platform.processor() or platform.machine()}, {os.cpu_count()} logical CPUs\n")
    print("| run | one process, s |" + "".join(f" {parts} parts |" for parts in asked.parts))
    print("| --- | ---: |" + " ---: |" * len(asked.parts))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for run in runs(asked.rayweave.resolve(), folder, asked.scale):
            if not any(word in run.name for word in asked.only):
                continue
            numbers = [1, *asked.parts]
            rounds = [[measure(run, parts, folder) for parts in numbers] for _ in range(asked.repeat)]
            whole, *divided = [min(times) for times in zip(*rounds)]
            cells = "".join(f" {100 * (time / whole - 1):+.1f} % |" for time in divided)
            print(f"| {run.name} | {whole:.1f} |{cells}", flush=True)


if __name__ == "__main__":
    main()
