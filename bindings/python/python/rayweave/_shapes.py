"""The functions that create shapes, generated from the manual pages of the engine."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from difflib import get_close_matches
from functools import wraps
from math import inf
from typing import Any, NoReturn

from rayweave import _core


def _describe(parameter: dict[str, Any]) -> str:
    unit = "" if parameter["unit"] in ("none", "count") else f", {parameter['unit']}"
    text = f"{parameter['summary']}; {parameter['kind']}{unit}, {parameter['range']}"
    return f"{parameter['name']} : {parameter['type']}\n{textwrap.indent(textwrap.fill(text, 110), '    ')}\n"


def _docstring(page: dict[str, Any]) -> str:
    """The manual page, with its table of parameters in the style of NumPy's documentation."""
    summary, _, rest = page["text"].partition("\n")
    rest = "\n".join(line for line in rest.splitlines() if not line.startswith("|"))
    parameters = "".join(map(_describe, page["parameters"]))
    return f"{summary}\n\nParameters\n----------\n{parameters}\nNotes\n-----\n{rest.strip()}\n"


def _signature(parameter: dict[str, Any]) -> str:
    default = parameter["default"]
    return parameter["name"] if default is None else f"{parameter['name']}={default!r}"


def _function(page: dict[str, Any]) -> Callable[..., _core.Solid]:
    """The function that creates a shape, compiled from text for an ordinary signature and ordinary errors."""
    names = [parameter["name"] for parameter in page["parameters"]]
    source = (
        f"def {page['name']}({', '.join(map(_signature, page['parameters']))}):\n"
        f"    return _shape({page['name']!r}, [{', '.join(names)}])"
    )
    scope: dict[str, Any] = {"_shape": _core.shape, "inf": inf, "__name__": __name__}
    exec(source, scope)
    inner: Callable[..., _core.Solid] = scope[page["name"]]

    @wraps(inner)
    def function(*values: Any, **named: Any) -> _core.Solid:
        for name in named:
            if name not in names:
                _reject(page["name"], names, name)
        return inner(*values, **named)

    function.__doc__ = _docstring(page)
    return function


#: Names of arguments in other programs, with the name here and what else to write.
_MEANT = {
    "d": ("radius", ", half the diameter"),
    "diameter": ("radius", ", half the diameter"),
    "h": ("height", ""),
    "length": ("height", ""),
    "r": ("radius", ""),
    "dimensions": ("size", ""),
    "extents": ("size", ""),
}


def _reject(shape: str, names: list[str], name: str) -> NoReturn:
    """Rejects an unknown argument of a shape."""
    near = get_close_matches(name, names, 1)
    if name in ("center", "centre", "position", "origin"):
        hint = f" Write {shape}(...).translate({name})."
    elif name in _MEANT and _MEANT[name][0] in names:
        hint = f" Did you mean {_MEANT[name][0]}{_MEANT[name][1]}?"
    else:
        hint = f" Did you mean {near[0]}?" if near else ""
    raise TypeError(
        f"{shape}() got an unexpected keyword argument '{name}': its arguments are {', '.join(names)}.{hint}"
    )


_FUNCTIONS = {page["name"]: _function(page) for page in _core.manuals()}
globals().update(_FUNCTIONS)
__all__ = list(_FUNCTIONS)
