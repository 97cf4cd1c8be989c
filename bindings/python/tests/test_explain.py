"""Explanations: the same crossings, and every decision consistent with its operands."""

from pathlib import Path

import numpy as np
import pytest

import rayweave

CHAIN = Path(__file__).parents[3] / "models" / "chain.toml"


def chain() -> rayweave.Explanation:
    model = rayweave.load(CHAIN, {"s": 0})
    return model.explain([-60, 0, 0], [120, 0, 0])


def test_the_explanation_of_the_chain() -> None:
    explanation = chain()
    text = str(explanation)
    assert "s1 | s2 stays inside at 0.204167: s1 is left, but the ray is inside s2 until 0.3125. So s1 is queried again. (rule 4)" in text
    assert "At t = 0.9625 it passes from chain into the world, through s8.side.\n" in text
    assert text == explanation.story() == explanation.story(None)
    assert repr(explanation) == "<Explanation: 3 questions, 93 steps, 2 crossings>"
    assert "more questions are left out" in explanation.story(2)
    with pytest.raises(rayweave.RayweaveError, match="lines is 0"):
        explanation.story(0)


def test_records_of_the_chain() -> None:
    explanation = chain()
    assert explanation.start == "the world"
    assert [(p.before, p.after, p.face) for p in explanation.crossings] == [
        ("the world", "chain", "s1.side"),
        ("chain", "the world", "s8.side"),
    ]
    np.testing.assert_allclose([p.t for p in explanation.crossings], [4.5 / 120, 115.5 / 120], rtol=1e-15)
    first = explanation.questions[0]
    assert (first.t_min, first.before, first.after, first.t) == (-np.inf, "the world", "chain", explanation.crossings[0].t)
    assert first.entries[0].node == "s1" and first.entries[0].verdict == "leaf"
    assert first.entries[0].rule is None and first.entries[0].face == "s1.side"
    assert first.entries[0].text == "s1 is entered at 0.0375, through s1.side."
    assert sum(len(question.entries) + question.repeated for question in explanation.questions) == explanation.steps == 93
    assert [question.left_out for question in explanation.questions] == [0, 0, 0]
    assert explanation.questions is explanation.questions


def test_decisions_follow_from_their_operands() -> None:
    """The rule for the unions of the chain: a point inside either operand is inside."""
    seen = set()
    for question in chain().questions:
        for entry in question.entries:
            seen.add(entry.rule)
            if entry.rule is None:
                assert entry.operands == ()
                continue
            a, b = entry.operands
            t = min(a.t, b.t)
            value = [x.after if x.t == t else x.before for x in (a, b)]
            if entry.rule == 1:
                assert entry.verdict == "settled" and np.isinf(entry.t)
                assert (entry.before, a.before, b.before) == (0, 0, 0)
            else:
                assert entry.t == t and entry.before == max(a.before, b.before)
                assert (entry.rule == 3) == (max(value) != entry.before)
                assert entry.verdict == ("changes" if entry.rule == 3 else "ask again")
                assert entry.after == max(value)
    assert seen == {None, 1, 3, 4}


def test_a_solid_and_its_window() -> None:
    shell = rayweave.sphere(2).named("ball") - rayweave.sphere(1).named("core")
    explanation = shell.explain((-5, 0, 0), (1, 0, 0), 3.5, 6.5)
    assert [p.t for p in explanation.crossings] == [4.0, 6.0]
    assert explanation.start != "the world"
    times = shell.crossings((-5, 0, 0), (1, 0, 0), 3.5, 6.5).t
    np.testing.assert_array_equal([p.t for p in explanation.crossings], times)
    operands = [operand for question in explanation.questions for entry in question.entries for operand in entry.operands]
    assert {(operand.node, operand.complemented) for operand in operands} == {("ball", False), ("core", True)}


@pytest.mark.parametrize(
    ("origin", "direction", "problem"),
    [
        ([0, 0], [1, 0, 0], "origin has 2 numbers"),
        ([0, 0, np.nan], [1, 0, 0], r"origin\[2\] is NaN"),
        ([0, 0, 0], [0, 0, 0], "direction has length 0"),
        ([1e200, 0, 0], [1, 0, 0], "beyond 1e100"),
        ([0, 0, 0], [1e-200, 0, 0], "below 1e-100"),
    ],
)
def test_bad_rays(origin: list[float], direction: list[float], problem: str) -> None:
    with pytest.raises(rayweave.RayweaveError, match=problem):
        rayweave.sphere(1).explain(origin, direction)


def test_bad_windows() -> None:
    with pytest.raises(rayweave.RayweaveError, match="empty or reversed"):
        rayweave.sphere(1).explain([0, 0, 0], [1, 0, 0], 2, 1)
