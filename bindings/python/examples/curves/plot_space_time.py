"""
Moving solids
=============

A moving ball is a solid at rest in space-time, a slanted cylinder of four dimensions. The line of a thrown ball in space-time
gives the times of contact. In the picture one axis of space is left out.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave.space as rs


def moving(solid: rs.Solid, start: list[float], velocity: list[float]) -> rs.Solid:
    """The solid in space-time, at `start` at time 0."""
    shear = np.eye(4)
    shear[:3, 3] = velocity
    return solid.affine(shear, [*start, 0])


# two balls of radius 0.5 touch when a point enters a ball of radius 1
target = moving(rs.cylinder(3, 1.0, 4), start=[10, 0.6, 0], velocity=[-2, 0, 0])
contact = rs.trace([0, 0, 0, 0], [3, 0, 0, 1], target).roots
# |10 - 5 t| = sqrt(1 - 0.6^2)
exact = [(10 - 0.8) / 5, (10 + 0.8) / 5]
print(f"contact from t = {contact[0]:.6f} to {contact[1]:.6f}, exactly {exact[0]} to {exact[1]}")
assert np.allclose(contact, exact)

times = np.linspace(0, 4, 5)
figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
for time in times:
    alpha = 0.25 + 0.15 * time
    axis.add_patch(plt.Circle((3 * time, 0), 0.5, color="C0", alpha=alpha))
    axis.add_patch(plt.Circle((10 - 2 * time, 0.6), 0.5, color="C1", alpha=alpha))
first = contact[0]
axis.add_patch(plt.Circle((3 * first, 0), 0.5, fill=False, ec="C0", lw=2))
axis.add_patch(plt.Circle((10 - 2 * first, 0.6), 0.5, fill=False, ec="C1", lw=2))
axis.set(aspect="equal", xlim=(-1, 13), ylim=(-1.2, 2), xlabel="x", title=f"first contact at t = {first:.2f}")
