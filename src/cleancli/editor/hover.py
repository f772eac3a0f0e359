"""What an editor shows over a name: its declaration, the comment beside or above it, what follows from it."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from cleancli.editor.library import Document, Library
from cleancli.editor.mistakes import model_of, model_of_problem
from cleancli.language import syntax
from cleancli.language.checking.learned import KEYS as LEARNED
from cleancli.language.checking.learned import WORDS as LEARNED_WORDS
from cleancli.language.checking.planner_block import KEYS as PLANNER
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.source_lines import LINE_END, Lines
from cleancli.language.model import Rule
from cleancli.language.printing.printer import print_fraction
from cleancli.language.refactoring.name_index import Kind, Occurrence, children
from cleancli.scene.schema import KEYS, TOP
from cleancli.study.schema import keys_of


@dataclass(frozen=True, slots=True)
class Hover:
    """Markdown about the text at a span."""

    text: str
    span: Span


def hover(asked: Document, offset: int, library: Library) -> Hover | None:
    """What there is to say about a place; None for nothing."""
    included = asked.include_at(offset)
    if included is not None:
        about = _about_domain(library.document(asked.path.parent / included.path))
        return Hover("\n\n".join(about), included.span) if about else None
    found = asked.at(offset)
    if found is None:
        return _learned(asked, offset)
    parts = tuple(_about(asked, found, library))
    return Hover("\n\n".join(parts), found.span) if parts else None


def _about(asked: Document, found: Occurrence, library: Library) -> Iterator[str]:
    kind = found.meaning.kind
    if kind is Kind.KEY:
        yield from _about_key(asked, found)
        return
    if kind is Kind.DOMAIN:
        yield from _about_domain(library.domain_of(asked))
        return
    declaration = library.declaration(asked, found.meaning)
    if declaration is None:
        return
    text = _text_of(declaration, library)
    yield _code(signature(declaration, text, asked, library))
    yield from comment(text, _whole(declaration))
    if isinstance(declaration.node, syntax.RuleNode) and kind is Kind.RULE:
        yield from _about_rule(asked, declaration.node, library)


def _about_domain(domain: Document | None) -> tuple[str, ...]:
    if domain is None or domain.root is None:
        return ()
    return (_code(f"{domain.kind} {domain.root.name.text}"), *_first_comment(domain.source.text))


def _text_of(declaration: Occurrence, library: Library) -> str:
    place = library.document(declaration.span.path)
    assert place is not None, "it was declared there"
    return place.source.text


def _whole(declaration: Occurrence) -> Span:
    return declaration.span if isinstance(declaration.node, syntax.Group) else declaration.node.span


def _code(text: str) -> str:
    return f"```nid\n{text}\n```"


# ---- declarations


def signature(declaration: Occurrence, text: str, asked: Document, library: Library) -> str:
    """A declaration in one line, as it is written but for blanks; `text` is that of its file."""
    node, meaning = declaration.node, declaration.meaning
    if isinstance(node, syntax.Group):
        variable = "?" if meaning.kind is Kind.VARIABLE else ""
        above = f" - {node.type.text}" if node.type is not None else ""
        return f"{meaning.kind.value} {variable}{meaning.name}{above}"
    if isinstance(node, syntax.RuleNode):
        is_variable = meaning.kind is Kind.VARIABLE
        return _variable_of(node, meaning.name, asked, library) if is_variable else _header(node)
    if meaning.kind is Kind.VALUE:
        return f"value {meaning.name} of " + " ".join(text[node.span.start : node.span.end].split())
    return f"{_noun(node)} " + " ".join(text[node.span.start : node.span.end].split())


def _noun(node: syntax.Node) -> str:
    match node:
        case syntax.PredicateNode():
            return "predicate"
        case syntax.FunctionNode():
            return "function"
        case syntax.ActionNode():
            return "action"
        case syntax.ParameterNode():
            return "parameter"
    return "derived"


def _header(rule: syntax.RuleNode) -> str:
    terms = ", ".join(f"?{t.name}" if t.is_variable else t.name for t in rule.terms)
    return f"rule {rule.name.text}: {rule.action.text}({terms})"


def _variable_of(rule: syntax.RuleNode, name: str, asked: Document, library: Library) -> str:
    """A variable of a rule with the type that the action gives it, where that is declared."""
    position = next((i for i, term in enumerate(rule.terms) if term.is_variable and term.name == name), 0)
    parameters = parameters_of(rule.action.text, Kind.ACTION, asked, library)
    above = f" - {parameters[position][1]}" if position < len(parameters) else ""
    return f"variable ?{name}{above}"


def parameters_of(name: str, kind: Kind, asked: Document, library: Library) -> list[tuple[str, str]]:
    """The parameters of a declared symbol or action, as (name, type)."""
    for occurrence in library.visible(asked):
        if occurrence.meaning.kind is kind and occurrence.meaning.name == name:
            groups: tuple[syntax.Group, ...] = getattr(occurrence.node, "parameters", ())
            return [(n.text, g.type.text) for g in groups if g.type is not None for n in g.names]
    return []


def comment(text: str, span: Span) -> Iterator[str]:
    """The comment behind a declaration in the line where it begins, else the comment right above it."""
    lines = Lines(text)
    number, column = lines.place(span.start)
    _, hash_sign, beside = lines.line(number)[column - 1 :].partition("#")
    if hash_sign:
        yield beside.strip()
        return
    above: list[str] = []
    while number - len(above) > 1:
        line = lines.line(number - len(above) - 1).strip()
        if not line.startswith("#"):
            break
        above.insert(0, line.lstrip("#").strip())
    if any(above):
        yield "\n".join(above).strip()


def _first_comment(text: str) -> Iterator[str]:
    """The comment that a file begins with."""
    lines = itertools.takewhile(lambda line: line.startswith("#"), LINE_END.split(text.lstrip("\ufeff")))
    about = "\n".join(line.lstrip("#").strip() for line in lines).strip()
    if about:
        yield about


def _about_key(asked: Document, found: Occurrence) -> Iterator[str]:
    name = found.meaning.name
    match asked.root:
        case syntax.SceneNode() | syntax.StudyNode():
            section = _section_around(asked.root, found.span.start)
            is_scene = isinstance(asked.root, syntax.SceneNode)
            known = (KEYS.get(section, {}) if is_scene else keys_of(section)).get(name)
            meaning, values = ("", ()) if known is None else (known.meaning, known.values)
        case syntax.DomainNode():
            meaning, values = LEARNED.get(name, ""), LEARNED_WORDS.get(name, ())
        case _:
            meaning, values = PLANNER.get(name, ""), ()
    if meaning:
        listed = f" ({', '.join(f'`{value}`' for value in values)})" if values else ""
        yield f"**{name}**: {meaning}{listed}"


def _section_around(node: syntax.Node | None, offset: int) -> str:
    """The name of the innermost section of a scene or study around an offset."""
    name = TOP
    entries = getattr(node, "entries", ())
    while inner := [
        e for e in entries if isinstance(e, syntax.Section) and e.span.start < offset < e.span.end
    ]:
        name, entries = inner[0].name.text, inner[0].entries
    return name


# ---- rules


def _about_rule(asked: Document, node: syntax.RuleNode, library: Library) -> Iterator[str]:
    """Grounding, and numpy with it, is imported here: the editor's other answers come without it."""
    from cleancli.compiler.grounding_size import count_groundings

    domain = library.domain_of(asked)
    model = None if domain is None else model_of(domain, library)
    if domain is None or model is None:
        return
    rule = next(rule for rule in model.rules if rule.name == node.name.text)
    yield _sums(rule)
    for user in library.users_of(domain, roots=()):
        problem = model_of_problem(user, model)
        if problem is not None:
            counted = next(g for g in count_groundings(model, problem) if g.name == rule.name)
            yield f"`{user.path.name}`: {_groundings(counted.count, counted.exact)}"


