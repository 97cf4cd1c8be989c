"""
A radiograph
============

The thickness of steel along parallel rays, and the transmitted fraction of X-rays.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

neck = rw.tube(16, 12.5, 30).translate([0, 0, 11])
holes = rw.place(rw.cylinder(3.3), [[32 * np.cos(a), 32 * np.sin(a), 0] for a in np.radians(np.arange(0, 360, 60))])
flange = (rw.cylinder(40, 8) | neck) - rw.cylinder(12.5) - holes
steel = rw.Model([rw.Region("flange", flange, medium="steel")], {"steel": {"density": 7.85}})

found = rw.thickness(steel, view="front", size=(240, 160))
figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
shown = axes[0].imshow(found["steel"])
figure.colorbar(shown, ax=axes[0], label="mm of steel")
axes[1].imshow(found.radiograph, cmap="gray")
axes[1].set_title("radiograph")

# the longest way through the disc passes beside the bore
assert 60 < found["steel"].max() < 80
