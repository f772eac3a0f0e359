"""What experience says about a domain's probabilities: the new text, and what it rests on."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.checks import check_one_of, check_seconds
from cleancli.api.inputs import GivenDomain, LoadedDomain, load_domain
from cleancli.api.plain import plain
from cleancli.api.tables import TextTable, preformatted, shown
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.load import checked_domain, located_in
from cleancli.language.model import Domain
from cleancli.learning.edits import edits, is_written
from cleancli.learning.estimate import DEFAULT_M, ESTIMATORS
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.learn import Learned
from cleancli.learning.learn import learn as learned_from
from cleancli.learning.match import outcomes_of
from cleancli.learning.method import MATCHES, Method
from cleancli.planning.plan import BadOption
from cleancli.recording.folder import EXPERIENCE, check_folder
from cleancli.resources import shipped

_NO_FILE = "`{}` ships with cleancli or is a text: copy it to a file, and learn into your copy"


@dataclass(frozen=True, slots=True)
class LearnedOutcome:
    """An outcome's probability before anything was learned and now, and its examples, of which several
    outcomes may share one."""

    kind: str
    prior: float
    probability: float
    seen: float


@dataclass(frozen=True, slots=True)
class LearnedRule:
    """What was learned of a rule ("default": of the default rule); `unexplained` examples fit no outcome."""

    rule: str
    examples: int
    unexplained: int
    outcomes: tuple[LearnedOutcome, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """The text of a file before and after."""

    path: str
    before: str
    after: str

    @property
    def lines(self) -> Iterator[str]:
        """A unified diff, without line ends."""
        old, new = self.before.splitlines(), self.after.splitlines()
        return difflib.unified_diff(old, new, self.path, f"{self.path} (learned)", lineterm="")


@dataclass(frozen=True, slots=True)
class LearningResult:
    """What was learned; `changes` holds the domain's text first, then those that it includes. It
    `is_writable` where the domain is a file of the user's own."""

    rules: tuple[LearnedRule, ...]
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    is_writable: bool

    @property
    def text(self) -> str:
        """The domain's new text."""
        return self.changes[0].after

    @property
    def diff(self) -> str:
        """What would change, as a unified diff."""
        return "\n".join(line for change in self.changes for line in change.lines)

    def write(self, last: LearningResult | None = None) -> tuple[str, ...]:
        """Put the new probabilities into the files, all of them or none, and return which were written.

        `last` is what was learned and written of the same domain before. Raises Refused (E006) where one was
        edited meanwhile, ValueError for a domain that is no file of the user's own, and OSError.
        """
        if not self.is_writable:
            raise BadOption(_NO_FILE.format(self.changes[0].path))
        written = self.changes if last is None else last.changes
        stands = [change.before if last is None else change.after for change in written]
        replaced = [
            Replacement(Path(change.path), change.after, text)
            for change, text in zip(self.changes, stands, strict=True)
            if text != change.after
        ]
        write_all(replaced)
        return tuple(str(each.path) for each in replaced)

    def to_dict(self) -> dict[str, object]:
        """`rules` is the same as `cleancli learn --json` prints."""
        return {"rules": plain(self.rules)}

    def __str__(self) -> str:
        return "\n".join(part for part in (self.diff, *self.notes) if part)

    def _repr_html_(self) -> str:
        told = "".join(f"<p>{shown(note)}</p>" for note in self.notes)
        return f"<div>{self.table().html()}{told}{preformatted(self.diff)}</div>"

    def table(self) -> TextTable:
        """A row for each outcome of each rule that something was learned of."""
        heads = ("rule", "outcome", "prior", "probability", "seen")
        rows = (
            (rule.rule, outcome.kind, f"{outcome.prior:g}", f"{outcome.probability:g}", f"{outcome.seen:g}")
            for rule in self.rules
            for outcome in rule.outcomes
        )
        return TextTable(heads, tuple(rows), (0, 1))


