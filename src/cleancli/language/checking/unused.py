"""Warnings about what a domain declares and never uses.

Guaranteed before: the whole domain was checked, and `findings.used` names all that something refers to. Only
the first file is looked at: what an included file declares may be there for others.
"""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.language import syntax
from cleancli.language.checking.declarations import sections_of
from cleancli.language.diagnostics.sink import Findings

_OF_VOCABULARY = (
    "learn rules from experience by `cleancli learn --structure --vocabulary`, or write them: `rule NAME: "
    "ACTION(...) { ... }`"
)


def warn_unused(node: syntax.DomainNode, findings: Findings) -> None:
    """W201 for names that nothing refers to, W203 for actions without a rule.

    Of a vocabulary, which has actions and no rule at all, only types are told and, once, that it has no rule:
    rules that are still to be learned will use the rest.
    """
    if findings.broken or findings.errors:
        return  # what was not understood may use anything
    unused = [
        (kind, what, name)
        for kind, what, name in _declared(node)
        if (kind, name.text) not in findings.used and name.span.path == findings.source.path
    ]
    actions = [name for kind, _, name in unused if kind == "action"]
    is_vocabulary = bool(actions) and not sections_of(node.sections, syntax.RuleNode)
    if is_vocabulary:
        findings.warning("W203", "no action of this domain has a rule", actions[0].span, help=_OF_VOCABULARY)
    for kind, what, name in unused:
        if is_vocabulary and kind != "type":
            continue
        if kind == "action":
            findings.warning(
                "W203",
                f"the action `{name.text}` has no rule",
                name.span,
                help="it does what the default rule says: write `rule NAME: "
                f"{name.text}(...) {{ ... }}`, or leave it out",
            )
        else:
            findings.warning("W201", f"the {what} `{name.text}` is never used", name.span, help=_help(kind))


def _help(kind: str) -> str:
    if kind == "parameter":
        return "leave it out, unless a domain that includes this one uses it"
    return "leave it out, unless a problem's goal or a domain that includes this one uses it"


def _declared(node: syntax.DomainNode) -> Iterator[tuple[str, str, syntax.Name]]:
    """Kind, its word in messages, and name. Counts and derived predicates are for problems too."""
    for types in sections_of(node.sections, syntax.Types):
        yield from (("type", "type", name) for group in types.groups for name in group.names)
    for constants in sections_of(node.sections, syntax.Constants):
        yield from (("constant", "constant", name) for group in constants.groups for name in group.names)
    for predicates in sections_of(node.sections, syntax.Predicates):
        yield from (("symbol", "predicate", item.name) for item in predicates.predicates)
    for functions in sections_of(node.sections, syntax.Functions):
        yield from (("symbol", "function", item.name) for item in functions.functions)
    for shared in sections_of(node.sections, syntax.Shared):
        yield from (("parameter", "parameter", item.name) for item in shared.parameters)
    for actions in sections_of(node.sections, syntax.Actions):
        yield from (("action", "action", item.name) for item in actions.actions)
