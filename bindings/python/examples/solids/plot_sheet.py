"""
A drawing sheet
===============

Front, top and right view to one scale and a view from the corner, with a legend of the media, as an SVG drawing; and the
same part as a technical drawing with dimensions.
"""

import rayweave as rw

body = rw.box([60, 40, 10]) | rw.cylinder(14, 30).translate([0, 0, 15])
bracket = body - rw.cylinder(9, 100) - rw.place(rw.cylinder(3), [[22, 12, 0], [22, -12, 0], [-22, 12, 0], [-22, -12, 0]])
model = rw.Model(
    [rw.Region("bracket", bracket, medium="aluminium", colour="lightsteelblue")], {"aluminium": {"density": 2.7}}
)

drawing = rw.sheet(model, title="Bracket", size=(1000, 750))
assert drawing.svg.count("<svg") == 1

technical = rw.sheet(model, title="Bracket", dimensions=True)
for text in ("\u230018 through", "4\u00d7 \u23006 through", "60", "40"):
    assert f">{text}</text>" in technical.svg
