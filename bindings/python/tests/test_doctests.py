"""The examples in documentation strings: they run, and every public object has one."""

import doctest
import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import numpy as np
import pytest

import rayweave as rw

ROOT = Path(__file__).resolve().parents[3]
PUBLIC = ["rayweave", "rayweave.rootray", "rayweave.space", "rayweave.optics", "rayweave.photons", "rayweave.cluster"]
MODULES = ["rayweave", *(found.name for found in pkgutil.walk_packages(rw.__path__, "rayweave."))]
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
    # the detector of the guide, which the examples of photons read
    guide = (ROOT / "docs/guides/photons.md").read_text(encoding="utf-8")
    Path("bar.gdml").write_text(re.search(r"^```xml\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)[1])
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    with np.printoptions(legacy=False):
        for test in examples_of(importlib.import_module(name)):
            runner.run(test)
    assert runner.failures == 0


def public_objects():
    for module in map(importlib.import_module, PUBLIC):
        for name in module.__all__:
            item = getattr(module, name)
            # types of arguments are no objects of their own
            if inspect.isclass(item) or inspect.isroutine(item):
                yield f"{module.__name__}.{name}", item


def test_every_public_object_has_an_example():
    objects = dict(public_objects())
    assert len(objects) > 200
    assert [name for name, item in objects.items() if ">>>" not in (item.__doc__ or "")] == []


def test_every_public_method_is_documented():
    missing = []
    for name, item in public_objects():
        if inspect.isclass(item):
            for key, value in vars(item).items():
                described = inspect.isroutine(value) or isinstance(value, (property, staticmethod, classmethod))
                described = described or inspect.isdatadescriptor(value)
                if described and not key.startswith("_") and not inspect.getdoc(getattr(item, key)):
                    missing.append(f"{name}.{key}")
    assert missing == []


def test_help_teaches():
    assert all(word in rw.__doc__ for word in ("rw.box", "rw.Model", "to_pandas", "rw.render"))
    for name in rw.__all__:
        assert getattr(rw, name).__doc__, name
