"""A .nid domain and what is written of it as RDDL, compared by drawing: pyRDDLGym simulates the files."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

from scipy.stats import chisquare

from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.export.rddl import rddl
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.model import Domain, Problem
from cleancli.learning.experience import Transition
from cleancli.learning.variation import foretold

After = frozenset[tuple[str, object]]
"""The fluents that are not as before, by their grounded names, with their values."""


class Simulated:
    """The files of a domain and a problem in pyRDDLGym, which is quiet."""

    def __init__(self, domain: Domain, problem: Problem, folder: Path, horizon: int) -> None:
        made = rddl(domain, problem, horizon, "unchanged", Unsaid("RDDL", [Source("domain.nid", "")]))
        paths = [folder / name for name in ("domain.rddl", "instance.rddl")]
        for path, text in zip(paths, made.texts.values(), strict=True):
            path.write_text(text, encoding="utf-8")
        self._domain, self._problem = domain, problem
        with _quietly():
            import pyRDDLGym

            self._env: Any = pyRDDLGym.make(*map(str, paths))

    def reset(self, seed: int | None) -> dict[str, object]:
        """The first state of an episode; without a seed draws go on."""
        with _quietly():
            state, _ = self._env.reset(seed=seed)
        return dict(state)

    def step(self, action: str, names: tuple[str, ...]) -> tuple[dict[str, object], float, bool]:
        """The state after an action, the reward, and whether the episode ends."""
        with _quietly():
            state, paid, done, cut, _ = self._env.step({_grounded(action, names): 1})
        return dict(state), float(paid), bool(done or cut)

    def drawn(
        self, action: str, names: tuple[str, ...], count: int, seed: int
    ) -> tuple[Counter[After], float]:
        """What follows an action in the initial state, so many times, and the mean reward."""
        found: Counter[After] = Counter()
        total = 0.0
        first = self.reset(seed)
        for _ in range(count):
            with _quietly():
                self._env.reset()
            after, paid, _ = self.step(action, names)
            found[frozenset((k, _plain(v)) for k, v in after.items() if v != first[k])] += 1
            total += paid
        return found, total / count


@contextlib.contextmanager
def _quietly() -> Any:
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        yield


def _grounded(name: str, objects: tuple[str, ...]) -> str:
    return f"{name}___{'__'.join(objects)}" if objects else name


def _plain(value: Any) -> object:
    """A value as Python has it."""
    return value.item() if hasattr(value, "item") else value


def expected(domain: Domain, problem: Problem, action: str, names: tuple[str, ...]) -> dict[After, float]:
    """What follows by the rules, and how likely."""
    values: Values = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
    here = Transition(action, names, problem.objects, values, values)
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    likely: dict[After, float] = {}
    for moved, chance in foretold(LiftedRules(domain), here).items():
        after: set[tuple[str, object]] = set()
        for (name, objects), value in moved:
            shown = f"{name}_{value}" if isinstance(value, str) else value
            ways = {objects, objects[::-1]} if symbols[name].symmetric else {objects}
            after.update((_grounded(name, way), shown) for way in ways)
        likely[frozenset(after)] = likely.get(frozenset(after), 0.0) + chance
    return {after: chance for after, chance in likely.items() if chance}


def chance_of(found: Counter[After], likely: dict[After, float]) -> float:
    """How likely it is that draws from these probabilities differ as much as what was found; 0 for what can
    never happen."""
    if found.keys() - likely.keys():
        return 0.0
    if len(likely) == 1:
        return 1.0
    count = sum(found.values())
    keys = list(likely)
    return float(chisquare([found[key] for key in keys], [likely[key] * count for key in keys]).pvalue)