def learn(
    domain: GivenDomain,
    *experience: str | Path,
    estimator: str = "decreasing-m",
    m: float = DEFAULT_M,
    match: str = "shared",
    write: bool = False,
) -> LearningResult:
    """Learn a domain's probabilities from experience files or run folders. Nothing is written unless asked
    for: by `write`, or by the result's method of that name.

    `match` says what a transition counts for that several outcomes may have made: "shared", for each as much
    as it is likely to have; "strict", for the likeliest, which must be right about all objects (§5).

    Raises Refused for mistakes in the texts and in the experience, ValueError for what makes no sense, and
    OSError.
    """
    check_one_of("estimator", estimator, tuple(ESTIMATORS))
    check_one_of("match", match, MATCHES)
    check_seconds("m", m, none_of_it=True)
    if not experience:
        raise BadOption("name experience files or run folders to learn from")
    loaded, is_writable = load_domain(domain), is_own_file(domain)
    if write and not is_writable:
        raise BadOption(_NO_FILE.format(loaded.sources[0].path))
    result = lessons(loaded, [Path(each) for each in experience], Method(estimator, m, match), is_writable)
    if write:
        result.write()
    return result


def is_own_file(domain: GivenDomain) -> bool:
    """Whether it is a file that the user has named, or that does not ship with cleancli."""
    if isinstance(domain, LoadedDomain):
        path = Path(domain.sources[0].path)
        return path.is_file() and not path.resolve().is_relative_to(shipped("domains").resolve())
    return "{" not in str(domain) and Path(domain).is_file()


def lessons(
    domain: LoadedDomain,
    experience: Sequence[Path],
    method: Method,
    is_writable: bool,
    include_outside: bool = False,
) -> LearningResult:
    """What was learned, after the new text was checked. Raises Refused, OSError."""
    transitions = _Transitions(experience, domain.model)
    with located_in(*domain.sources):
        learned = learned_from(domain.model, transitions.each(), method).rules
    return taught(domain, learned, transitions.number, is_writable, include_outside)


def taught(
    domain: LoadedDomain,
    learned: Sequence[Learned],
    transitions: int,
    is_writable: bool,
    include_outside: bool = False,
) -> LearningResult:
    """What so many transitions taught, after the new text was checked. Raises Refused, OSError."""
    model, sources = domain.model, domain.sources
    texts = _edited(sources, edits(model, sources, learned))
    checked_domain(texts[sources[0].path], include_outside, lambda file: texts[str(file)]).get()
    return LearningResult(
        tuple(_rule(model, entry) for entry in learned),
        tuple(Change(source.path, source.text, texts[source.path].text) for source in sources),
        tuple(_notes(model, learned, transitions)),
        is_writable,
    )


class _Transitions:
    """Those of some files, as they are read; `number` is how many there were."""

    def __init__(self, files: Sequence[Path], domain: Domain) -> None:
        self._files, self._domain = tuple(map(_experience_file, files)), domain
        self.number = 0

    def each(self) -> Iterator[Transition]:
        """Read all, one after the other. Raises Refused."""
        for file in self._files:
            for transition in read_experience(file, self._domain):
                self.number += 1
                yield transition


def _edited(sources: Sequence[Source], changes: Sequence[Edit]) -> dict[str, Source]:
    """The texts of the domain, with those that it includes, after the edits of each."""
    return {
        source.path: Source(
            source.path,
            apply_edits(source.text, [edit for edit in changes if edit.span.path == source.path]),
        )
        for source in sources
    }


def _experience_file(path: Path) -> Path:
    """Raises Refused (E705) for a run's folder that is not as a run leaves it."""
    if not path.is_dir():
        return path
    check_folder(path)
    return path / EXPERIENCE


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
                f"{_rule_name(model, entry)}: {plural(entry.unexplained, 'result')} that no outcome explains,"
                " and no noise outcome to count them to"
            )


def _rule(model: Domain, entry: Learned) -> LearnedRule:
    outcomes = outcomes_of(model, entry.rule)
    return LearnedRule(
        _rule_name(model, entry),
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
    return int(sum(entry.seen))


def _rule_name(model: Domain, entry: Learned) -> str:
    return "default" if entry.rule is None else model.rules[entry.rule].name
