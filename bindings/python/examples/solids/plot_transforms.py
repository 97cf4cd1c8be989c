"""
Transforms
==========

Move, turn, scale and mirror a solid. Each method returns a new solid, and methods apply from left to right: the order
matters for the two bottom pictures.
"""

import matplotlib.pyplot as plt

import rayweave as rw

foot, leg = rw.box([3, 1, 1]), rw.box([1, 1, 3])
letter = foot.translate([1, 0, -1]) | leg
moved = {
    "letter": letter,
    ".translate([0, 0, 2])": letter.translate([0, 0, 2]),
    ".rotate_y(90)": letter.rotate_y(90),
    ".scale(1.5)": letter.scale(1.5),
    ".mirror([1, 0, 0])": letter.mirror([1, 0, 0]),
    ".scale([1, 3, 1])": letter.scale([1, 3, 1]),
    ".translate([3, 0, 0]).rotate_z(90)": letter.translate([3, 0, 0]).rotate_z(90),
    ".rotate_z(90).translate([3, 0, 0])": letter.rotate_z(90).translate([3, 0, 0]),
}

camera = rw.Camera(position=[30, -45, 30], target=[0, 0, 0], height=11)
axes_of_space = [rw.cylinder(0.05, 10), rw.cylinder(0.05, 10).rotate_y(90), rw.cylinder(0.05, 10).rotate_x(90)]
figure, axes = plt.subplots(2, 4, figsize=(10, 5), layout="constrained")
for axis, (text, solid) in zip(axes.flat, moved.items(), strict=True):
    axis.imshow(rw.render({"letter": solid, "axes": rw.union(*axes_of_space)}, size=(240, 200), camera=camera))
    axis.set_title(text, fontsize=8)
    axis.axis("off")

# the volume of the letter is 3 + 3 - 1; scaling by 1.5 multiplies it by 1.5^3
for solid, exact in ((letter, 5.0), (moved[".scale(1.5)"], 5.0 * 1.5**3), (moved[".scale([1, 3, 1])"], 15.0)):
    print(f"volume {solid.volume:.4f}, exactly {exact}")
    assert abs(solid.volume - exact) < 5e-3 * exact
