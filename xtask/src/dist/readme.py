"""The examples of the README, run as a reader would run them, in the current folder, which must be empty.

Usage: readme.py python ROOT | readme.py command ROOT PROGRAM...
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path


def blocks(page: Path, kind: str) -> list[str]:
    text = page.read_text(encoding="utf-8")
    found = re.findall(rf"^```{kind}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if not found:
        sys.exit(f"{page}: no block of {kind}: there is nothing to run.")
    return found


def python(root: Path) -> None:
    """All Python blocks of a page, in order, with shared names."""
    import rayweave

    # the installed package, not the sources beside this program
    assert Path(sys.prefix) in Path(rayweave.__file__).parents, rayweave.__file__
    for page in [root / "README.md", root / "bindings/python/README.md"]:
        names = {"__name__": "page"}
        for block in blocks(page, "python"):
            exec(compile(block, str(page), "exec"), names)
        print(f"{page.name}: {len(blocks(page, 'python'))} blocks of Python ran")


def command(root: Path, *program: Path) -> None:
    """All commands `rayweave ...` of the README, on its model. Several words of the program are an emulator and its argument."""
    readme = root / "README.md"
    lines = [line for block in blocks(readme, "sh") for line in block.splitlines()]
    calls = [shlex.split(line, comments=True) for line in lines]
    calls = [words for words in calls if words and words[0] == "rayweave"]
    assert len(calls) >= 10, f"{readme}: only {len(calls)} commands"
    model = blocks(readme, "toml")[0]
    Path("other.toml").write_text(model.replace("R = 50.0", "R = 60.0"), encoding="utf-8")
    Path("rays.csv").write_text("ox,oy,oz,dx,dy,dz\n" + "".join(f"{x / 9},0,-10,0,0,1\n" for x in range(99)), encoding="utf-8")
    Path("bar.gdml").write_text(blocks(root / "docs/guides/photons.md", "xml")[0], encoding="utf-8")
    for words in calls:
        # that of `new` has light sources, that of the README has none
        if words[1] != "new":
            Path("lens.toml").write_text(written if words[1] == "optics" else model, encoding="utf-8")
        print("$", shlex.join(words), flush=True)
        run = subprocess.run([*program, *words[1:]], stdin=subprocess.DEVNULL)
        # like the command `diff`: 1 says that the files differ, and they do
        if run.returncode != (words[1] == "diff"):
            sys.exit(f"{shlex.join(words)}: it ended with code {run.returncode}.")
        for option, name in zip(words, words[1:]):
            if option in ("-o", "--out", "--svg", "--layout", "--map") and not os.path.getsize(name):
                sys.exit(f"{shlex.join(words)}: {name} is empty.")
        if words[1] == "new":
            written = Path(words[2]).read_text(encoding="utf-8")
    print(f"{readme.name}: {len(calls)} commands ran")


if __name__ == "__main__":
    {"python": python, "command": command}[sys.argv[1]](*map(Path, sys.argv[2:]))
