"""Conversion of models between formats."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

from rayweave._core import Model, Solid, load
from rayweave._model import Subject
from rayweave.optics import Element, System


def convert(
    source: str | PathLike[str] | Subject | System,
    target: str | PathLike[str],
    parameters: dict[str, float | str] | None = None,
    *,
    format: str | None = None,
    to: str | None = None,
    tolerance: float | None = None,
    text: bool = False,
    allow_unsound: bool = False,
    facets: bool = False,
    fonts: Sequence[str | PathLike[str]] = (),
    repair: bool = False,
    unit: str | None = None,
    allow: Sequence[str | PathLike[str]] = (),
    strict: bool = False,
) -> list[str]:
    """Write a model, or the model in the file ``source``, to the file ``target``, complete or not at all.

    The endings of the names select the formats, unless ``format`` and ``to`` name them. ``load`` describes reading,
    ``Model.save`` writing. Returns what was lost: the warnings of the reader, then those of the writer.

    >>> import rayweave
    >>> _ = rayweave.convert(rayweave.sphere(10), "ball.stl", tolerance=0.01)
    >>> rayweave.convert("ball.stl", "ball.off")[-1]
    'dropped: colours and names of faces'
    """
    if not isinstance(source, (str, PathLike)):
        if isinstance(source, Element):
            source = System([source])
        if isinstance(source, System):
            source = source.to_model()
        if isinstance(source, (Solid, Model)):
            return source.save(target, format=to, tolerance=tolerance, text=text, allow_unsound=allow_unsound)
        return Model(source).save(
            target, format=to, tolerance=tolerance, text=text, allow_unsound=allow_unsound
        )
    model = load(
        source,
        parameters,
        format=format,
        facets=facets,
        fonts=list(fonts),
        repair=repair,
        unit=unit,
        allow=list(allow),
        strict=strict,
    )
    saved = model.save(target, format=to, tolerance=tolerance, text=text, allow_unsound=allow_unsound)
    return [*model.warnings, *saved]
