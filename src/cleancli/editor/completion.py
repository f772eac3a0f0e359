"""What may be written at a place: words of the language as its parser would take them, and names that fit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cleancli.editor.context import Context, context, open_string
from cleancli.editor.hover import comment, parameters_of, signature
from cleancli.editor.library import Document, Library
from cleancli.language import syntax
from cleancli.language.checking.learned import KEYS as LEARNED
from cleancli.language.checking.learned import WORDS as LEARNED_WORDS
from cleancli.language.checking.planner_block import KEYS as PLANNER
from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.parsing.grammar import keywords
from cleancli.language.parsing.lexemes import Lexeme, LexemeKind
from cleancli.language.refactoring.name_index import Kind, Occurrence
from cleancli.scene.kinds import LENGTH_UNITS
from cleancli.scene.schema import INNER, KEYS, TOP, Key
from cleancli.study.kinds import Named
from cleancli.study.schema import INNER as OF_STUDY
from cleancli.study.schema import keys_of

PAYMENTS = ("reward", "cost")
MARKS = {"predicates": ("static", "symmetric"), "functions": ("static",), "actions": ("cost", "duration")}
"""What declarations of a section may be marked with; the words beside a probability are the grammar's."""

_DECLARING = frozenset({"types", "constants", "predicates", "functions", "actions", "objects"})
"""Sections in which a name is a new one, or a type behind its `-`."""

_SETTINGS: Mapping[str, Mapping[str, str]] = {"planner": PLANNER, "learned": LEARNED}
"""Blocks of settings, with their keys and what these mean."""

_RELATIONS = frozenset({"=", "!=", "<", "<=", ">", ">=", ":="})


@dataclass(frozen=True, slots=True)
class Completion:
    """A word to put in place of [start, offset); `kind` is None for a word of the language."""

    text: str
    kind: Kind | None
    start: int
    detail: str = ""
    about: str = ""


def completions(asked: Document, offset: int, library: Library) -> tuple[Completion, ...]:
    """What fits at a place, whether or not the text can be read, each once and the nearest first."""
    before = asked.source.text[:offset]
    typed = open_string(before)
    if typed is not None:
        return _paths(typed, asked, offset, library)
    place = context(asked.source.text, offset)
    if place is None or before.endswith("/"):  # behind which a number goes on
        return ()
    is_tabled = place.kind in ("scene", "study")
    names = _scene(place, library, asked) if is_tabled else _names(place, asked, library)
    found: dict[str, Completion] = {}
    for completion in (*names, *_keywords(place)):
        found.setdefault(completion.text, completion)
    return tuple(found.values())


def _paths(typed: tuple[str, str], asked: Document, offset: int, library: Library) -> tuple[Completion, ...]:
    """Files and folders for the path of an include, of which the last part is put in place."""
    word, path = typed
    if word != "include":
        return ()
    folder, slash, name = path.rpartition("/")
    found = library.includable(asked, folder + slash)
    return tuple(
        Completion(text, Kind.FOLDER if text.endswith("/") else Kind.FILE, offset - len(name))
        for text in found
    )


def _keywords(place: Context) -> Iterator[Completion]:
    for terminal, word in sorted(keywords().items()):
        if word.isidentifier() and place.accepted is not None and terminal in place.accepted:
            yield Completion(word, None, place.start, "word of the language")
    if place.accepted is not None and "UNIT" in place.accepted and place.section in MARKS:
        yield Completion("s", None, place.start, "unit")


# ---- domains and problems


def _names(place: Context, asked: Document, library: Library) -> Iterable[Completion]:
    if place.last == "-" and place.section != "init":
        return _declared(place, asked, library, Kind.TYPE)
    if not place.section:
        return _between_sections(place, asked, library)
    if place.section in _SETTINGS:
        return _settings(place, _SETTINGS[place.section])
    if _is_in_brackets(place.words):
        return _marks(place, asked, library)
    return () if place.section in _DECLARING else _in_body(place, asked, library)


