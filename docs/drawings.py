"""Images of the gallery: the drawings of Rayweave that a block of an example assigns to a name, as SVG."""

from pathlib import Path

import rayweave
from sphinx_gallery.scrapers import figure_rst

_shown: set[tuple[str, str, int]] = set()


def drawings(block, block_vars, gallery_conf):
    """The images of a block, in the markup of Sphinx: an image scraper of sphinx-gallery."""
    paths = []
    for name, item in block_vars["example_globals"].items():
        key = (block_vars["src_file"], name, id(item))
        if isinstance(item, (rayweave.Drawing, rayweave.Timeline)) and key not in _shown:
            _shown.add(key)
            path = Path(next(block_vars["image_path_iterator"])).with_suffix(".svg")
            path.write_text(item.svg, encoding="utf-8")
            paths.append(str(path))
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper():
    """Called by sphinx-gallery, which takes the name of this module."""
    return drawings
