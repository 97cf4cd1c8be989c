"""
Gradient index
==============

Light follows curves where the index changes from place to place: in a rod with a parabolic profile, and in Luneburg's lens,
which focuses parallel light on its rear surface.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
from rayweave import optics

g = 0.25
rod = optics.element(rw.cylinder(2, 4 * np.pi / g), optics.graded(1.6, "selfoc", g), name="rod")
ball = optics.element(rw.sphere(10), optics.graded(1.0, "luneburg", 10.0), name="ball")

figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
parallel = optics.line_of_rays(0.3, 7).translate([0, 0, -35])
trace = optics.System([rod]).trace(parallel)
trace.show(ax=axes[0], escape=3)
axes[0].set(aspect="auto", title="two periods of a rod")

wide = optics.line_of_rays(2.2, 9).translate([0, 0, -15])
focused = optics.System([ball]).trace(wide)
focused.show(ax=axes[1], escape=4)
axes[1].set_title("Luneburg's lens")

# all rays leave the ball at (0, 0, 10)
inside = focused["event"] != "curved"
ends = np.stack([focused["y1"], focused["z1"]], axis=1)[np.isclose(np.hypot(focused["y1"], focused["z1"]), 10)]
exits = ends[ends[:, 1] > 0]
print("exits:", np.abs(exits - [0, 10]).max(), "from the focus")
