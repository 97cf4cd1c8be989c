"""Conversion of models from every format to every other."""

from pathlib import Path

import numpy as np
import pytest

import rayweave

MODEL = """
rayweave = 1
[solid.plate]
box = { size = [4, 4, 2] }
[solid.bore]
cylinder = { radius = 1 }
[solid.part]
expr = "plate - bore"
"""

VOLUME = 2 * (16 - np.pi)


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "part.toml"
    path.write_text(MODEL)
    return path


def volume(path: Path) -> float:
    """The volume from lines along z, which cross the part over its whole height or not at all."""
    # in GDML the first region is the world around it
    part = rayweave.load(path).regions[-1].solid
    steps = (np.arange(400) + 0.5) / 100 - 2
    x, y = (steps.ravel() for steps in np.meshgrid(steps, steps))
    hits = part.hits(np.stack([x, y, np.full_like(x, -9.0)], axis=1), [0.0, 0.0, 1.0])
    length = np.where(np.isfinite(hits[1]), hits[1] - np.where(np.isfinite(hits[0]), hits[0], 0), 0)
    return float(length.mean() * 16)


@pytest.mark.parametrize("ending", ["toml", "csg", "gdml", "stl", "obj", "ply", "off", "3mf"])
def test_every_format(model: Path, tmp_path: Path, ending: str) -> None:
    target = tmp_path / f"out.{ending}"
    reported = rayweave.convert(model, target, tolerance=1e-3)
    assert volume(target) == pytest.approx(VOLUME, abs=0.02)
    assert bool(reported) == (ending != "toml")
    # and convert the result again
    last = tmp_path / "last.toml"
    rayweave.convert(target, last)
    assert volume(last) == pytest.approx(VOLUME, abs=0.02)


def test_save_reports_losses(model: Path, tmp_path: Path) -> None:
    part = rayweave.load(model)
    reported = part.save(tmp_path / "part", format="stl", tolerance=0.5)
    assert any(line.startswith("approximated: curved faces, with triangles within 5") for line in reported)
    assert part.save(tmp_path / "again.toml") == []
    assert rayweave.load(tmp_path / "again.toml") == part
    with pytest.raises(rayweave.RayweaveError, match="unknown format 'step'"):
        part.save(tmp_path / "x", format="step")
    with pytest.raises(rayweave.RayweaveError, match="tolerance is 0"):
        part.save(tmp_path / "x.stl", tolerance=0.0)
    with pytest.raises(OSError, match="nowhere"):
        part.save(tmp_path / "nowhere" / "x.stl")


def test_unsound_meshes_are_rejected_unless_allowed(tmp_path: Path) -> None:
    chord = rayweave.cone(37, 7, 30).translate([0, 0, 5])
    ring = rayweave.torus(17, 3).translate([0, 0, 7])
    part = (rayweave.cylinder(20, 10).translate([0, 0, 5]) & chord) | (ring - chord)
    # solids of revolution about one axis are combined by their profiles, but not if they are stretched
    part = part.scale([1, 1.5, 1])
    target = tmp_path / "part.obj"
    with pytest.raises(rayweave.RayweaveError, match=r"not sound: .*the first is at \("):
        part.save(target, tolerance=0.05)
    assert not target.exists()
    reported = rayweave.convert(part, target, tolerance=0.05, allow_unsound=True)
    assert any("not sound" in line for line in reported) and target.exists()


def test_open_meshes_and_units(tmp_path: Path) -> None:
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    path = tmp_path / "open.obj"
    path.write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\n")
    with pytest.raises(rayweave.RayweaveError, match="not closed: 3 edges"):
        rayweave.load(path)
    mended = rayweave.load(path, repair=True, unit="in")
    assert mended.unit == "in"
    assert any("1 plane hole filled" in warning for warning in mended.warnings)
    assert mended.contains([[0.1, 0.1, 0.1], [0.5, 0.5, 0.5]]).tolist() == [True, False]
    with pytest.raises(rayweave.RayweaveError, match="unknown unit"):
        rayweave.load(path, unit="furlong")
