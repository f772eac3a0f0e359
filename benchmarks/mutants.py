"""Small changes to a module's text, each of which a test should notice, and the blocks that tests run.

A block is a run of statements that are carried out one after the other: the start of a function, of a branch,
of a loop, and what follows one. Its name, `planning/planners/exact.py:solve:3`, counts within its
function, so that a change elsewhere in the file leaves it as it is.
"""

from __future__ import annotations

import ast
import builtins
import copy
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[1] / "src" / "cleancli"
MODULE = "<module>"
COMPILED = frozenset({"njit", "compiled", "inner", "inlined"})
_COMPOUND = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_REPLACED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
    ast.BitXor: ast.BitOr,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
}
_OTHER_CALL = {"min": "max", "max": "min", "any": "all", "all": "any", "sorted": "list", "reversed": "list"}


@dataclass(frozen=True, slots=True)
class Site:
    """A place in a module's tree, and what would stand there: nothing where the statement is dropped."""

    module: str
    block: str
    compiled: bool
    kind: str
    node: ast.expr | ast.stmt
    replacement: ast.AST | None


@dataclass(frozen=True, slots=True)
class Change:
    """A module with one thing changed: `text` is all of it, `before` and `after` are what differs."""

    module: str
    line: int
    block: str
    compiled: bool
    kind: str
    before: str
    after: str
    text: str

    @property
    def key(self) -> str:
        """What the list of reviewed changes calls it: no line, so that it outlives changes elsewhere."""
        return f"{self.block} | {self.kind} | {self.before} | {self.after}"


# ---- blocks


