"""
Tracks and histories
====================

The steps of single photons in a wrapped bar as lines, and the most frequent histories.
"""

import tempfile
from pathlib import Path

import rayweave.photons as photons

MODEL = """
rayweave = 1
unit = "mm"
[solid.hall]
box = { size = [200, 200, 200] }
[solid.bar]
box = { size = [20, 20, 100] }
[solid.diode]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, 50.5] }]
[[region]]
solid = "hall"
medium = "opaque"
[[region]]
solid = "bar"
medium = "crystal"
[[region]]
solid = "diode"
medium = "opaque"
[medium.opaque]
[medium.crystal]
[photons.medium.crystal]
RINDEX = 1.79
ABSLENGTH = 400
[[photons.surface]]
name = "wrapping"
model = "unified"
finish = "groundfrontpainted"
type = "dielectric_dielectric"
value = 0
skin = ["bar"]
REFLECTIVITY = 0.95
[[photons.surface]]
name = "cathode"
model = "unified"
finish = "polished"
type = "dielectric_metal"
border = [["bar", "diode"]]
REFLECTIVITY = 0
EFFICIENCY = 0.3
"""
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "bar.toml"
    path.write_text(MODEL, encoding="utf-8")
    detector = photons.load(path)

source = photons.point([0, 0, 0], ("uniform", 420, 640))
histories = detector.simulate(source, n=12, seed=6, record="steps").histories
drawing = histories.plot("yz")

many = detector.simulate(source, n=20_000, seed=4, record="sequences").histories
for text, number in list(many.sequences().counts().items())[:6]:
    print(f"{number:6} {text}")
