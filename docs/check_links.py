"""Checks the links within the built site: `python docs/check_links.py FOLDER` fails if a file or an anchor is missing.

Sphinx warns about most of them; this includes pages that are made from documentation strings and examples.
"""

import html
import re
import sys
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r'\s(?:href|src)="([^"]+)"')
ANCHOR = re.compile(r'\sid="([^"]+)"')


def broken(site: Path) -> list[str]:
    """The links without a target, each with its page."""
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html") if "_static" not in path.parts}
    if not pages:
        return [f"{site}: no pages"]
    anchors = {path: set(ANCHOR.findall(text)) for path, text in pages.items()}
    found = []
    for page, text in pages.items():
        for link in set(map(html.unescape, LINK.findall(text))):
            if re.match(r"[a-z]+:|//", link):
                continue
            name, _, anchor = link.partition("#")
            target = (page.parent / unquote(name.split("?")[0])).resolve() if name else page
            is_missing = not target.exists() or (anchor and target in anchors and unquote(anchor) not in anchors[target])
            if is_missing:
                found.append(f"{page.relative_to(site)}: no target for {link}")
    return sorted(found)


if __name__ == "__main__":
    problems = broken(Path(sys.argv[1]).resolve())
    print("\n".join(problems) or "all links within the site have targets")
    sys.exit(bool(problems))
