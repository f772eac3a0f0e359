"""Whole rules that were learned: the new text, and how well the rules explain transitions."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.api.learned import Change, Rewritten
from cleancli.api.plain import plain
from cleancli.api.tables import TextTable, preformatted, shown


@dataclass(frozen=True, slots=True)
class StructureScore:
    """How well rules explain transitions: the logarithm of their likelihood, the literals of the rules, what
    the two come to, and of transitions that were held out the log-likelihood of one, in the mean (None where
    none is held out): a proper score, which in expectation is best for rules that say what is so (Gneiting
    and Raftery 2007, section 3)."""

    rules: int
    literals: int
    log_likelihood: float
    score: float
    held_out_log_likelihood: float | None


@dataclass(frozen=True, slots=True)
class ActionStructure:
    """What became of the rules of an action, of which there were so many transitions; those are `kept`, by
    their names, that explain these as well as rules that were induced."""

    action: str
    transitions: int
    kept: tuple[str, ...]
    before: StructureScore
    after: StructureScore


@dataclass(frozen=True, slots=True)
class StructureResult(Rewritten):
    """The rules that were learned: a row for each action, and one of them all together."""

    actions: tuple[ActionStructure, ...]
    together: ActionStructure
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    is_writable: bool

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli learn --structure --json` prints."""
        return {
            "actions": plain(self.actions),
            "together": plain(self.together),
            "notes": list(self.notes),
        }

    def table(self) -> TextTable:
        """A row for each action, and one of all."""
        heads = (
            "action",
            "transitions",
            "rules",
            "literals",
            "log-likelihood",
            "score",
            "held out, each",
            "",
        )
        rows = (
            (
                each.action,
                str(each.transitions),
                *(
                    f"{_number(getattr(each.before, name))} -> {_number(getattr(each.after, name))}"
                    for name in ("rules", "literals", "log_likelihood", "score", "held_out_log_likelihood")
                ),
                f"{len(each.kept)} kept" if each.kept else "",
            )
            for each in (*self.actions, self.together)
        )
        return TextTable(heads, tuple(rows), (0, 7))

    def __str__(self) -> str:
        return "\n".join(part for part in (self.diff, str(self.table()), *self.notes) if part)

    def _repr_html_(self) -> str:
        told = "".join(f"<p>{shown(note)}</p>" for note in self.notes)
        return f"<div>{self.table().html()}{told}{preformatted(self.diff)}</div>"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int) else f"{value:z.1f}" if abs(value) >= 1 else f"{value:z.3f}"
