"""
Letters and outlines
====================

Closed contours become a region of the plane, and the region an extruded solid. The contours are those of a font of
matplotlib, with its curves as polygons.
"""

import matplotlib.pyplot as plt
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import rayweave as rw

text = TextPath((0, 0), "R&D", size=10, prop=FontProperties(family="DejaVu Sans", weight="bold"))
contours = [contour[:-1] for contour in text.to_polygons()]
# outlines of this font are clockwise and holes counter-clockwise; `from_polygons` needs the opposite
outline = rw.from_polygons([contour[::-1] for contour in contours])
letters = outline.extrude(0, 2)
low, high = letters.bounds
plate = rw.box_from_corners([low[0] - 2, low[1] - 2, -1], [high[0] + 2, high[1] + 2, 0.5])

figure, axis = plt.subplots(figsize=(6, 3.6), layout="constrained")
camera = rw.Camera(position=[20, -60, 80], target=(low + high) / 2, height=18)
axis.imshow(rw.render({"plate": plate, "letters": letters}, size=(400, 250), samples=2, camera=camera, shadows=True))
axis.axis("off")

volume = rw.measure(letters, precision=0.01).volume[0]
print(f"{len(contours)} contours, volume {volume:.3f}, area times height {2 * outline.area:.3f}")
assert abs(volume - 2 * outline.area) < 0.03 * volume
