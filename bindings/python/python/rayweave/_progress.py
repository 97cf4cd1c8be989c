"""The progress of long computations."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

#: Called with the finished work, such as a number of rays, and the total; True draws a bar on standard error.
Progress = Callable[[int, int], object] | bool | None


def reporter(progress: Progress) -> Callable[[int, int], object]:
    """The function to call with the finished work and the total."""
    if callable(progress):
        return progress
    return _Bar() if progress else lambda done, total: None


class _Bar:
    """A bar on standard error."""

    def __init__(self) -> None:
        self._begin = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        part = done / total if total else 1.0
        filled = round(30 * part)
        seconds = time.monotonic() - self._begin
        left = f"{seconds / part - seconds:.0f} s left" if 0 < part < 1 else f"{seconds:.1f} s"
        end = "\n" if done >= total else ""
        bar = "#" * filled + "-" * (30 - filled)
        print(f"\r[{bar}] {100 * part:3.0f} % {left}   ", end=end, file=sys.stderr, flush=True)


def callback(progress: Progress) -> Callable[[int, int], object] | None:
    """The function to call, if there is one."""
    return None if progress is None or progress is False else reporter(progress)
