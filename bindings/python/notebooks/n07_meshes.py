"""
Meshes: out, in, and repaired
=============================

A part becomes triangles for other programs, comes back as a solid, and is compared with the exact one. A damaged mesh is
rejected with a reason, and repaired where that is safe.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

folder = Path(tempfile.mkdtemp())

# %%
# Out
# ---
# The tolerance is the greatest distance between a curved surface and its triangles.

part = (rw.sphere(10) & rw.box(16)) - rw.cylinder(4) - rw.cylinder(4).rotate_x(90)
figure = plt.figure(figsize=(9, 3.6), layout="constrained")
for k, tolerance in enumerate((1.0, 0.3, 0.1)):
    mesh = part.to_mesh(tolerance)
    axis = figure.add_subplot(1, 3, k + 1, projection="3d")
    axis.plot_trisurf(*mesh.vertices.T, triangles=mesh.triangles, edgecolor="black", linewidth=0.15)
    axis.set_title(f"{tolerance}: {len(mesh.triangles)} triangles", fontsize=9)

# %%
# The volume of the mesh approaches that of the solid as the square of the edge length, which is the tolerance.

measured = rw.measure(part)
tolerances = np.array([1.0, 0.3, 0.1, 0.03])
errors = [abs(part.to_mesh(tolerance).volume - measured.volume[0]) / measured.volume[0] for tolerance in tolerances]
figure, axis = plt.subplots(figsize=(5, 3), layout="constrained")
axis.loglog(tolerances, errors, "o-")
axis.set(xlabel="tolerance", ylabel="relative error of the volume")
assert errors[-1] < errors[0]

# %%
# Files: the ending selects the format, and ``save`` returns what the format cannot hold.

for name in ("part.stl", "part.obj", "part.ply", "part.3mf"):
    remarks = part.save(folder / name, tolerance=0.1)
    print(f"{name}: {(folder / name).stat().st_size} bytes; {remarks}")

# %%
# In
# --
# A file of triangles is a model like any other. ``diff`` compares it with the exact part: differences below the distance do not
# count.

part.save(folder / "coarse.stl", tolerance=0.2)
back = rw.load(folder / "coarse.stl")
found = rw.diff(part, back, distance=0.01, cells=24, precision=0.05)
print(f"the thickest difference is {found.thickness[0]:.3f}")
assert not found.is_same and found.thickness[0] < 0.25
assert rw.diff(part, back, distance=0.25, cells=24).is_same

# %%
# Damaged
# -------
# A mesh with a hole encloses nothing. Reading it is an error that says where:

lines = (folder / "part.obj").read_text(encoding="utf-8").splitlines()
faces = [k for k, line in enumerate(lines) if line.startswith("f ")]
del lines[faces[10]]
(folder / "open.obj").write_text("\n".join(lines), encoding="utf-8")
try:
    rw.load(folder / "open.obj")
except rw.RayweaveError as error:
    print(error)

# %%
# With ``repair`` the hole is closed, and the warnings list what was changed.

repaired = rw.load(folder / "open.obj", repair=True)
print(*repaired.warnings, sep="\n")
whole = rw.measure(rw.load(folder / "part.obj"), precision=0.01).volume[0]
mended = rw.measure(repaired, precision=0.01).volume[0]
print(f"volume {mended:.2f}, of the whole mesh {whole:.2f}")
assert abs(mended - whole) < 0.03 * whole

# %%
# A mesh among exact shapes
# -------------------------
# Meshes combine with all shapes, and rays see both exactly.

mesh = part.to_mesh(0.2).to_solid()
both = mesh - rw.box([30, 30, 30]).translate([15, -15, 15])
figure, axis = plt.subplots(figsize=(4.5, 3.6), layout="constrained")
axis.imshow(rw.render({"mesh": both, "ball": rw.sphere(3)}, size=(450, 360)))
axis.axis("off")