def _sums(rule: Rule) -> str:
    """How much probability a rule gives to changes, to nothing and to noise."""
    sums: dict[str, Fraction] = {}
    for outcome in rule.outcomes:
        sums[outcome.kind.value] = sums.get(outcome.kind.value, Fraction(0)) + outcome.probability
    count = len(rule.outcomes)
    parts = ", ".join(f"{print_fraction(probability)} {kind}" for kind, probability in sums.items())
    return f"{plural(count, 'outcome')}: {parts}"


def _groundings(count: int, exact: bool) -> str:
    """For how many tuples of a problem's objects the facts that never change allow a rule."""
    return f"{'' if exact else 'at most '}{plural(count, 'grounding')}"


# ---- what was learned


def _learned(asked: Document, offset: int) -> Hover | None:
    """What the learner noted beside the number at an offset."""
    weight = None if asked.root is None else _weight_at(asked.root, offset)
    if weight is None:
        return None
    text = asked.source.text[weight.span.start : weight.span.end]
    parts = [f"now `{text.partition('[')[0].strip()}`"]
    for _, mark in children(weight):
        if isinstance(mark, syntax.Prior):
            parts.append(f"before anything was learned `{print_fraction(mark.probability.value)}`")
        elif isinstance(mark, syntax.QuantityPrior):
            said = asked.source.text[mark.quantity.span.start : mark.quantity.span.end]
            parts.append(f"before anything was learned `{said}`")
        elif isinstance(mark, syntax.Fixed):
            parts.append("fixed: learning leaves it alone")
        elif isinstance(mark, syntax.Seen):
            parts.append(f"seen {plural(print_fraction(mark.count.value), 'time')}")
    return Hover("; ".join(parts), weight.span)


def _weight_at(node: syntax.Node, offset: int) -> syntax.Node | None:
    """The node around an offset that holds the notes of the learner."""
    for _, child in children(node):
        if isinstance(child, syntax.Prior | syntax.QuantityPrior | syntax.Seen | syntax.Fixed):
            return node
        if child.span.start <= offset <= child.span.end:
            found = _weight_at(child, offset)
            if found is not None:
                return found
    return None
