"""Suggestions for misspelt arguments, and for the words of other programs."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from functools import wraps
from typing import ParamSpec, TypeVar

_P = ParamSpec("_P")
_R = TypeVar("_R")


def suggesting(**meant: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """A decorator of functions: an unknown keyword argument is rejected with the known ones and a suggestion. `meant` has words
    of other programs with what to write."""

    def decorate(function: Callable[_P, _R]) -> Callable[_P, _R]:
        names = [name for name in inspect.signature(function).parameters if name != "self"]

        @wraps(function)
        def checked(*values: _P.args, **named: _P.kwargs) -> _R:
            for name in named:
                if name not in names:
                    raise TypeError(unexpected(function.__qualname__.removesuffix(".__init__"), names, name, meant.get(name)))
            return function(*values, **named)

        return checked

    return decorate


def suggest_for(owner: type, methods: tuple[str, ...], **meant: str) -> None:
    """Gives methods written in Rust the message about unknown keyword arguments that `suggesting` gives to functions."""
    for name in methods:
        setattr(owner, name, _explained(getattr(owner, name), f"{owner.__name__}.{name}", meant))


def _explained(function: Callable[_P, _R], title: str, meant: Mapping[str, str]) -> Callable[_P, _R]:
    @wraps(function)
    def explained(*values: _P.args, **named: _P.kwargs) -> _R:
        try:
            return function(*values, **named)
        except TypeError:
            # only now, so that a valid call costs nothing more
            names = [name for name in inspect.signature(function).parameters if name != "self"]
            for name in named:
                if name not in names:
                    raise TypeError(unexpected(title, names, name, meant.get(name))) from None
            raise

    return explained


def unexpected(function: str, names: list[str], name: str, meant: str | None = None) -> str:
    """The message about an unknown argument of a function with the given ones."""
    hint = did_you_mean(name, names, {name: meant} if meant else {})
    return f"{function}() got an unexpected keyword argument '{name}': its arguments are {', '.join(names)}.{hint}"


def did_you_mean(name: str, names: list[str], meant: Mapping[str, str]) -> str:
    """A question that ends a message about an unknown name, after a space, or "": what `meant` has for words of other programs,
    else the closest of the known names."""
    near = [own for own in names if own.casefold() == name.casefold()] or get_close_matches(name, names, 1)
    suggestion = meant.get(name) or (near[0] if near else None)
    return f" Did you mean {suggestion}?" if suggestion else ""


def no_attribute(kind: str, name: str, names: list[str], meant: Mapping[str, str]) -> str:
    """The message about an unknown attribute of an object of a class with the given ones; `meant` has words of other programs
    with what to write."""
    return f"{kind} has no attribute {name!r}.{did_you_mean(name, names, meant)}"
