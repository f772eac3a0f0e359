"""In which order episodes are carried out, and where: what is finished is passed over.

The rows do not depend on the order, nor on how many workers there are. A block is finished before the next is
begun where it is to be decided after each block whether there are enough.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cleancli.experiment.episode import Episode, Finished, carried_out, loaded_domain
from cleancli.experiment.series import Block, OpenedStudy, Series
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.recording.fitting import check_evidence
from cleancli.study.model import Study
from cleancli.study.row import Row

Known = Mapping[str, Finished]
"""Finished episodes by their keys."""


@dataclass(frozen=True, slots=True)
class GivenUp:
    """An episode that no worker finished, and why."""

    episode: Episode
    reason: str


Pool = Callable[[Sequence[Series], Known], Iterator[Finished | GivenUp]]
"""What carries out all that is not finished of some series, and gives each episode when it is over."""

Enough = Callable[[Study, Sequence[Sequence[Row]]], bool]
"""Whether these blocks of rows of a study, each of one run of every cell, are enough."""


def due(series: Series, known: Known) -> tuple[int, Evidence]:
    """The index of the first episode of a series that is not finished, and what those before it have seen;
    the series' length where all are."""
    for index, episode in enumerate(series):
        if episode.key not in known:
            return index, known[series[index - 1].key].evidence if index else NO_EVIDENCE
    return len(series), NO_EVIDENCE


def here(series: Sequence[Series], known: Known) -> Iterator[Finished]:
    """A pool that carries out one episode after the other in this process."""
    for each in series:
        index, evidence = due(each, known)
        for episode in each[index:]:
            finished = carried_out(episode, evidence)
            evidence = finished.evidence
            yield finished


def scheduled(
    studies: Sequence[OpenedStudy], known: dict[str, Finished], pool: Pool, enough: Enough | None = None
) -> Iterator[Finished | GivenUp]:
    """Carry out what is not `known` yet, which what is finished is added to. With `enough`, a study ends with
    the block after which there are enough, or with its last."""
    if enough is None:
        blocks = [block for study in studies for block in study.blocks]
        yield from _carried(tuple(each for block in blocks for each in block), known, pool)
        return
    for study in studies:
        done: list[Block] = []
        for block in study.blocks:
            yield from _carried(block, known, pool)
            done.append(block)
            if enough(study.study, _by_block(done, known)):
                break


def rows(studies: Sequence[OpenedStudy], known: Known, enough: Enough | None = None) -> tuple[Row, ...]:
    """The rows of all finished episodes of the studies, in the order of their blocks; with `enough`, those up
    to the block after which there are enough."""
    found: list[Row] = []
    for study in studies:
        done: list[Block] = []
        for block in study.blocks:
            done.append(block)
            if enough is not None and enough(study.study, _by_block(done, known)):
                break
        found += (row for block in _by_block(done, known) for row in block)
    return tuple(found)


def number_due(studies: Iterable[OpenedStudy], known: Known) -> int:
    """How many episodes are not finished, each counted once."""
    keys = {e.key for study in studies for block in study.blocks for each in block for e in each}
    return len(keys - known.keys())


def _carried(
    series: Sequence[Series], known: dict[str, Finished], pool: Pool
) -> Iterator[Finished | GivenUp]:
    """Series that are the same in several studies are carried out once."""
    different = tuple({each[-1].key: each for each in series if due(each, known)[0] < len(each)}.values())
    for each in different:
        index, evidence = due(each, known)
        if index:
            _refuse_other_evidence(each[index], evidence)
    for finished in pool(different, known):
        if isinstance(finished, Finished):
            known[finished.row.key] = finished
        yield finished


def _refuse_other_evidence(episode: Episode, evidence: Evidence) -> None:
    try:
        check_evidence(evidence, loaded_domain(episode.texts.domain).model)
    except ValueError as error:
        message = f"what episode {episode.before[:12]} has seen is none of its domain: {error}"
        raise Refused([Diagnostic("E702", message, None)]) from None


def _by_block(blocks: Iterable[Block], known: Known) -> list[list[Row]]:
    """The rows of what is finished of each block, as those of its episodes: another study may have carried
    them out."""
    return [
        [
            _row_of(episode, known[episode.key].row)
            for series in block
            for episode in series
            if episode.key in known
        ]
        for block in blocks
    ]


def _row_of(episode: Episode, row: Row) -> Row:
    return replace(
        row,
        study=episode.study,
        part=episode.part,
        axes=dict(episode.axes),
        run=episode.run,
        episode=episode.number,
    )
