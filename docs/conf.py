"""Configuration of the documentation site: `cargo xtask docs` builds it into target/site."""

import os
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
MANIFEST = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
REPOSITORY = MANIFEST["repository"]
sys.path.insert(0, str(DOCS))

project = "Rayweave"
author = "the Rayweave developers"
copyright = "the Rayweave developers, MIT or Apache-2.0"
version = release = MANIFEST["version"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "**/README.rst"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
default_role = "py:obj"
nitpicky = False
suppress_warnings = ["config.cache"]

# ---- theme ----

html_theme = "pydata_sphinx_theme"
html_title = f"Rayweave {release}"
html_static_path = ["_static"]
html_theme_options = {
    "navbar_align": "left",
    "show_toc_level": 2,
    "github_url": REPOSITORY,
    "navigation_with_keys": False,
    "header_links_before_dropdown": 8,
}
html_show_sourcelink = False

# ---- Markdown ----

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 5

# ---- the Python package ----

# an option that is False counts as given
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autosummary_generate = True
autosummary_imported_members = True
napoleon_google_docstring = False
napoleon_use_rtype = False

# ---- the gallery and the notebooks: programs of the package, executed ----

os.environ.setdefault("MPLBACKEND", "Agg")
sphinx_gallery_conf = {
    "examples_dirs": ["../bindings/python/examples", "../bindings/python/notebooks"],
    "gallery_dirs": ["gallery", "notebooks"],
    "filename_pattern": r"\.py$",
    "subsection_order": [
        f"../bindings/python/examples/{name}"
        for name in ("solids", "analysis", "algebra", "curves", "data", "light", "photons")
    ],
    "within_subsection_order": "FileNameSortKey",
    # it writes the pictures of models/optics
    "ignore_pattern": r"draw_designs\.py$",
    "download_all_examples": False,
    "show_memory": False,
    "plot_gallery": True,
    "abort_on_example_error": True,
    "remove_config_comments": True,
    # docs/drawings.py
    "image_scrapers": ("matplotlib", "drawings"),
}

# ---- pages that lie elsewhere in the repository, and links to files of the repository ----

#: Pages of the site whose text is a file outside of docs/.
ELSEWHERE = {
    "project/architecture": "ARCHITECTURE.md",
    "project/changelog": "CHANGELOG.md",
    "project/contributing": "CONTRIBUTING.md",
    "project/design": "DESIGN.md",
    "project/models": "models/README.md",
    "reference/conventions": "CONVENTIONS.md",
}

_CODE = re.compile(r"^(```|~~~|:::).*?^\1", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(!?)(\[(?:[^\]\[]|\[[^\]]*\])*\])\(([^)\s]+)\)")


def _page_of(path: Path) -> str | None:
    """The page of the site that has the text of a file, if there is one."""
    for page, file in ELSEWHERE.items():
        if path == ROOT / file:
            return page
    if path.suffix == ".md" and path.is_relative_to(DOCS) and path.is_file():
        return path.relative_to(DOCS).with_suffix("").as_posix()
    return None


def _target(target: str, file: Path, page: str, is_image: bool) -> str:
    """The target of a link in `file`, as seen from the page that has its text."""
    name, _, anchor = target.partition("#")
    if not name or re.match(r"[a-z]+:", target):
        return target
    path = (file.parent / name).resolve()
    folder = (DOCS / page).parent
    other = _page_of(path)
    if other is not None:
        link = os.path.relpath(DOCS / f"{other}.md", folder)
        return f"{link}#{anchor}" if anchor else link
    if is_image:
        return os.path.relpath(path, folder)
    if not path.exists() or not path.is_relative_to(ROOT):
        # a broken link: reported by Sphinx
        return target
    kind = "tree" if path.is_dir() else "blob"
    return f"{REPOSITORY}/{kind}/main/{path.relative_to(ROOT).as_posix()}" + (f"#{anchor}" if anchor else "")


def _read(app, page, source):
    """Replaces the text of pages that lie elsewhere, and the targets of links to files."""
    file = ROOT / ELSEWHERE[page] if page in ELSEWHERE else DOCS / f"{page}.md"
    if not file.is_file():
        return
    if page in ELSEWHERE:
        # otherwise Sphinx would keep the page as it was when only that file changes
        app.env.note_dependency(str(file))
    text = file.read_text(encoding="utf-8") if page in ELSEWHERE else source[0]
    # comments such as <!-- layers --> serve other tools
    text = re.sub(r"^<!--.*?-->\n", "", text, flags=re.MULTILINE | re.DOTALL)

    def link(match):
        image, label, target = match.groups()
        if "](" in label:
            label = _LINK.sub(link, label)
        return f"{image}{label}({_target(target, file, page, bool(image))})"

    parts, start = [], 0
    for code in _CODE.finditer(text):
        parts += [_LINK.sub(link, text[start : code.start()]), code[0]]
        start = code.end()
    source[0] = "".join([*parts, _LINK.sub(link, text[start:])])


# ---- documentation strings ----

_TERM = re.compile(r"(?<![`:\w])`([^`]+)`(?!`)", re.DOTALL)


def _is_object(term: str) -> bool:
    """True if a term in single backticks names a public object of the package."""
    import rayweave

    item = rayweave
    for name in term.removeprefix("rayweave.").split("."):
        if name.startswith("_") or not hasattr(item, name):
            return False
        item = getattr(item, name)
    return callable(item)


def _docstring(app, what, name, item, options, lines):
    """Turns terms in single backticks into links to objects or into code; other text has no markup."""

    def term(match):
        text = " ".join(match[1].split())
        shown = f":py:obj:`{text}`" if _is_object(text) else f"``{text}``"
        after = match.string[match.end() : match.end() + 1]
        return f"{shown}\\ " if after and not re.match(r"[\s.,;:!?)\]'\"-]", after) else shown

    text = "\n".join(lines)
    parts = re.split(r"(^ *>>>.*?(?=\n\n|\Z)|``.*?``)", text, flags=re.MULTILINE | re.DOTALL)
    for k in range(0, len(parts), 2):
        pieces = re.split(r"(`[^`]+`)", parts[k])
        # a bar or a star outside of code is an operator
        pieces[::2] = [re.sub(r"(?<!\*)\*(?!\*)|\|", r"\\\g<0>", piece) for piece in pieces[::2]]
        parts[k] = _TERM.sub(term, "".join(pieces))
    lines[:] = "".join(parts).split("\n")
    if what in ("attribute", "property"):
        _texts[name] = list(lines)


#: The documentation strings of properties, by their full names.
_texts: dict[str, list[str]] = {}


def _restore(app, what, name, item, options, lines):
    """Undoes the work of napoleon on properties: it takes the text before a colon in the first line for a type."""
    lines[:] = _texts.pop(name, lines)


def setup(app):
    app.connect("source-read", _read)
    # before napoleon
    app.connect("autodoc-process-docstring", _docstring, priority=400)
    # after napoleon
    app.connect("autodoc-process-docstring", _restore, priority=600)
    return {"parallel_read_safe": True}
