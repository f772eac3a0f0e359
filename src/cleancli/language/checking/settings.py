"""Settings in blocks whose keys are a few known words."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from cleancli.language import syntax
from cleancli.language.diagnostics.sink import Findings


def settings_by_key(
    settings: Iterable[syntax.Setting], known: Collection[str], findings: Findings
) -> dict[str, syntax.Setting]:
    """The settings by their keys, without those that are unknown (E502) or stand a second time (E216)."""
    found: dict[str, syntax.Setting] = {}
    for setting in settings:
        key = setting.key.text
        if key not in known:
            findings.unknown("E502", "setting", key, setting.key.span, known)
        elif key in found:
            help = f"the first stands in {findings.line(found[key].span)}"
            findings.error("E216", f"a second `{key}`", setting.key.span, help=help)
        else:
            found[key] = setting
    return found
