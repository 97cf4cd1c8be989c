"""
Mass, centre and inertia
========================

The inertia tensor of a ring, and its principal axes in a picture. For a torus all values are known.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

R, r, density = 30.0, 8.0, 7.85
ring = rw.torus(R, r).rotate_x(40)
model = rw.Model([rw.Region("ring", ring, medium="steel", colour="steelblue")], {"steel": {"density": density}})
found = rw.measure(model)

# density in g/cm^3, lengths in mm; `inertia` is that of unit density
volume = 2 * np.pi**2 * R * r**2
mass = volume * density * 1e-3
moments, directions = np.linalg.eigh(found.inertia[0])
# sorted: twice the moment about a diameter, then that about the axis
exact = np.array([volume * (R**2 / 2 + 5 / 8 * r**2)] * 2 + [volume * (R**2 + 3 / 4 * r**2)])
print(f"mass {found.mass[0]:.2f} +- {found.mass_half_width[0]:.2f} g, exactly {mass:.2f}")
print("principal moments", moments.round(), "mm^5, exactly", exact.round())
assert np.allclose(moments, exact, rtol=5e-3) and abs(found.mass[0] - mass) < 3 * found.mass_half_width[0]

arrows = []
for length, axis in zip((45, 45, 60), directions.T, strict=True):
    turn = np.eye(4)
    turn[:3, 2] = axis
    turn[:3, 0] = np.linalg.svd(axis[None])[2][1]
    turn[:3, 1] = np.cross(turn[:3, 2], turn[:3, 0])
    arrows.append(rw.cylinder(1, 2 * length).transform(turn))
figure, view = plt.subplots(figsize=(5, 4), layout="constrained")
view.imshow(rw.render({"ring": ring, "long": arrows[2], "others": rw.union(*arrows[:2])}, size=(500, 400)))
view.axis("off")
