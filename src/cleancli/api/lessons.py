"""What experience says about a domain's probabilities: the new text, and what it rests on."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from cleancli.api.checks import check_one_of, check_seconds
from cleancli.api.experience_paths import experience_files
from cleancli.api.inputs import GivenDomain, LoadedDomain, load_domain, refuse_learning_pddl
from cleancli.api.learned import (
    ActionCorrection,
    ActionDuration,
    Change,
    FoundChange,
    LearnedOutcome,
    LearnedRule,
    LearningResult,
    check_writable,
)
from cleancli.language.checking.learned import LARGEST_M, MOST_FORGETTING
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.load import checked_domain, located_in
from cleancli.language.model import Domain, Experience, Knowledge
from cleancli.language.printing.learned_edits import learned_edits
from cleancli.learning.changes import changes
from cleancli.learning.edits import edits, is_written
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.evidence import Evidence
from cleancli.learning.gathered import Origin, gather
from cleancli.learning.learn import Learned, Lesson, counted, learned_from
from cleancli.learning.match import outcomes_of, rule_name
from cleancli.learning.method import DEFAULT, MATCHES, Method
from cleancli.planning.plan import BadOption
from cleancli.resources import shipped


def learn(
    domain: GivenDomain,
    *experience: str | Path,
    estimator: str | None = None,
    m: float | None = None,
    match: str | None = None,
    forgetting: float | None = None,
    add: bool = False,
    replace: bool = False,
    write: bool = False,
) -> LearningResult:
    """Learn a domain's probabilities from experience files or run folders. Nothing is written unless asked
    for: by `write`, or by the result's method of that name.

    `match` says what a transition counts for that several outcomes may have made: "shared", for each as much
    as it is likely to have; "strict", for the likeliest, which must be right about all objects (§5). With
    `forgetting`, an example counts for less by that share than the next one of its rule. What is not said is
    as the domain's `learned` block says, or as usual. With `add`, what the text has counted counts on; with
    `replace`, it may be dropped.

    Raises Refused for mistakes in the texts and in the experience, ValueError for what makes no sense, and
    OSError.
    """
    counting = Counting(estimator, m, match, forgetting, add, replace)
    if not experience:
        raise BadOption("name experience files or run folders to learn from")
    loaded, is_writable = load_domain(domain), is_own_file(domain)
    if write:
        check_writable(loaded.sources[0], is_writable)
    result = lessons(loaded, [Path(each) for each in experience], counting, is_writable)
    if write:
        result.write()
    return result


def is_own_file(domain: GivenDomain) -> bool:
    """Whether it is a file that the user has named, or that does not ship with cleancli."""
    if isinstance(domain, LoadedDomain):
        path = Path(domain.sources[0].path)
        return path.is_file() and not path.resolve().is_relative_to(shipped("domains").resolve())
    return "{" not in str(domain) and Path(domain).is_file()


@dataclass(frozen=True, slots=True)
class Counting:
    """How to learn: the parts of `method` that are None are those that the domain's text names, or the usual
    ones. `adding`: what the text has counted counts on, and experience that it has counted is passed over;
    `replacing`: it may be dropped. Raises BadOption for what makes no sense."""

    estimator: str | None = None
    m: float | None = None
    match: str | None = None
    forgetting: float | None = None
    adding: bool = False
    replacing: bool = False

    def __post_init__(self) -> None:
        check_one_of("estimator", self.estimator, tuple(ESTIMATORS))
        check_one_of("match", self.match, MATCHES)
        check_seconds("m", self.m, none_of_it=True, most=LARGEST_M)
        check_seconds("forgetting", self.forgetting, none_of_it=True, most=MOST_FORGETTING)

    def method(self, domain: Domain) -> Method:
        """What is asked for, or what the domain's numbers were learned with, or what is usual."""
        noted = DEFAULT if domain.learned is None else method_of(domain.learned)
        return Method(
            noted.estimator if self.estimator is None else self.estimator,
            noted.m if self.m is None else self.m,
            noted.match if self.match is None else self.match,
            noted.forgetting if self.forgetting is None else self.forgetting,
        )


def lessons(
    domain: LoadedDomain,
    experience: Sequence[Path],
    counting: Counting,
    is_writable: bool,
    include_outside: bool = False,
) -> LearningResult:
    """What was learned, after the new text was checked. Raises Refused, OSError."""
    refuse_learning_pddl(domain)
    model, method = domain.model, counting.method(domain.model)
    files, passed_over = experience_files(experience, model)
    with located_in(*domain.sources):
        gathered = gather(model, files, method.is_strict, counting.adding, counting.replacing)
        lesson = learned_from(model, gathered.evidence, method, counting.adding)
    notes = [*passed_over, *gathered.notes, *_counted_twice(model, gathered.counted)]
    if model.learned is None and not counting.adding and any(map(any, counted(model).values())):
        notes.append("the text does not say which experience its counts came from: they are replaced")
    rests_on = knowledge(method, gathered.experience)
    changes = rule_changes(model, lesson, gathered.evidence, gathered.origins)
    return taught(domain, lesson, rests_on, changes, notes, is_writable, include_outside)


