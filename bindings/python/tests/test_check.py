"""Checks from Python and by the command: equal models in all formats have equal findings."""

import json
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest

import rayweave

ROOT = Path(__file__).resolve().parents[3]

# two plates overlap by 0.5, a third is 0.002 away, and a tube has a wall of 0.004
NATIVE = """rayweave = 1
[solid.a]
box = { size = [10, 20, 20] }
transform = [{ translate = [-5, 0, 0] }]
[solid.b]
box = { size = [10, 20, 20] }
transform = [{ translate = [4.5, 0, 0] }]
[solid.c]
box = { size = [10, 20, 20] }
transform = [{ translate = [14.502, 0, 0] }]
[solid._o]
cylinder = { radius = 5, height = 20 }
[solid._i]
cylinder = { radius = 4.996, height = 30 }
[solid.d]
expr = "_o - _i"
transform = [{ translate = [0, 25, 0] }]
[[region]]
solid = "a"
[[region]]
solid = "b"
[[region]]
solid = "c"
[[region]]
solid = "d"
"""

GDML = """<gdml><define/><materials><material name="M" Z="1"><D value="1"/><atom value="1"/></material></materials><solids>
<box name="w" x="100" y="100" z="100" lunit="mm"/><box name="s" x="10" y="20" z="20" lunit="mm"/></solids>
<structure><volume name="a"><materialref ref="M"/><solidref ref="s"/></volume>
<volume name="b"><materialref ref="M"/><solidref ref="s"/></volume>
<volume name="W"><materialref ref="M"/><solidref ref="w"/>
<physvol name="pa"><volumeref ref="a"/><position name="1" x="-5" y="0" z="0" unit="mm"/></physvol>
<physvol name="pb"><volumeref ref="b"/><position name="2" x="4.5" y="0" z="0" unit="mm"/></physvol>
</volume></structure><setup name="Default" version="1.0"><world ref="W"/></setup></gdml>
"""

OPENSCAD = """difference() {
  cube(size = [20, 20, 4], center = true);
  multmatrix([[1, 0, 0, 9.495], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(size = [1, 1, 10], center = true);
  multmatrix([[1, 0, 0, 50], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(size = [1, 1, 10], center = true);
}
"""


def command():
    """The command of this checkout, if it is built."""
    built = [ROOT / "target" / kind / "rayweave" for kind in ("debug", "release")]
    found = [path for path in built if path.exists()]
    return max(found, key=lambda path: path.stat().st_mtime) if found else None


def or_none(value):
    """Numbers that are unknown are NaN in Python and null in JSON."""
    if isinstance(value, np.ndarray):
        return None if np.isnan(value).any() else value.tolist()
    return None if math.isnan(value) else value


@pytest.mark.parametrize(
    ("name", "text", "kinds"),
    [
        ("model.toml", NATIVE, ["overlap", "thin", "gap"]),
        ("model.gdml", GDML, ["overlap"]),
        ("model.csg", OPENSCAD, ["absorbed", "thin"]),
    ],
)
def test_findings_are_those_of_the_command(tmp_path, name, text, kinds):
    program = command()
    if program is None:
        pytest.skip("the command is not built")
    (tmp_path / name).write_text(text, encoding="utf-8")
    limits = ["--wall", "0.01", "--gap", "0.01", "--distance", "1e-6", "--cells", "48", "--seed", "3"]
    run = subprocess.run(
        [program, "check", name, *limits, "--json"], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    other = json.loads(run.stdout)
    model = rayweave.load(tmp_path / name)
    own = rayweave.check(model, wall=0.01, gap=0.01, distance=1e-6, cells=48, seed=3)
    for kind in kinds:
        assert own.of(kind), kind
    assert own.scope == other["scope"] and own.unit == other["unit"]
    assert len(own) == len(other["findings"])
    for finding, expected in zip(own, other["findings"], strict=True):
        assert (finding.kind, list(finding.regions), finding.text) == tuple(
            expected[key] for key in ("kind", "regions", "text")
        )
        assert (list(finding.faces), finding.is_proved) == (expected["faces"], expected["is_proved"])
        for key in ("size", "area", "at", "ray"):
            assert or_none(getattr(finding, key)) == expected[key], (finding, key)
        volume = expected["volume"]
        assert or_none(finding.volume) == (volume and volume["value"])
        assert or_none(finding.volume_half_width) == (volume and volume["half_width"])
