"""Explanations of answers, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Operand:
    """An operand of a decision, with its answer.

    >>> import rayweave as rw
    >>> explanation = (rw.box(2) - rw.sphere(0.5)).explain([-3, 0, 0], [1, 0, 0])
    >>> decision = next(entry for entry in explanation.questions[0].entries if entry.operands)
    >>> operand = decision.operands[0]
    >>> operand.node, operand.before, operand.t
    ('box', 0, 2.0)
    """

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
    """A shape that was queried, or a node of the tree that decided from the answers of its two operands.

    >>> import rayweave as rw
    >>> question = rw.box(2).explain([-3, 0, 0], [1, 0, 0]).questions[0]
    >>> question.entries[0].node, question.entries[0].verdict, question.entries[0].t
    ('box', 'leaf', 2.0)
    """

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
    """One query to the whole model: the next crossing after t_min.

    >>> import rayweave as rw
    >>> question = rw.box(2).explain([-3, 0, 0], [1, 0, 0]).questions[0]
    >>> question.before, question.after, question.t
    ('the world', 'solid', 2.0)
    """

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
    """A crossing, with names.

    >>> import rayweave as rw
    >>> passage = rw.box(2).named("die").explain([-3, 0, 0], [1, 0, 0]).crossings[0]
    >>> passage
    Passage(t=2.0, before='the world', after='die', face='die.x-')
    """

    t: float
    """The time t, in units of the ray's direction."""
    before: str
    """The region before."""
    after: str
    """The region after."""
    face: str
    """The face that is crossed."""
