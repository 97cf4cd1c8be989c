"""Writers in Python: files appear complete or not at all."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rayweave as rw
import rayweave.optics as ro
from rayweave._files import AtomicFile


def lens() -> ro.Prescription:
    surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    return ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])


def picture(path: Path) -> None:
    rw.render(rw.sphere(1), size=(64, 48)).save(path)


def plot(path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    spots = lens().spots().show()
    # its fonts are cached in a file
    spots.figure.savefig(BytesIO())
    spots.save(path)


def photograph(path: Path) -> None:
    pytest.importorskip("PIL")
    picture(path)


def segments(path: Path) -> None:
    pytest.importorskip("pyarrow")
    system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25)])
    system.trace_to(path, ro.beam(10.0, 1000).translate([0, 0, -10]))


WRITERS: list[tuple[str, Callable[[Path], Any]]] = [
    ("picture.png", picture),
    ("picture.jpg", photograph),
    ("picture.tiff", photograph),
    ("ray.svg", lambda path: rw.ray_timeline(rw.box(2), [-3, 0, 0], [1, 0, 0]).save(path)),
    ("circle.svg", lambda path: rw.section(rw.sphere(1), "z=0").save(path)),
    ("lens.zmx", lambda path: lens().write_zmx(path)),
    ("plot.png", plot),
    ("light.parquet", segments),
]


@pytest.mark.parametrize(("name", "write"), WRITERS)
def test_a_full_disk_leaves_the_old_file(name: str, write: Callable[[Path], Any], tmp_path: Path) -> None:
    resource = pytest.importorskip("resource")
    path = tmp_path / name
    write(path)
    new = path.read_bytes()
    path.write_bytes(b"old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    # Python ignores the signal: writing fails
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
    try:
        with pytest.raises(OSError, match="cannot write"):
            write(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == b"old" and len(new) > 100
    assert [own.name for own in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(("name", "write"), WRITERS)
def test_links_are_followed(name: str, write: Callable[[Path], Any], tmp_path: Path) -> None:
    target, link = tmp_path / f"target-{name}", tmp_path / name
    target.write_bytes(b"old")
    try:
        link.symlink_to(target.name)
    except OSError:
        pytest.skip("this system does not allow links")
    write(link)
    assert link.is_symlink() and target.read_bytes() != b"old"
    with pytest.raises(ValueError if name.endswith("parquet") else OSError, match="does not exist. Create it first"):
        write(tmp_path / "nowhere" / name)


def test_formats_follow_the_ending(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    pixels = rw.render(rw.sphere(1), size=(64, 48))
    for name, kind in (("a.JPEG", "JPEG"), ("a.tif", "TIFF"), ("a.webp", "WEBP")):
        pixels.save(tmp_path / name)
        with image.open(tmp_path / name) as back:
            assert (back.format, back.size) == (kind, (64, 48))
    with pytest.raises(rw.RayweaveError, match="Pillow has no format for '.xyz'"):
        pixels.save(tmp_path / "a.xyz")


def test_plots_without_an_ending_are_png_files(tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    spots = lens().spots().show()
    spots.save(tmp_path / "plot")
    spots.save(tmp_path / "other", format="svg")
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "other").read_bytes().startswith(b"<?xml")


def test_a_file_that_is_not_finished_is_discarded(tmp_path: Path) -> None:
    path = tmp_path / "data"
    with AtomicFile(path) as file:
        assert file.write(np.arange(3, dtype=np.int16)) == 6
        assert file.tell() == 6
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(OSError, match="the file is closed"):
        file.finish()
