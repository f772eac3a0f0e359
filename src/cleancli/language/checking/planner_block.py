"""The `planner` block of a problem: which planner it asks for, and how hard that should try."""

from __future__ import annotations

from cleancli.language import syntax
from cleancli.language.checking.settings import settings_by_key
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.record import Record

KEYS = {
    "name": "the planner to use",
    "samples": "how many plans it tries, a whole number",
    "seed": "the seed of its randomness, a whole number",
}
"""The settings of the block, and what each means."""

_MOST = {"samples": 10_000_000, "seed": 2**32 - 1}


class PlannerOptions(Record):
    """What a problem asks of the planner, None where it does not; names of planners are not known here."""

    name: str | None = None
    samples: int | None = None
    seed: int | None = None


def check_planner(node: syntax.Planner, findings: Findings) -> PlannerOptions:
    """The settings of the block (E216, E502, E504, E505)."""
    settings = settings_by_key(node.settings, KEYS, findings)
    return PlannerOptions(
        _word(settings.get("name"), findings),
        _whole(settings.get("samples"), 1, findings),
        _whole(settings.get("seed"), 0, findings),
    )


def _word(setting: syntax.Setting | None, findings: Findings) -> str | None:
    if setting is None:
        return None
    if isinstance(setting.value, syntax.Word | syntax.Quoted):
        return setting.value.text
    findings.error("E504", "`name` wants the name of a planner", setting.value.span)
    return None


def _whole(setting: syntax.Setting | None, low: int, findings: Findings) -> int | None:
    if setting is None:
        return None
    value, key = setting.value, setting.key.text
    if not isinstance(value, syntax.Quantity) or value.unit is not None or value.value.denominator != 1:
        findings.error("E504", f"`{key}` wants a whole number", value.span)
        return None
    if not low <= value.value <= _MOST[key]:
        findings.error("E505", f"`{key}` lies between {low} and {_MOST[key]}", value.span)
        return None
    return int(value.value)
