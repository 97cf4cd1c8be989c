"""The functions that create shapes, generated from the manual pages of the engine."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from functools import wraps
from math import inf
from typing import Any, NoReturn

from rayweave import _core
from rayweave._words import unexpected


def _describe(parameter: dict[str, Any]) -> str:
    unit = "" if parameter["unit"] in ("none", "count") else f", {parameter['unit']}"
    text = f"{parameter['summary']}; {parameter['kind']}{unit}, {parameter['range']}"
    return f"{parameter['name']} : {parameter['type']}\n{textwrap.indent(textwrap.fill(text, 110), '    ')}\n"


#: A call of each shape, with a point inside and a point outside.
_EXAMPLES = {
    "asphere": ("asphere(10, 0.02, even=[0, 1e-5], height=5)", "[0, 0, 1]", "[0, 0, 6]"),
    "biconic": ("biconic(10, 0.02, 0.03, height=5)", "[0, 0, 1]", "[0, 0, 6]"),
    "box": ("box([4, 2, 1])", "[1.9, 0, 0]", "[0, 1.9, 0]"),
    "box_from_corners": ("box_from_corners([0, 0, 0], [4, 2, 1])", "[3, 1, 0.5]", "[-1, 1, 0.5]"),
    "cone": ("cone(2, 1, 3)", "[1.9, 0, -1.4]", "[1.9, 0, 1.4]"),
    "convex": ("convex([[1, 0, 0, 1], [-1, 0, 0, 1], [0, 1, 1, 2], [0, -1, 0, 1], [0, 0, -1, 1]])", "[0, 0, 1]", "[0, 2, 1]"),
    "cylinder": ("cylinder(2, height=3)", "[1, 1, 1.4]", "[1, 1, 1.6]"),
    "ellipsoid": ("ellipsoid([3, 2, 1])", "[2.9, 0, 0]", "[0, 0, 1.1]"),
    "freeform": ("freeform(10, curvature=0.02, xy=[0, 0, 1e-3], height=5)", "[0, 0, 1]", "[0, 0, 6]"),
    "half_space": ("half_space([0, 0, 1], 2)", "[0, 0, 1]", "[0, 0, 3]"),
    "mesh": ("mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])", "[0.2, 0.2, 0.2]", "[1, 1, 1]"),
    "paraboloid": ("paraboloid(2, height=4)", "[0, 0, 1]", "[4, 0, 1]"),
    "prism": ("prism(6, 2, 1)", "[1.5, 0, 0]", "[1.9, 1.9, 0]"),
    "quadric": ("quadric([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 4, 0], [0, 0, 0, -4]])", "[1.9, 0, 0]", "[0, 0, 1.1]"),
    "slab": ("slab([0, 0, 1], -1, 1)", "[9, 9, 0]", "[0, 0, 2]"),
    "sphere": ("sphere(2)", "[0, 0, 1.9]", "[0, 0, 2.1]"),
    "torus": ("torus(5, 1)", "[5, 0, 0.9]", "[0, 0, 0]"),
    "tube": ("tube(3, 2, 4)", "[2.5, 0, 0]", "[0, 0, 0]"),
    "wedge": ("wedge(0, 90)", "[1, 1, 5]", "[-1, 1, 5]"),
}


def _example(name: str) -> str:
    if name not in _EXAMPLES:
        return ""
    call, inside, outside = _EXAMPLES[name]
    return f"\n>>> import rayweave as rw\n>>> shape = rw.{call}\n>>> shape.contains([{inside}, {outside}])\narray([ True, False])\n"


def _docstring(page: dict[str, Any]) -> str:
    """The manual page, with its table of parameters in the style of NumPy's documentation."""
    summary, _, rest = page["text"].partition("\n")
    rest = "\n".join(line for line in rest.splitlines() if not line.startswith("|"))
    parameters = "".join(map(_describe, page["parameters"]))
    notes = f"Notes\n-----\n{rest.strip()}\n"
    return f"{summary}\n{_example(page['name'])}\nParameters\n----------\n{parameters}\n{notes}"


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
        if len(values) > len(names):
            hint = " Write box([x, y, z])." if page["name"] == "box" else ""
            raise TypeError(
                f"{page['name']}() got {len(values)} arguments: it has {len(names)}: {', '.join(names)}.{hint}"
            )
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
    "r1": ("radius1", ", the radius at the bottom"),
    "r2": ("radius2", ", the radius at the top"),
    "radius": ("major", " or minor"),
    "n": ("sides", ""),
    "points": ("vertices", ""),
    "triangles": ("faces", ""),
}


def _reject(shape: str, names: list[str], name: str) -> NoReturn:
    """Rejects an unknown argument of a shape."""
    meant = None
    if name in ("center", "centre", "position", "origin"):
        meant = f"{shape}(...).translate({name})"
    elif name in _MEANT and _MEANT[name][0] in names:
        meant = "".join(_MEANT[name])
    elif name in ("width", "depth", "length", "height", "x", "y", "z") and shape == "box":
        meant = "box([x, y, z])"
    raise TypeError(unexpected(f"{shape}", names, name, meant))


_FUNCTIONS = {page["name"]: _function(page) for page in _core.manuals()}
globals().update(_FUNCTIONS)
__all__ = list(_FUNCTIONS)
