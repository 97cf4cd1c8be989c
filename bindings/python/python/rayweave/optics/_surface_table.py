"""Prescriptions as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rayweave._core import Glass

if TYPE_CHECKING:
    from rayweave.optics._prescription import Behind, Prescription, Surface

#: The columns that are aligned to the right.
_NUMBERS = (1, 2, 4, 5)


def prescription_text(lens: Prescription, semi_diameters: Sequence[float | None]) -> str:
    """The aperture, fields, wavelengths and surfaces of a prescription, with the clear semi-diameters of its surfaces; the columns are those of
    `rayweave info` for a lens file."""
    unit = lens.unit
    head = ["surface", f"radius / {unit}", f"thickness / {unit}", "behind", f"semi-diameter / {unit}", "conic", "remarks"]
    rows = [head]
    for number, surface in enumerate(lens.surfaces, 1):
        size = semi_diameters[number - 1]
        clear = "-" if size is None else f"{size:.5g}"
        conic = f"{surface.conic:.8g}" if surface.conic else ""
        lengths = f"{surface.radius:.8g}", f"{surface.thickness:.8g}"
        rows.append([str(number), *lengths, _behind_text(surface.behind), clear, conic, ", ".join(_remarks(lens, number, surface))])
    size = lens.image_semi_diameter
    has_break = any(own.before == len(lens.surfaces) + 1 for own in lens.breaks)
    image = "" if size is None else f"{size:.5g}", f"{lens.image_conic:.8g}" if lens.image_conic else ""
    rows.append(["image", f"{lens.image_radius:.8g}", "", "", *image, "coordinate break before it" if has_break else ""])
    widths = [max(len(row[column]) for row in rows) for column in range(len(head))]

    def line(row: list[str]) -> str:
        cells = (text.rjust(width) if k in _NUMBERS else text.ljust(width) for k, (text, width) in enumerate(zip(row, widths, strict=True)))
        return "  ".join(cells).rstrip()

    return "\n".join([*_frame_lines(lens), *map(line, rows)])


def _frame_lines(lens: Prescription) -> list[str]:
    """The lines above the table."""
    name = f"{lens.name}: " if lens.name else ""
    kind, size = lens._aperture()
    words = kind.replace("_", " ").replace("f number", "F-number")
    length = f" {lens.unit}" if "diameter" in kind else ""
    fields = ", ".join(f"({x:.6g}, {y:.6g})" for x, y in lens.fields)
    places = "in degrees" if lens.field_kind == "angle" else f"as {lens.field_kind} in {lens.unit}"
    colours = []
    for number, (nm, weight) in enumerate(zip(lens.wavelengths_nm, lens.weights, strict=True)):
        remarks = ["primary"] * (number == lens.primary and len(lens.weights) > 1) + [f"weight {weight:.4g}"] * (weight != 1.0)
        colours.append(f"{nm:.8g}" + f" ({', '.join(remarks)})" * bool(remarks))
    count = len(lens.surfaces)
    lines = [
        f"{name}{count} surface{'s' * (count > 1)}, {words} {size:.8g}{length}",
        f"fields {places}: {fields}",
        f"wavelengths in nm: {', '.join(colours)}",
    ]
    if lens.object_distance != float("inf"):
        lines.append(f"distance of the object: {lens.object_distance:.8g} {lens.unit}")
    return lines


def _behind_text(behind: Behind) -> str:
    match behind:
        case "air":
            return ""
        case str():
            return behind
        case Glass():
            return behind.name
        case (index, abbe):
            return f"{index:.8g} {abbe:.8g}"
    return f"{behind:.8g}"


def _remarks(lens: Prescription, number: int, surface: Surface) -> list[str]:
    """Contents of a surface beside the columns."""
    has = [
        (number == lens.stop, "stop"),
        (any(surface.even) or any(surface.odd), "aspheric terms"),
        (surface.figure is not None, "not of revolution"),
        (surface.hole > 0.0, "hole"),
        (any(own.before == number for own in lens.breaks), "coordinate break before it"),
    ]
    edge = surface.mechanical_semi_diameter
    return [text for is_so, text in has if is_so] + ([] if edge is None else [f"mechanical semi-diameter {edge:.5g}"])
