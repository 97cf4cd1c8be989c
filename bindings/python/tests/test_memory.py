"""Queries whose results do not fit into memory raise an exception and do not end the process."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the limit of a process is that of Linux")

# a gigabyte more than the modules need
PRELUDE = """
import resource
import numpy as np
import rayweave
import rayweave.optics as ro
used = next(int(line.split()[1]) << 10 for line in open("/proc/self/status") if line.startswith("VmSize"))
resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 30), used + (1 << 30)))

def plates(count):
    plate = lambda k: ro.element(rayweave.box([9, 9, 0.5]).translate([0, 0, k]), 1.9, name=f"plate {k}")
    return ro.System([plate(k) for k in range(count)])

def comb():
    teeth = [[[k, 0], [k + 0.5, 0], [k + 0.5, 1], [k, 1]] for k in range(1000)]
    return rayweave.from_polygons(np.array(teeth, float))

def refused(call):
    try:
        call()
    except (rayweave.RayweaveError, MemoryError) as error:
        print(type(error).__name__, error)
"""

CASES = {
    "rays of a source": (
        "plates(1).trace([ro.beam(1.0, 10**15)], threads=1)",
        "RayweaveError the segments of 1000000000000000 rays cannot be kept: ",
    ),
    "segments": (
        "plates(1).trace([ro.beam(1.0, 10**9).translate([0, 0, -5])], keep_escaped=False, threads=1)",
        "RayweaveError the segments of 1000000000 rays cannot be kept: ",
    ),
    "branches": (
        "plates(5).trace([ro.beam(1.0, 8).translate([0, 0, -5])], branches='both', threads=1)",
        "RayweaveError the segments of 8 rays cannot be kept: ",
    ),
    "batches": (
        "next(iter(plates(1).stream([ro.beam(1.0, 10**9).translate([0, 0, -5])], rows=10**12, threads=1)))",
        "RayweaveError the segments of 1000000000 rays cannot be kept: ",
    ),
    "traces of infill": ("rayweave.infill(comb(), 1e-6, threads=1)", "RayweaveError the traces do not fit into memory: "),
    "repeated rays": (
        "rayweave.sphere(1).hits(np.broadcast_to([0.0, 0, -5], (10**12, 3)), [0, 0, 1])",
        "",
    ),
    "points": (
        "ro.source_of_rays(np.broadcast_to([0.0, 0, -5], (10**12, 3)), np.broadcast_to([0.0, 0, 1], (10**12, 3)))",
        "MemoryError not enough memory for ",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_results_that_do_not_fit_into_memory_are_refused(name):
    call, message = CASES[name]
    script = f"{PRELUDE}\nrefused(lambda: {call})"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(message) and done.stdout, done.stdout
