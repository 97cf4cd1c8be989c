"""Pickling of objects by the calls that made them: the same calls give the same bits in another process."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import isfunction
from typing import Any, ParamSpec, TypeVar

import numpy as np

from rayweave._core import RayweaveError

P = ParamSpec("P")
R = TypeVar("R")

#: The attribute that holds the call: a function, its arguments, and the place of the object in a list of results.
_RECIPE = "_recipe"


def recorded(function: Callable[P, R]) -> Callable[P, R]:
    """A function or method whose results keep the call that made them."""

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        made = function(*args, **kwargs)
        kept = tuple(_kept(value) for value in args), {name: _kept(value) for name, value in kwargs.items()}
        if isinstance(made, list | tuple):
            for place, item in enumerate(made):
                object.__setattr__(item, _RECIPE, (call, *kept, place))
        else:
            object.__setattr__(made, _RECIPE, (call, *kept, None))
        return made

    return call


def record_all(module: dict[str, Any], kind: str) -> None:
    """Records the calls of all public functions of a module that return objects of a class, one or several."""
    for name, function in list(module.items()):
        if name.startswith("_") or not isfunction(function) or function.__module__ != module["__name__"]:
            continue
        if kind in str(function.__annotations__.get("return", "")):
            module[name] = recorded(function)


def reduced(made: object) -> tuple[Any, ...]:
    """The value of `__reduce__` of a recorded object."""
    recipe = getattr(made, _RECIPE, None)
    if recipe is None:
        kind = type(made).__name__
        raise RayweaveError(f"the {kind} cannot be pickled: it was read from a model file. Pickle the name of the file.")
    return _again, recipe


def _again(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any], place: int | None) -> Any:
    made = function(*args, **kwargs)
    return made if place is None else made[place]


def _kept(value: Any) -> Any:
    """A copy of an array, which its owner may change later."""
    return value.copy() if isinstance(value, np.ndarray) else value
