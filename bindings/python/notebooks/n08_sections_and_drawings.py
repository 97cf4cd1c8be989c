"""
Sections, drawings and tool paths
=================================

A bracket as a drawing sheet, its sections for a CAD program, a wall that is too thin, and the layers of a 3D printer.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

folder = Path(tempfile.mkdtemp())

# %%
# The bracket
# -----------

base = rw.box([60, 40, 6]).translate([0, 0, 3])
wall = rw.box([6, 40, 40]).translate([-27, 0, 20])
rib = rw.from_polygons([[[-24, 6], [4, 6], [-24, 34]]]).extrude(-2, 2).rotate_x(90)
screws = rw.place(rw.cylinder(2.6), [[18, 12, 0], [18, -12, 0], [0, 12, 0], [0, -12, 0]])
window = rw.cylinder(9).rotate_y(90).translate([-27, 0, 26])
bracket = (base | wall | rib) - screws - window
model = rw.Model([rw.Region("bracket", bracket, medium="steel", colour="steelblue")], {"steel": {"density": 7.85}})

# %%
# A sheet
# -------
# Four views to one scale, as SVG. A notebook shows it, ``save`` writes it.

drawing = rw.sheet(model, title="Bracket", size=(1000, 750))
drawing.save(folder / "sheet.svg")

# %%
# A section
# ---------
# The contours are polygons within a tolerance of the true section. They can be saved as SVG for people and DXF for machines.

cut = rw.section(model, "z=3")
rw.save_section(cut, folder / "cut.dxf")
rw.save_section(cut, folder / "cut.svg")
exact = 60 * 40 - 4 * np.pi * 2.6**2
print(f"area {cut.areas.sum():.3f}, exactly {exact:.3f}; files {sorted(p.name for p in folder.iterdir())}")
assert abs(cut.areas.sum() - exact) < 1

figure, axis = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
for contour in cut.contours(cut.names[0]):
    axis.plot(*np.vstack([contour, contour[:1]]).T, "k", lw=1)
axis.set(aspect="equal", title="z = 3")

# %%
# Thin walls
# ----------
# Beside the window and the edges the wall may be thin. ``check`` finds the thinnest place below a limit.

report = rw.check(model, wall=5, cells=64)
for finding in report.of("thin"):
    print(f"{finding.text}: {finding.size:.2f} mm at {finding.at.round(2)}")

# %%
# Layers
# ------
# The traces of a nozzle: parallel lines across each layer, turned by 90 degrees from layer to layer.

heights = np.array([1.0, 3.0, 15.0, 26.0])
figure, axes = plt.subplots(1, 4, figsize=(11, 3), layout="constrained")
for k, (height, axis) in enumerate(zip(heights, axes, strict=True)):
    traces = rw.infill(bracket, spacing=1.0, angle=45 + 90 * k, layers=[height])
    axis.plot(
        np.stack([traces["x0"], traces["x1"]]), np.stack([traces["y0"], traces["y1"]]), color="steelblue", lw=0.7
    )
    length = np.hypot(traces["x1"] - traces["x0"], traces["y1"] - traces["y0"]).sum()
    area = rw.section(bracket, f"z={height}").areas.sum()
    axis.set(aspect="equal", title=f"z = {height}: {length:.0f} mm", xlim=(-32, 32), ylim=(-22, 22))
    print(f"z = {height}: total length x spacing {length:.1f}, area of the section {area:.1f}")
    assert abs(length - area) < 0.05 * area
