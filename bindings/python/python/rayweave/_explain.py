"""Explanations of answers, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Operand:
    """An operand of a decision, with its answer."""

    node: str
    """Its name, without the complement."""
    complemented: bool
    """Whether the decision uses its complement."""
    before: int
    """Its own value until t: 1 inside, 0 outside; for a choice among regions the number of the region."""
    after: int
    """Its own value just after t."""
    t: float
    """The time of its next change; inf if there is none."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A shape that was queried, or a node of the tree that decided from the answers of its two operands."""

    node: str
    """Its name, without the complement."""
    depth: int
    """Its depth below the root of the tree."""
    rule: int | None
    """The rule that decided: 1, 3 or 4; None for a shape."""
    verdict: Literal["leaf", "settled", "changes", "ask again"]
    """The outcome: the answer of a shape, a final value, a change at t, or none, so that operands are queried again."""
    before: int
    """The value until t: 1 inside, 0 outside; for a choice among regions the number of the region."""
    after: int
    """The value just after t."""
    t: float
    """The time of the change, or of the event that changes nothing; inf if nothing ever changes."""
    face: str | None
    """The face through which a shape is entered or left."""
    operands: tuple[Operand, ...]
    """The two operands of a node; none for a shape."""
    text: str
    """The same as a sentence."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """One query to the whole model: the next crossing after t_min."""

    t_min: float
    """The time from which the query starts."""
    entries: tuple[Entry, ...]
    """The steps in order, operands before their nodes, without parts that are known never to change again."""
    repeated: int
    """The number of omitted steps about such parts."""
    left_out: int
    """The number of further steps, which were not kept."""
    before: str
    """The region until t."""
    after: str
    """The region just after t."""
    t: float
    """The time of the next change of region; inf if there is none."""


@dataclass(frozen=True, kw_only=True)
class Passage:
    """A crossing, with names."""

    t: float
    """The time t, in units of the ray's direction."""
    before: str
    """The region before."""
    after: str
    """The region after."""
    face: str
    """The face that is crossed."""