def _counted_twice(model: Domain, again: Evidence) -> Iterator[str]:
    """That numbers are learned from experience that they are the shares of: those of rules that were learned
    whole, which note no counts though the text names what was counted."""
    counts = [outcome.seen for rule in model.rules for outcome in rule.outcomes]
    counts += [parameter.seen for parameter in model.parameters]
    if all(seen is None for seen in counts) and any(rule is not None for rule in again.examples()):
        yield (
            "the rules were learned whole from experience that is given again, and it counts twice: as what"
            " they say, and as examples; --add counts new experience alone"
        )


def rule_changes(
    model: Domain, lesson: Lesson, evidence: Evidence, origins: Sequence[Origin]
) -> tuple[FoundChange, ...]:
    """The rules that began to do something else in the course of the evidence, which is of these origins."""
    ends = list(accumulate(each.transitions for each in origins))
    found = []
    for each in changes(evidence, lesson.beliefs):
        place = bisect_right(ends, each.transition)
        origin, before = origins[place], ends[place] - origins[place].transitions
        number = origin.first + each.transition - before
        name = rule_name(model, each.rule)
        found.append(FoundChange(name, origin.name, number, each.p, each.before, each.after))
    return tuple(found)


def knowledge(method: Method, experience: Sequence[Experience]) -> Knowledge:
    """What a domain's text says that its counts rest on."""
    estimator = method.estimator.replace("-", "_")
    return Knowledge(estimator, method.m, method.match, tuple(experience), method.forgetting)


def method_of(noted: Knowledge) -> Method:
    """How the numbers of a domain's text were learned."""
    return Method(noted.estimator.replace("_", "-"), noted.m, noted.match, noted.forgetting)


def taught(
    domain: LoadedDomain,
    lesson: Lesson,
    rests_on: Knowledge,
    changes: tuple[FoundChange, ...],
    notes: Sequence[str],
    is_writable: bool,
    include_outside: bool = False,
) -> LearningResult:
    """What was learned, after the new text was checked. Raises Refused, OSError."""
    model, sources = domain.model, domain.sources
    learned = lesson.rules
    changed = (
        *edits(model, sources, learned, lesson.durations),
        *learned_edits(model, sources[0], rests_on),
    )
    texts = edited(sources, changed)
    checked_domain(texts[sources[0].path], include_outside, lambda file: texts[str(file)]).get()
    transitions = sum(each.transitions for each in rests_on.experience)
    return LearningResult(
        tuple(_rule(model, entry) for entry in learned),
        tuple(
            ActionDuration(each.action, each.prior, each.seconds, float(each.seen), each.spread)
            for each in lesson.durations
        ),
        tuple(
            ActionCorrection(each.action, round(each.factor, 4), float(each.seen), each.spread)
            for each in lesson.corrections
        ),
        changes,
        tuple(Change(source.path, source.text, texts[source.path].text) for source in sources),
        (*notes, *_notes(model, learned, transitions), *map(str, changes)),
        is_writable,
    )


def edited(sources: Sequence[Source], changes: Sequence[Edit]) -> dict[str, Source]:
    """The texts of the domain, with those that it includes, after the edits of each."""
    return {
        source.path: Source(
            source.path,
            apply_edits(source.text, [edit for edit in changes if edit.span.path == source.path]),
        )
        for source in sources
    }


def _notes(model: Domain, learned: Sequence[Learned], transitions: int) -> Iterator[str]:
    """What the estimates rest on, and what no rule or outcome accounts for."""
    has_default = all(map(is_written, model.default))
    of_rules = [entry for entry in learned if entry.rule is not None or has_default]
    examples = sum(_examples(entry) + entry.unexplained for entry in of_rules)
    yield (
        f"{plural(transitions, 'transition')}, {plural(examples, 'example')}"
        f" for {len(of_rules)} of {plural(len(model.rules) + has_default, 'rule')}"
    )
    for entry in learned:
        if entry.rule is None and not has_default:
            uncovered = _examples(entry) + entry.unexplained
            yield (
                f"{plural(uncovered, 'transition')} that no rule covers: the domain has no `default`, and so"
                " expects nothing to happen there"
            )
        if entry.unexplained:
            yield (
                f"{rule_name(model, entry.rule)}: {plural(entry.unexplained, 'result')} that no outcome"
                " explains, and no noise outcome to count them to"
            )


def _rule(model: Domain, entry: Learned) -> LearnedRule:
    outcomes = outcomes_of(model, entry.rule)
    return LearnedRule(
        rule_name(model, entry.rule),
        _examples(entry),
        entry.unexplained,
        tuple(
            LearnedOutcome(outcome.kind.value, float(prior), float(probability), float(seen))
            for outcome, prior, probability, seen in zip(
                outcomes, entry.priors, entry.probabilities, entry.seen, strict=True
            )
        ),
    )


def _examples(entry: Learned) -> int:
    """Those that outcomes explain."""
    return round(sum(entry.seen))
