"""Texts that are damaged at random: what reads them must read them, or refuse them with places."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.refused import Refused


def damaged(text: str, pieces: Sequence[str], rng: Random) -> str:
    """The text with a few parts cut out of it, and one of the pieces in place of each."""
    for _ in range(rng.choice((1, 1, 2, 5))):
        place, length = rng.randrange(len(text) + 1), rng.choice((0, 1, 1, 3, 20))
        text = text[:place] + rng.choice(pieces) + text[place + length :]
    return text


def count_read(read: Callable[[str], object], text: str, pieces: Sequence[str], times: int, seed: int) -> int:
    """How many of so many damaged texts are read. Others are refused, and each mistake must have a place."""
    rng = Random(seed)
    count = 0
    for _ in range(times):
        spoilt = damaged(text, pieces, rng)
        places: list[Span | None] = []
        try:
            read(spoilt)
        except Refused as refused:
            places = [each.span for each in refused.diagnostics]
        else:
            count += 1
        assert None not in places, spoilt
    return count
