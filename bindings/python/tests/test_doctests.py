"""The examples in documentation strings."""

import doctest
import importlib

import numpy as np
import pytest

import rayweave as rw

MODULES = [
    "rayweave",
    "rayweave._answers",
    "rayweave._convert",
    "rayweave._core",
    "rayweave._measure",
    "rayweave._mesh",
    "rayweave._model",
    "rayweave._picture",
    "rayweave._table",
    "rayweave.space",
]
#: Names that the examples of functions use without an import.
GIVEN = {name: getattr(rw, name) for name in ("box", "sphere", "sheet", "render")}


def examples_of(module):
    """The tests of a module, and those of the classes and functions of the compiled module, which `inspect` does not find."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    yield from finder.find(module, extraglobs=GIVEN)
    if module.__name__ == "rayweave._core":
        for name in module.__all__ if hasattr(module, "__all__") else dir(module):
            item = getattr(module, name)
            parts = [(name, item)]
            if isinstance(item, type):
                parts += [(f"{name}.{key}", value) for key, value in vars(item).items() if not key.startswith("__")]
            for path, part in parts:
                text = getattr(part, "__doc__", None)
                if isinstance(text, str) and ">>>" in text:
                    yield doctest.DocTestParser().get_doctest(text, dict(GIVEN), path, None, 0)


@pytest.mark.parametrize("name", MODULES)
def test_examples(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    with np.printoptions(legacy=False):
        for test in examples_of(importlib.import_module(name)):
            runner.run(test)
    assert runner.failures == 0
    assert runner.tries > 0


def test_help_teaches():
    assert all(word in rw.__doc__ for word in ("rw.box", "rw.Model", "to_pandas", "rw.render"))
    for name in rw.__all__:
        assert getattr(rw, name).__doc__, name
