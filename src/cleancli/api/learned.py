"""What was learned of a domain, as it is told, and written into its files."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.plain import plain
from cleancli.api.tables import TextTable, preformatted, shown
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Source, printable
from cleancli.planning.plan import BadOption

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
class ActionDuration:
    """Seconds of robot time that an action was taken to last and takes now, how often it was timed, and the
    standard deviation of the times that were given."""

    action: str
    prior: float
    seconds: float
    seen: float
    spread: float


@dataclass(frozen=True, slots=True)
class ActionCorrection:
    """By how much longer an action takes than the table expects of it for the areas where they lie, how many
    executions count, and the standard deviation of what they took in proportion."""

    action: str
    factor: float
    seen: float
    spread: float


@dataclass(frozen=True, slots=True)
class FoundChange:
    """That a rule does something else from a transition of some experience on, by the transition's number
    there. So much would be found by chance with probability `p`. `before` and `after` are the shares of its
    outcomes in the examples before and after, up to the changes of the rule that come next."""

    rule: str
    experience: str
    transition: int
    p: float
    before: tuple[float, ...]
    after: tuple[float, ...]

    def __str__(self) -> str:
        before, after = (" ".join(f"{share:z.2f}" for share in part) for part in (self.before, self.after))
        return (
            f"{self.rule} does something else since transition {self.transition} of"
            f" {printable(self.experience)} (p = {self.p:z.1g}): its outcomes had {before} before, and"
            f" {after} since then; --forgetting lets old examples fade"
        )


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


class Rewritten:
    """The texts of a domain before and after something was learned; the domain's own is the first of the
    `changes`. It `is_writable` where the domain is a file of the user's own."""

    __slots__ = ()

    changes: tuple[Change, ...]
    is_writable: bool

    @property
    def text(self) -> str:
        """The domain's new text."""
        return self.changes[0].after

    @property
    def diff(self) -> str:
        """What would change, as a unified diff."""
        return "\n".join(line for change in self.changes for line in change.lines)

    def write(self, last: Rewritten | None = None) -> tuple[str, ...]:
        """Put what was learned into the files, into all of them or none, and return which were written.

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

    def write_copy(self, path: Path) -> None:
        """Write the domain's new text into a new file, and leave the domain as it is.

        Raises Refused (E006) where the file exists, ValueError where what the domain includes would change
        as well, and OSError.
        """
        included = [change.path for change in self.changes[1:] if change.before != change.after]
        if included:
            raise BadOption(
                f"what was learned is in {', '.join(included)} too: copy all files and use --write"
            )
        write_all([Replacement(path, self.text, None)])


@dataclass(frozen=True, slots=True)
class LearningResult(Rewritten):
    """What was learned of a domain's numbers."""

    rules: tuple[LearnedRule, ...]
    durations: tuple[ActionDuration, ...]
    corrections: tuple[ActionCorrection, ...]
    rule_changes: tuple[FoundChange, ...]
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    is_writable: bool

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli learn --json` prints."""
        return {
            "rules": plain(self.rules),
            "durations": plain(self.durations),
            "corrections": plain(self.corrections),
            "rule_changes": plain(self.rule_changes),
        }

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


def check_writable(domain: Source, is_writable: bool) -> None:
    """Raise BadOption where what is learned cannot be written into the domain's text."""
    if not is_writable:
        raise BadOption(_NO_FILE.format(domain.path))
