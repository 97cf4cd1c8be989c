"""How an answer comes about, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Operand:
    """An operand of a decision, with its answer."""

    node: str
    """What it is called, its complement not counted."""
    complemented: bool
    """Whether the decision takes its complement."""
    before: int
    """Its own value until t: 1 inside, 0 outside; for a choice among regions the number of the region."""
    after: int
    """Its own value just after t."""
    t: float
    """When it changes next; inf if it never does."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A shape that was queried, or a node of the tree that decided from the answers of its two operands."""

    node: str
    """What it is called, its complement not counted."""
    depth: int
    """How far it lies below the root of the tree."""
    rule: int | None
    """The rule that decided: 1, 3 or 4; None for a shape."""
    verdict: Literal["leaf", "settled", "changes", "ask again"]
    """What came of it: a shape's answer, a value for good, a change at t, or no change at t, so that operands are queried again."""
    before: int
    """The value until t: 1 inside, 0 outside; for a choice among regions the number of the region."""
    after: int
    """The value just after t."""
    t: float
    """The time of the change, or of what changes nothing; inf if nothing ever changes."""
    face: str | None
    """The face through which a shape is entered or left."""
    operands: tuple[Operand, ...]
    """The two operands of a node; none for a shape."""
    text: str
    """The same as a sentence."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """One question to the whole model: what is next after t_min?"""

    t_min: float
    """The time from which the query starts."""
    entries: tuple[Entry, ...]
    """What happened, in order: operands before their nodes; nothing about parts that are known never to change again."""
    repeated: int
    """How many more there were about parts that are known."""
    left_out: int
    """How many more there were than are kept."""
    before: str
    """The region until t."""
    after: str
    """The region just after t."""
    t: float
    """When the region changes next; inf if it never does."""


@dataclass(frozen=True, kw_only=True)
class Passage:
    """A crossing, with names."""

    t: float
    """When, in units of the ray's direction."""
    before: str
    """The region before."""
    after: str
    """The region after."""
    face: str
    """The face that is crossed."""