def is_compiled(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether a function becomes machine code, which no marker can stand in."""
    calls = (part.func if isinstance(part, ast.Call) else part for part in node.decorator_list)
    decorated = any(isinstance(part, ast.Name) and part.id in COMPILED for part in calls)
    return decorated or node.name in _compiled_by_call()


@cache
def _compiled_by_call() -> frozenset[str]:
    """Names of functions that some module hands to a compiler, such as `better = inlined(preferred)`."""
    trees = (ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES.rglob("*.py"))
    calls = (node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Call))
    handed = (call.args for call in calls if isinstance(call.func, ast.Name) and call.func.id in COMPILED)
    return frozenset(part.id for parts in handed for part in parts if isinstance(part, ast.Name))


def _suites(statement: ast.stmt) -> Iterator[list[ast.stmt]]:
    for name in ("body", "orelse", "finalbody"):
        suite = getattr(statement, name, None)
        if suite:
            yield suite
    for part in (*getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
        yield part.body


class Blocks:
    """The block of each statement of a module, and where each block begins."""

    def __init__(self, module: str, tree: ast.Module) -> None:
        self.of: dict[ast.stmt, str] = {}
        self.starts: list[tuple[str, list[ast.stmt], int]] = []
        self.compiled: set[ast.stmt] = set()
        self._module = module
        self._numbers: dict[str, int] = {}
        self._outside(tree.body, "")

    def _outside(self, suite: list[ast.stmt], scope: str) -> None:
        """Statements that are carried out when the module is imported."""
        for statement in suite:
            self.of[statement] = f"{self._module}:{MODULE}"
            if isinstance(statement, _FUNCTIONS):
                self._function(statement, scope)
            elif isinstance(statement, ast.ClassDef):
                self._outside(statement.body, f"{scope}{statement.name}.")
            else:
                for inner in _suites(statement):
                    self._outside(inner, scope)

    def _function(self, node: ast.FunctionDef | ast.AsyncFunctionDef, scope: str) -> None:
        name = f"{scope}{node.name}"
        if is_compiled(node):
            for statement in ast.walk(node):
                if isinstance(statement, ast.stmt):
                    self.of[statement] = f"{self._module}:{name}:compiled"
                    self.compiled.add(statement)
            return
        self._inside(node.body, name)

    def _start(self, name: str, suite: list[ast.stmt], index: int) -> str:
        number = self._numbers[name] = self._numbers.get(name, 0) + 1
        block = f"{self._module}:{name}:{number}"
        self.starts.append((block, suite, index))
        return block

    def _inside(self, suite: list[ast.stmt], name: str) -> None:
        first = 1 if ast.get_docstring(_holder(suite)) is not None else 0
        block = self._start(name, suite, first)
        for index, statement in enumerate(suite):
            self.of[statement] = block
            if isinstance(statement, _FUNCTIONS):
                self._function(statement, f"{name}.")
            elif isinstance(statement, ast.ClassDef):
                self._outside(statement.body, f"{name}.{statement.name}.")
            elif isinstance(statement, _COMPOUND):
                for inner in _suites(statement):
                    self._inside(inner, name)
                if index + 1 < len(suite):
                    block = self._start(name, suite, index + 1)


def _holder(suite: list[ast.stmt]) -> ast.Module:
    return ast.Module(suite, [])


def instrumented(module: str, text: str, number: dict[str, int]) -> str:
    """The module with a call at the start of each block that tells the block's number, given in `number`."""
    tree = ast.parse(text)
    starts = Blocks(module, tree).starts
    for block, suite, index in reversed(starts):
        identity = number.setdefault(block, len(number))
        call = ast.Call(ast.Name("_hit_", ast.Load()), [ast.Constant(identity)], [])
        suite.insert(index, ast.Expr(call))
    place = 0
    for place, statement in enumerate(tree.body):
        docstring = place == 0 and ast.get_docstring(tree) is not None
        if not docstring and not (isinstance(statement, ast.ImportFrom) and statement.module == "__future__"):
            break
    else:
        place = len(tree.body)
    imported = number.setdefault(f"{module}:{MODULE}", len(number))
    call = ast.Call(ast.Name("_hit_", ast.Load()), [ast.Constant(imported)], [])
    tree.body.insert(place, ast.Expr(call))
    tree.body.insert(place, ast.ImportFrom("mutation_hits", [ast.alias("hit", "_hit_")], 0))
    return ast.unparse(ast.fix_missing_locations(tree)) + "\n"


# ---- changes


def sites(module: str, text: str) -> list[Site]:
    """Where a module can be changed and how, in the order of its text; some of these change nothing."""
    tree = ast.parse(text)
    blocks = Blocks(module, tree)
    return [
        Site(module, blocks.of[statement], statement in blocks.compiled, kind, node, replacement)
        for statement, kind, node, replacement in _all(tree, blocks)
    ]


def changed(site: Site, text: str) -> Change | None:
    """The change at a site of a module's text; None where the result is no Python or says the same."""
    node = site.node
    before = ast.unparse(node)
    after = ast.unparse(ast.fix_missing_locations(site.replacement)) if site.replacement else "pass"
    lines = text.encode().splitlines(keepends=True)
    assert node.end_lineno is not None
    assert node.end_col_offset is not None
    start = sum(map(len, lines[: node.lineno - 1])) + node.col_offset
    end = sum(map(len, lines[: node.end_lineno - 1])) + node.end_col_offset
    missing = "\n" * (node.end_lineno - node.lineno - after.count("\n"))
    piece = f"{after}{missing}" if isinstance(node, ast.stmt) else f"({after}{missing})"
    result = (text.encode()[:start] + piece.encode() + text.encode()[end:]).decode()
    try:
        if ast.dump(ast.parse(result)) == ast.dump(ast.parse(text)):
            return None
    except SyntaxError:
        return None
    old, new = (" ".join(part.split()) for part in (before, after))
    return Change(site.module, node.lineno, site.block, site.compiled, site.kind, old, new, result)


_Found = tuple[ast.stmt, str, ast.expr | ast.stmt, ast.AST | None]


def _all(tree: ast.Module, blocks: Blocks) -> Iterator[_Found]:
    for statement in sorted(blocks.of, key=lambda node: (node.lineno, node.col_offset)):
        if isinstance(
            statement, (ast.Assert, ast.ClassDef, ast.Import, ast.ImportFrom, ast.Pass)
        ) or _for_types(statement):
            continue
        yield from ((statement, *rest) for rest in _of_statement(statement))
        for node in _expressions(statement):
            yield from ((statement, *rest) for rest in _of_expression(node))


def _for_types(statement: ast.stmt) -> bool:
    """Whether it only says what types things have."""
    if isinstance(statement, ast.Assign) and isinstance(statement.value, (ast.BinOp, ast.Subscript)):
        names = [part.id for part in ast.walk(statement.value) if isinstance(part, ast.Name)]
        return bool(names) and all(name[:1].isupper() or name in dir(builtins) for name in names)
    if isinstance(statement, ast.AnnAssign):
        return statement.value is None
    value = getattr(statement, "value", None)
    called = value.func if isinstance(value, ast.Call) else None
    return isinstance(called, ast.Name) and called.id in {"TypeVar", "ParamSpec", "NewType"}


def _expressions(statement: ast.stmt) -> Iterator[ast.expr]:
    """The expressions that belong to the statement itself, without those of the statements in it."""
    if isinstance(statement, _FUNCTIONS):
        roots: list[ast.AST | None] = [*statement.args.defaults, *statement.args.kw_defaults]
    elif isinstance(statement, ast.ClassDef):
        roots = []
    elif isinstance(statement, ast.AnnAssign):
        roots = [statement.value]
    else:
        roots = list(ast.iter_child_nodes(statement))
    pending = [root for root in reversed(roots) if root is not None]
    while pending:
        node = pending.pop()
        if isinstance(node, (ast.stmt, ast.JoinedStr)):
            continue
        if isinstance(node, (ast.ExceptHandler, ast.match_case)):
            pending += [node.guard] if isinstance(node, ast.match_case) and node.guard else []
            continue
        if isinstance(node, ast.pattern) or _asserts(node):
            continue
        if isinstance(node, ast.expr):
            yield node
        pending += reversed(list(ast.iter_child_nodes(node)))


def _asserts(node: ast.AST) -> bool:
    """Whether it only makes sure of something: that what is zipped is equally long."""
    return isinstance(node, ast.keyword) and node.arg == "strict"


def _of_statement(statement: ast.stmt) -> Iterator[tuple[str, ast.expr | ast.stmt, ast.AST | None]]:
    match statement:
        case ast.Expr(value=ast.Constant()):
            return  # a docstring, or the dots of a protocol
        case ast.Expr() | ast.AugAssign() | ast.Raise() | ast.Delete():
            yield "dropped statement", statement, None
        case ast.Continue() | ast.Break():
            yield "dropped statement", statement, None
        case ast.If(test=test) if not _is_type_checking(test):
            yield "condition always true", test, ast.Constant(True)
            yield "condition always false", test, ast.Constant(False)
        case ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            yield "dropped statement", statement, None
        case _:
            pass
    if isinstance(statement, ast.AugAssign) and type(statement.op) in _REPLACED:
        changed = copy.deepcopy(statement)
        changed.op = _REPLACED[type(statement.op)]()
        yield "other operator", statement, changed


def _is_type_checking(test: ast.expr) -> bool:
    return isinstance(test, ast.Name) and test.id == "TYPE_CHECKING"


def _of_expression(node: ast.expr) -> Iterator[tuple[str, ast.expr, ast.expr]]:
    match node:
        case ast.Compare():
            yield from (("comparison", node, changed) for changed in _compared(node))
        case ast.BinOp(op=op) if type(op) in _REPLACED:
            yield "other operator", node, ast.BinOp(node.left, _REPLACED[type(op)](), node.right)
        case ast.BoolOp(op=op):
            yield "and, or", node, ast.BoolOp(ast.Or() if isinstance(op, ast.And) else ast.And(), node.values)
            for left in range(len(node.values)):
                rest = node.values[:left] + node.values[left + 1 :]
                yield "dropped part", node, rest[0] if len(rest) == 1 else ast.BoolOp(op, rest)
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield "dropped sign", node, operand
        case ast.IfExp():
            yield "other branch", node, ast.IfExp(node.test, node.orelse, node.body)
        case ast.Constant(value=value) if not isinstance(value, (str, bytes)):
            yield from (("constant", node, ast.Constant(other)) for other in _constants(value))
        case ast.Call():
            yield from _of_call(node)
        case ast.GeneratorExp() | ast.ListComp() | ast.SetComp() | ast.DictComp():
            yield from _of_comprehension(node)
        case ast.Slice():
            pass
        case _:
            pass


def _compared(node: ast.Compare) -> Iterator[ast.Compare]:
    for index, operator in enumerate(node.ops):
        for other in _COMPARED[type(operator)]:
            yield ast.Compare(
                node.left, [*node.ops[:index], other(), *node.ops[index + 1 :]], node.comparators
            )


def _constants(value: object) -> tuple[int | float, ...]:
    match value:
        case bool():
            return (not value,)
        case int():
            return (value + 1, value - 1) if value > 0 else (value + 1,)
        case float():
            return (value * 2,) if value else (1.0,)
        case _:
            return ()


def _of_call(node: ast.Call) -> Iterator[tuple[str, ast.expr, ast.expr]]:
    if isinstance(node.func, ast.Name) and node.func.id in _OTHER_CALL:
        other = ast.Name(_OTHER_CALL[node.func.id], ast.Load())
        keywords = [] if other.id == "list" else node.keywords
        yield "other function", node, ast.Call(other, node.args, keywords)
    either_way = isinstance(node.func, ast.Name) and node.func.id in {"max", "min"}
    if (
        len(node.args) >= 2
        and not either_way
        and not any(isinstance(argument, ast.Starred) for argument in node.args[:2])
    ):
        first, second, *rest = node.args
        yield "swapped arguments", node, ast.Call(node.func, [second, first, *rest], node.keywords)
    for index, keyword in enumerate(node.keywords):
        if keyword.arg in {"key", "default", "reverse"}:
            kept = node.keywords[:index] + node.keywords[index + 1 :]
            yield "dropped argument", node, ast.Call(node.func, node.args, kept)


def _of_comprehension(node: ast.expr) -> Iterator[tuple[str, ast.expr, ast.expr]]:
    for index, part in enumerate(node.generators):  # type: ignore[attr-defined]
        if part.ifs:
            changed = copy.deepcopy(node)
            changed.generators[index].ifs = part.ifs[1:]  # type: ignore[attr-defined]
            yield "dropped filter", node, changed
