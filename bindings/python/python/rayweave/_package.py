"""Modules of optional packages."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def package(name: str, what_for: str) -> Any:
    """A module of an optional package."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        root = name.split(".")[0]
        if error.name not in (root, name):
            raise
        problem = f"{root} is not installed: {what_for} need it. Run pip install {root}."
        raise ModuleNotFoundError(problem, name=root) from None
