"""
Tool paths
==========

The traces of a tool that fill the layers of a part.
"""

import matplotlib.pyplot as plt

import rayweave as rw

part = rw.cylinder(20, 6) - rw.box([12, 12, 20]).rotate_z(45) - rw.cylinder(3).translate([14, 0, 0])
traces = rw.infill(part, spacing=1.0, angle=30, layers=[0.0])

figure, axis = plt.subplots(figsize=(4.5, 4.5), layout="constrained")
for trace in traces:
    axis.plot([trace["x0"], trace["x1"]], [trace["y0"], trace["y1"]], color=f"C{trace['component'] % 10}", lw=0.8)
axis.set(aspect="equal", xlabel="x in mm", ylabel="y in mm")
print(f"{len(traces)} traces")
assert len(traces) > 40
