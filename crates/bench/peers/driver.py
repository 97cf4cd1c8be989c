"""The common part of all drivers in Python: reads commands and writes answers, line by line.

crates/bench/src/peers.rs defines the protocol. Standard output carries answers only; the output of the system itself
goes to standard error. Only `work` is timed.
"""

import os
import sys
from time import perf_counter, process_time

import numpy as np

# the requested clock
_clock = process_time if os.environ.get("RAYWEAVE_BENCH_CLOCK") == "processor" else perf_counter

# redirect the output of the system itself to standard error
_OUT = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def say(line):
    _OUT.write(line + "\n")
    _OUT.flush()


def padded(lists):
    """Lists of times as a hit array: (H, N), padded with +inf."""
    rows = max([len(times) for times in lists] + [1])
    table = np.full((rows, len(lists)), np.inf)
    for column, times in enumerate(lists):
        table[: len(times), column] = times
    return table


def seconds(work, argument, clock):
    """The time of one run; for short runs the mean of as many runs as the benchmark makes for Rust candidates."""
    started = clock()
    work(argument)
    once = clock() - started
    repeats = min(int(0.1 / max(once, 1e-6)), 1000)
    if repeats < 2:
        return once
    started = clock()
    for _ in range(repeats):
        work(argument)
    return (clock() - started) / repeats


def serve(name, version, tasks):
    """Executes commands until the end of the input.

    `tasks` maps the name of a task to (prepare, work, answer): `prepare(array, count)` makes the input of the first
    `count` rays from the array of the file and is not timed; `work(input)` is timed; `answer(input)` returns an array
    (H, N).
    """
    say(f"peer {name} {version} " + " ".join(tasks))
    prepared = {}
    for line in sys.stdin:
        verb, task, file, count, *rest = line.split()
        try:
            prepare, work, answer = tasks[task]
            key = (task, file, count)
            if key not in prepared:
                # keep one input at a time, because some are large
                prepared.clear()
                prepared[key] = prepare(np.load(file + ".npy"), int(count))
            if verb == "run":
                # wall-clock time, because processor times of threads add up
                clock = perf_counter if task.endswith("/all") else _clock
                say(f"seconds {seconds(work, prepared[key], clock)!r}")
            else:
                np.save(rest[0] + ".npy", np.ascontiguousarray(answer(prepared[key]), dtype=np.float64))
                say("done")
        except Exception as error:
            say("error " + repr(error).replace("\n", " "))


def rays(array, count):
    """Origins and directions, (N, 3) each, of an array (6, N)."""
    rows = np.ascontiguousarray(array[:, :count].T)
    return np.ascontiguousarray(rows[:, :3]), np.ascontiguousarray(rows[:, 3:])


def units(array, count):
    """The same with unit directions, and the original lengths: for systems that require unit directions."""
    origins, directions = rays(array, count)
    lengths = np.linalg.norm(directions, axis=1)
    return origins, directions / lengths[:, None], lengths
