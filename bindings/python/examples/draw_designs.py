"""
Lens designs
============

Draws the designs of models/optics: a section of the solids with rays of all fields, written next to each file as
NAME.png.

Run it from the root of the repository, with matplotlib: python bindings/python/examples/draw_designs.py
"""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
from rayweave.optics import Prescription


def draw(path: Path) -> Path:
    """Draws one design."""
    lens = Prescription.read_zmx(path)
    figure, axis = plt.subplots(figsize=(7.0, 3.0), layout="constrained")
    lens.show(ax=axis, rays=5)
    axis.tick_params(labelsize="x-small")
    picture = path.with_suffix(".png")
    figure.savefig(picture, dpi=80, metadata={"Software": None}, pil_kwargs={"optimize": True})
    plt.close(figure)
    return picture


def main() -> None:
    """Draws the designs in a folder, by default models/optics."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "models/optics")
    for path in sorted(folder.glob("*.zmx")):
        print(draw(path))


if __name__ == "__main__":
    main()
