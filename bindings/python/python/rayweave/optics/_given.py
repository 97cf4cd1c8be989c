"""Checks of arguments: errors name the argument and the expected kind of value."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from math import isfinite
from reprlib import repr as shortened
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._package import package as package
from rayweave._whole import whole as whole

T = TypeVar("T")


def real(value: Any, name: str, needed: str = "a number") -> float:
    """A number."""
    if not isinstance(value, str):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    raise TypeError(f"{name} is {value!r}: it must be {needed}.")


def finite(value: Any, name: str, needed: str = "a number") -> float:
    """A number, neither infinite nor NaN."""
    number = real(value, name, needed)
    if not isfinite(number):
        raise _core.RayweaveError(f"{name} is {number}: it must be finite.")
    return number


def flag(value: Any, name: str, needed: str = "True or False") -> bool:
    """Yes or no."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {value!r}: it must be {needed}.")
    return bool(value)


def text(value: Any, name: str, needed: str = "a text") -> str:
    """A text, such as a name."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}: it must be {needed}.")
    return value


def pair(values: Any, name: str, needed: str) -> tuple[float, float]:
    """Two numbers; `needed` describes them."""
    given = list(values) if isinstance(values, Iterable) and not isinstance(values, str) else []
    if len(given) != 2:
        raise TypeError(f"{name} is {values!r}: it must be {needed}.")
    return real(given[0], name, needed), real(given[1], name, needed)


def array(values: Any, name: str) -> NDArray[np.float64]:
    """An array of numbers."""
    try:
        return np.asarray(values, float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {shortened(values)}: it must be an array of numbers.") from None


def each(values: Any, name: str, needed: str) -> list[Any]:
    """The members of any iterable except a text."""
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise TypeError(f"{name} is {values!r}: it must be a list of {needed}.")
    return list(values)


def numbers(values: Any, name: str) -> list[float]:
    """A list of numbers, from any iterable of them."""
    is_list = isinstance(values, Iterable) and not isinstance(values, str)
    return _core.number_list(list(values) if is_list else values, name)


def vector(values: Any, name: str) -> list[float]:
    """Three numbers."""
    found = numbers(values, name)
    if len(found) != 3:
        raise _core.RayweaveError(f"{name} has {len(found)} numbers: it must have 3.")
    return found


def all_of(kind: type[T], things: Any, name: str, make: str = "") -> list[T]:
    """A list of objects of one class, from a single object or an iterable; `make` is a hint on how to create one."""
    hint = f" {make}" if make else ""
    needed = f"it must be {'an' if kind.__name__[0] in 'AEIO' else 'a'} {kind.__name__}"
    if isinstance(things, kind):
        return [things]
    if not isinstance(things, Iterable):
        raise TypeError(f"{name} is {things!r}: {needed}, or a list of them.{hint}")
    given = list(things)
    for k, thing in enumerate(given):
        if not isinstance(thing, kind):
            raise TypeError(f"{name}[{k}] is of the type {type(thing).__name__}: {needed}.{hint}")
    return given


def unknown(what: str, name: Any, known: Iterable[str]) -> NoReturn:
    """Raises an error about an unknown name, with the known ones."""
    names = list(known)
    if not isinstance(name, str):
        raise TypeError(f"the {what} is {name!r}: it can be {', '.join(names)}.")
    close = [own for own in names if own.casefold() == name.casefold()] or get_close_matches(name, names, 1)
    hint = f" Did you mean {close[0]!r}?" if close else ""
    raise _core.RayweaveError(f"there is no {what} {name!r}: there are {', '.join(names)}.{hint}")
