"""Runs the programs named by the arguments in one process, which loads NumPy and matplotlib once."""

import runpy
import sys
import traceback

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot

paths, failed = sys.argv[1:], 0
for path in paths:
    sys.argv = [path]
    try:
        runpy.run_path(path, run_name="__main__")
    except BaseException:
        traceback.print_exc()
        print(f"example failed: {path}", flush=True)
        failed += 1
    pyplot.close("all")
sys.exit(failed > 0)
