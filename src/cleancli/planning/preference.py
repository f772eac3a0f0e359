"""Which of two ways to go on is preferred (docs/decisions/0009).

First the one of greater value. Of equals the one whose success comes sooner, by its earliness: the expected
sum over its steps of their progress (compiler/semantics.py), not discounted, times the steps that are left
when the step begins. Of equals in both, whoever asks keeps what he has: stopping before acting, then the
first."""

from __future__ import annotations

AS_GOOD = 1e-9
"""What is better by no more than this is as good."""


def preferred(value: float, earliness: float, other_value: float, other_earliness: float) -> bool:
    """Whether the first is better than the other; compiled code has it as `better`."""
    return value > other_value + AS_GOOD or (
        value >= other_value - AS_GOOD and earliness > other_earliness + AS_GOOD
    )
