"""The Python code of the pages: every block is run, in order, page by page."""

import re
from pathlib import Path

import pytest

import rayweave

ROOT = Path(__file__).resolve().parents[3]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MODEL = re.compile(r"^```(?:toml|xml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: The first line of a block that is a file.
FILE = re.compile(r"(?:# |<!-- )file: (\S+)")
PAGES = sorted([ROOT / "README.md", ROOT / "bindings/python/README.md", *ROOT.glob("docs/**/*.md")])


def blocks(page: Path) -> list[tuple[int, str]]:
    """The blocks of a page, each with the line on which it begins."""
    text = page.read_text(encoding="utf-8")
    return [(text.count("\n", 0, match.start(1)) + 1, match[1]) for match in BLOCK.finditer(text)]


WITH_PYTHON = [page for page in PAGES if blocks(page)]


def test_pages_are_found():
    names = {page.relative_to(ROOT).as_posix() for page in WITH_PYTHON}
    assert {"README.md", "docs/concepts/algebra.md", "docs/guides/curves.md", "docs/tutorials/python.md"} <= names


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_python_of_a_page(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # pages may use files of other pages; a file of the page itself comes last
    for source in [*PAGES, page]:
        for block in MODEL.finditer(source.read_text(encoding="utf-8")):
            if (name := FILE.match(block[1])) is not None:
                (tmp_path / name[1]).write_text(block[1], encoding="utf-8")
    names = {"__name__": "page"}
    for line, block in blocks(page):
        # line numbers are those of the page, so that a failure refers to it
        code = compile("\n" * (line - 1) + block, str(page), "exec")
        exec(code, names)


def test_the_reference_has_every_public_name():
    text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs/reference/python").glob("*.md"))
    documented = set(re.findall(r"^\.\. auto\w+:: (?:rayweave\.)?(\w+)$", text, re.MULTILINE))
    assert set(rayweave.__all__) - documented == set()


def test_the_example_of_the_model_file_is_a_model():
    text = (ROOT / "docs/reference/model-file.md").read_text(encoding="utf-8")
    model = rayweave.loads(MODEL.search(text)[1], strict=True)
    assert model["lens"].solid.volume > 0 and model["lens"].medium == "glass"