def _between_sections(place: Context, asked: Document, library: Library) -> Iterable[Completion]:
    """Headers of rules, and settings of a problem."""
    if place.texts[:1] == ("rule",):
        return _in_header(place, asked, library)
    if place.texts[-2:] == ("domain", "="):
        return _domains(place, asked, library)
    if place.takes("NAME") and place.last in ("=", "+"):
        return _declared(place, asked, library, Kind.COUNT)
    return ()


def _domains(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    for name in library.domain_names(asked.path):
        yield Completion(name, Kind.DOMAIN, place.start, "domain")


def _settings(place: Context, keys: Mapping[str, str]) -> Iterator[Completion]:
    """Keys where a setting may begin, and words behind `=` where the key knows some."""
    key = _key(place.words)
    if place.last == "=":
        for word in LEARNED_WORDS.get(key, ()) if place.section == "learned" else ():
            yield Completion(word, Kind.WORD, place.start, keys[key])
    elif place.takes("NAME"):
        for key, meaning in keys.items():
            yield Completion(key, Kind.KEY, place.start, meaning)


def _marks(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    """What a declaration may be marked with, where a mark may begin; in a cost functions and what they are
    of."""
    if place.section == "actions" and _open_call(place.words) is not None:
        for text in dict.fromkeys(_parameters_before(place.words)):
            yield Completion(text, Kind.VARIABLE, place.start, "variable")
    elif place.section == "actions" and place.last in ("=", "+", "*") and place.takes("NAME"):
        yield from _priced(place, asked, library)
    elif place.last in ("[", ",") and place.takes("NAME"):
        for mark in MARKS.get(place.section, ()):
            yield Completion(mark, Kind.MARK, place.start, "mark")


def _priced(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    """Functions that a price may be counted with: those of integers."""
    for each in library.visible(asked):
        if isinstance(each.node, syntax.FunctionNode) and isinstance(each.node.values, syntax.Bounds):
            yield _completion(place, each, asked, library)


def _in_header(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    """`rule NAME: ACTION(?a, ?b)`."""
    texts = place.texts
    if _is_in_brackets(place.words):
        yield Completion("fixed", Kind.MARK, place.start, "mark")
        return
    if "(" not in texts:
        if ":" in texts:
            yield from _declared(place, asked, library, Kind.ACTION)
        return
    action = parameters_of(texts[texts.index("(") - 1], Kind.ACTION, asked, library)
    position = texts.count(",")
    if position < len(action):
        name, type_name = action[position]
        yield Completion(f"?{name}", Kind.VARIABLE, place.start, type_name)


def _in_body(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    """Inside a rule's braces and other places where literals and effects stand."""
    texts = place.texts
    call = _open_call(place.words)
    if call is not None:
        symbol, position = call
        if symbol == "decrease":
            yield from _declared(place, asked, library, Kind.COUNT)
            return
        parameters = parameters_of(symbol, Kind.SYMBOL, asked, library)
        wanted = parameters[position][1] if position < len(parameters) else ""
        yield from _terms(place, asked, library, wanted)
        return
    if texts[-1] in _RELATIONS:
        function = _function_before(place.words[:-1])
        if function is not None:
            yield from _declared(place, asked, library, Kind.VALUE, function)
            return
        if texts[-1] != ":=":
            yield from _terms(place, asked, library, "")
            return
    if place.section == "rule" and place.last in ("+=", "-=", "+", "*") and place.takes("NAME"):
        yield from _priced(place, asked, library)
        return
    for kind in _named_here(place):
        yield from _declared(place, asked, library, kind)
    if place.accepted is not None and "IF" in place.accepted:  # an effect begins
        for word in PAYMENTS:
            yield Completion(word, Kind.MARK, place.start, "what an outcome pays")
    if place.takes("VARIABLE"):
        yield from _variables(place)


def _named_here(place: Context) -> tuple[Kind, ...]:
    """What a name that may come next can be, beside a term."""
    if not place.takes("NAME"):
        return ()
    if place.section == "reward":
        return (Kind.COUNT,)
    if place.accepted is None:
        return (Kind.SYMBOL, Kind.PARAMETER)
    if "REST" in place.accepted:  # an outcome begins, with its probability
        return (Kind.PARAMETER,)
    is_new = place.section == "derived" and "NOT" not in place.accepted and place.texts[-1] != "closure"
    return () if is_new or place.section in ("parameters", "planner") else (Kind.SYMBOL,)


def _declared(
    place: Context, asked: Document, library: Library, kind: Kind, home: str | None = None
) -> Iterator[Completion]:
    for occurrence in library.visible(asked):
        meaning = occurrence.meaning
        if meaning.kind is kind and (home is None or meaning.home == home):
            yield _completion(place, occurrence, asked, library)


def _completion(place: Context, declaration: Occurrence, asked: Document, library: Library) -> Completion:
    holder = library.document(declaration.span.path)
    text = "" if holder is None else holder.source.text
    detail = signature(declaration, text, asked, library)
    node = declaration.node
    span = declaration.span if isinstance(node, syntax.Group) else node.span
    about = " ".join(comment(text, span)) if text else ""
    return Completion(declaration.meaning.name, declaration.meaning.kind, place.start, detail, about)


def _terms(place: Context, asked: Document, library: Library, wanted: str) -> Iterator[Completion]:
    """Variables that are bound here, then objects of a type or of one below it (of any where it is empty)."""
    if place.section not in ("init", "objects"):
        yield from _variables(place)
    parents = _parents(library.visible(asked))
    for occurrence in library.visible(asked):
        node = occurrence.node
        if occurrence.meaning.kind is Kind.OBJECT and isinstance(node, syntax.Group):
            own = "" if node.type is None else node.type.text
            if not wanted or wanted in _line(own, parents):
                yield _completion(place, occurrence, asked, library)


def _parents(declared: Iterable[Occurrence]) -> dict[str, str]:
    return {
        o.meaning.name: o.node.type.text
        for o in declared
        if o.meaning.kind is Kind.TYPE and isinstance(o.node, syntax.Group) and o.node.type is not None
    }


def _line(name: str, parents: dict[str, str]) -> list[str]:
    """A type and those above it; a circle, which is a mistake, is walked once."""
    line = [name]
    while line[-1] in parents and parents[line[-1]] not in line:
        line.append(parents[line[-1]])
    return line


def _variables(place: Context) -> Iterator[Completion]:
    """The variables bound before a place in its section: the header's, those of references, then those of
    quantifiers."""
    header = place.words[: next((i for i, w in enumerate(place.words) if w.text == "{"), 0)]
    known = [word.text for word in header if word.kind is LexemeKind.VARIABLE]
    quantified: list[str] = []
    pending: list[str] = []
    refers = False
    for before, word in zip(place.words, place.words[1:], strict=False):
        if word.text == ":" and _ends_weight(before):
            quantified.clear()  # what a quantifier binds ends with its outcome
        refers = word.text == "with" or (refers and word.text != ":")
        if word.kind is LexemeKind.VARIABLE:
            pending.append(word.text)
        elif word.text == "-":
            (known if refers else quantified).extend(pending)
        else:
            pending.clear()
    for text in dict.fromkeys(known + quantified):
        yield Completion(text, Kind.VARIABLE, place.start, "variable")


def _ends_weight(word: Lexeme) -> bool:
    return word.kind is LexemeKind.NUMBER or word.text in ("rest", "]")


def _is_in_brackets(words: tuple[Lexeme, ...]) -> bool:
    """Whether more `[` were opened than closed since the last brace."""
    depth = 0
    for word in words:
        if word.text in ("{", "}"):
            depth = 0
        depth += {"[": 1, "]": -1}.get(word.text, 0)
    return depth > 0


def _parameters_before(words: tuple[Lexeme, ...]) -> Iterator[str]:
    """The variables of the last parentheses before the bracket that is open."""
    head = words[: max(index for index, word in enumerate(words) if word.text == "[")]
    opened = max((index for index, word in enumerate(head) if word.text == "("), default=0)
    return (word.text for word in head[opened:] if word.kind is LexemeKind.VARIABLE)


def _open_call(words: tuple[Lexeme, ...]) -> tuple[str, int] | None:
    """The symbol whose terms are being written, and how many are there; None outside of parentheses."""
    depth, commas = 0, 0
    for index in range(len(words) - 1, -1, -1):
        match words[index].text:
            case ")":
                depth += 1
            case "(" if depth:
                depth -= 1
            case "(":
                before = words[index - 1] if index > 0 else words[index]
                named = before.kind is LexemeKind.WORD and before.text not in RESERVED
                return (before.text, commas) if named else None
            case "," if not depth:
                commas += 1
            case "{" | "}":
                return None
    return None


def _function_before(words: tuple[Lexeme, ...]) -> str | None:
    """The symbol of the application that ends here; None for anything else."""
    if not words or words[-1].text != ")":
        return None
    call = _open_call(words[:-1])
    return None if call is None else call[0]


# ---- scenes and studies


def _scene(place: Context, library: Library, asked: Document) -> Iterable[Completion]:
    """Keys and sections where an entry may begin; values behind `=`; units behind a number."""
    goes_on = place.kind == "study" and place.last == "," and not _open_pair(place.texts)
    if place.last == "=" or goes_on:
        return _values(place, asked, library)
    return (*_units(place), *_entries(place))


def _values(place: Context, asked: Document, library: Library) -> Iterator[Completion]:
    """What a setting may be set to, where that is one of some words."""
    key = _key(place.words)
    known = _keys(place).get(key)
    if key == "domain" and (place.kind == "study" or place.section == TOP):
        yield from _domains(place, asked, library)
    elif known is not None and isinstance(known.kind, Named):
        for name in library.names_of(asked, key):
            yield Completion(name, Kind.WORD, place.start, known.meaning)
    elif known is not None:
        for value in known.values:
            yield Completion(value, Kind.WORD, place.start, known.meaning)


def _units(place: Context) -> Iterator[Completion]:
    if not place.words or place.words[-1].kind is not LexemeKind.NUMBER or not place.takes("UNIT"):
        return
    known = _keys(place).get(_key(place.words))
    for unit in LENGTH_UNITS if known is None else known.units:
        yield Completion(unit, None, place.start, "unit")


def _entries(place: Context) -> Iterator[Completion]:
    """Keys and sections, where the name of one may stand."""
    is_inside = place.kind and (place.words or place.path or place.accepted is not None)
    if not is_inside or not place.takes("NAME"):
        return
    for name, known in _keys(place).items():
        yield Completion(name, Kind.KEY, place.start, known.meaning)
    for name in (INNER if place.kind == "scene" else OF_STUDY).get(place.section, ()):
        yield Completion(name, Kind.SECTION, place.start, "section")


def _keys(place: Context) -> Mapping[str, Key]:
    """The settings of the section that a place is in."""
    return KEYS.get(place.section, {}) if place.kind == "scene" else keys_of(place.section)


def _open_pair(texts: tuple[str, ...]) -> bool:
    """Whether a place is within parentheses."""
    return texts.count("(") > texts.count(")")


def _key(words: tuple[Lexeme, ...]) -> str:
    """The key of the setting that is being written."""
    for index in range(len(words) - 1, 0, -1):
        if words[index].text == "=":
            return words[index - 1].text
        if words[index].text in ("{", "}"):
            break
    return ""
