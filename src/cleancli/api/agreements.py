"""Whether experience agrees with what a domain's text says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.experience_paths import experience_files
from cleancli.api.inputs import LoadedDomain
from cleancli.api.lessons import Counting
from cleancli.api.plain import plain
from cleancli.api.tables import TextTable
from cleancli.language.load import located_in
from cleancli.learning.gathered import gather
from cleancli.learning.match import rule_name


@dataclass(frozen=True, slots=True)
class RuleAgreement:
    """How likely a rule's examples are to differ so much from its probabilities by chance: `p` of a
    likelihood-ratio test; `agrees` unless that is too unlikely for so many rules."""

    rule: str
    examples: int
    statistic: float
    freedom: int
    p: float
    agrees: bool


@dataclass(frozen=True, slots=True)
class AgreementResult:
    """A row for each rule with examples, and what a person should know of the files."""

    rules: tuple[RuleAgreement, ...]
    notes: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether all rules do."""
        return all(rule.agrees for rule in self.rules)

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli learn --check --json` prints."""
        return {"agrees": self.agrees, "rules": plain(self.rules)}

    def table(self) -> TextTable:
        """A row for each rule."""
        rows = tuple(
            (
                rule.rule,
                str(rule.examples),
                f"{rule.statistic:z.1f}",
                str(rule.freedom),
                f"{rule.p:z.2g}",
                "yes" if rule.agrees else "no",
            )
            for rule in self.rules
        )
        return TextTable(("rule", "examples", "statistic", "freedom", "p", "agrees"), rows, (0, 5))

    def __str__(self) -> str:
        return "\n".join((str(self.table()), *self.notes))

    def _repr_html_(self) -> str:
        return self.table().html()


def agreement(domain: LoadedDomain, experience: Sequence[Path], counting: Counting) -> AgreementResult:
    """Compare the text's probabilities, whatever they rest on, with experience. Raises Refused, OSError."""
    from cleancli.learning.agreement import agreements, disagreeing  # scipy, which nobody else here needs

    model = domain.model
    files, passed_over = experience_files(experience, model)
    with located_in(*domain.sources):
        gathered = gather(model, files, counting.method(model).is_strict, adding=False, replacing=True)
    found = agreements(model, gathered.evidence)
    wrong = disagreeing(found)
    rules = tuple(
        RuleAgreement(
            rule_name(model, each.rule),
            each.examples,
            each.statistic,
            each.freedom,
            each.p,
            each not in wrong,
        )
        for each in found
    )
    return AgreementResult(rules, (*passed_over, *gathered.notes))
