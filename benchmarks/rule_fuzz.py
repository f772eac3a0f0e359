"""Rules from odd experience: python benchmarks/rule_fuzz.py [CASES] [--seed N]

Draws vocabularies (types in each other, constants, up to a hundred symbols that nothing happens to,
functions, closures, actions without arguments) and experience of them: none, one transition, states that
never change, states after that have nothing to do with those before, one action alone, results of hidden
rules, and the same with facts turned round. Of each `cleancli learn --structure` must make a domain that
`check` has no mistake to tell of, or say what is wrong, within ten seconds of CPU.

2,000 cases take about ten minutes; `--quick` does 40.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cleancli.api.structures import learn_structure
from cleancli.compiler.fluents import Fluent
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_domain
from cleancli.language.model import Domain, Value
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.experience import Transition, encode
from cleancli.learning.structure.induce import SEARCHES

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.hidden_rules import TEXTS, domain_of
from support.walks import flickering, walks

LIMIT = 10.0
"""Seconds of CPU for a case."""
WARNED = {"W307", "W308"}
"""Warnings that learned rules must not have: that they may overlap, or can never apply."""


@dataclass(frozen=True, slots=True)
class Case:
    """A vocabulary as text, transitions of it, and of which kind they are."""

    kind: str
    text: str
    transitions: Sequence[Transition]


def cases(seed: int) -> Iterator[Case]:
    """Cases without end, each kind of experience in turn, of random vocabularies and of small domains."""
    for number in itertools.count():
        rng = np.random.default_rng((seed, number))
        kind = list(KINDS)[number % len(KINDS)]
        if kind in ("hidden", "flickering"):
            name = list(TEXTS)[int(rng.integers(len(TEXTS)))]
            text, domain = TEXTS[name], domain_of(name)
        else:
            text = vocabulary(rng)
            domain = load_domain(Source("drawn.nid", text))
        yield Case(kind, text, KINDS[kind](domain, rng))


# ---- vocabularies


def vocabulary(rng: np.random.Generator) -> str:
    """The text of a domain without rules."""
    names = [f"t{place}" for place in range(int(rng.integers(1, 4)))]
    below = [f" - t{rng.integers(max(place, 1))}" * int(rng.random() < 0.4) for place in range(len(names))]
    types = ["t0", *(name + parent for name, parent in zip(names[1:], below[1:], strict=True))]

    def signature(name: str, most: int) -> str:
        parameters = (f"?x{place} - {rng.choice(names)}" for place in range(int(rng.integers(most + 1))))
        return f"{name}({' '.join(parameters)})"

    spare = 100 if rng.random() < 0.1 else int(rng.integers(4))
    predicates = ["dirty(?x - t0)", *(signature(f"p{place}", 3) for place in range(spare))]
    predicates = [each + " [static]" * int(rng.random() < 0.2) for each in predicates]
    low = int(rng.integers(-3, 3))
    values = rng.choice([f"{low}..{low + int(rng.integers(1, 30))}", "red < green", "one < two < three"])
    functions = [f"{signature(f'f{place}', 2)}: {values}" for place in range(int(rng.integers(3)))]
    closure = ["near(?a ?b - t0)"] if rng.random() < 0.3 else []
    derived = ["far(?a ?b - t0) := closure near"] if closure else []
    actions = [signature(f"a{place}", 3) for place in range(int(rng.integers(1, 4)))]
    constants = [f"c{place} - {rng.choice(names)}" for place in range(int(rng.integers(3)))]
    blocks = {
        "types": "; ".join(types),
        "constants": " ".join(constants),
        "predicates": "  ".join((*predicates, *closure)),
        "functions": "  ".join(functions),
        "derived": "\n".join((*derived, "counted := count ?x - t0: dirty(?x)")),
        "actions": " ".join(actions),
        "reward": "decrease(counted)",
    }
    lines = [f"  {name} {{ {content} }}" for name, content in blocks.items() if content]
    return "\n".join(("domain drawn {", *lines, "}", ""))


# ---- experience


def _states(domain: Domain, rng: np.random.Generator) -> Iterator[Transition]:
    return drawn_states((domain,), rng)


def _none(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    return []


def _one(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    return _contradictory(domain, rng)[:1]


def _constant(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    return list(itertools.islice(_states(domain, rng), int(rng.integers(1, 60))))


def _contradictory(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    """From one state, each time to another one that has nothing to do with it."""
    first, *others = itertools.islice(_states(domain, rng), int(rng.integers(2, 60)))
    return [first._replace(after=_drawn_again(domain, first, rng)) for _ in others]


def _random(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    """States after that are drawn, each from another state."""
    states = itertools.islice(_states(domain, rng), int(rng.integers(1, 60)))
    return [each._replace(after=_drawn_again(domain, each, rng)) for each in states]


def _one_action(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    return [each for each in _random(domain, rng) if each.action == domain.actions[0].name]


def _drawn_again(domain: Domain, transition: Transition, rng: np.random.Generator) -> Mapping[Fluent, Value]:
    """The state with about one fact in ten drawn anew."""
    (seen,) = flickering(domain, [transition], 0.1, rng)
    return seen.after


def _walked(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    starts = [(each.objects, each.before) for each in itertools.islice(_states(domain, rng), 10)]
    try:
        return list(itertools.islice(walks(domain, starts, rng), int(rng.integers(1, 300))))
    except Refused:  # a state that the rules give two values in (E602)
        return []


def _flickering(domain: Domain, rng: np.random.Generator) -> list[Transition]:
    return list(flickering(domain, _walked(domain, rng), float(rng.choice([0.01, 0.1, 0.5])), rng))


KINDS = {
    "none": _none,
    "one": _one,
    "constant": _constant,
    "contradictory": _contradictory,
    "random": _random,
    "one action": _one_action,
    "hidden": _walked,
    "flickering": _flickering,
}


# ---- what comes of them


def tried(case: Case, folder: Path, search: str) -> tuple[str, float]:
    """What came of a case, "rules" or "refused" where all is well, and the seconds of CPU."""
    domain, experience = folder / "drawn.nid", folder / "experience.jsonl"
    domain.write_text(case.text, encoding="utf-8")
    experience.write_text("".join(f"{encode(each, {})}\n" for each in case.transitions), encoding="utf-8")
    began = time.process_time()
    try:
        found = learn_structure(domain, experience, vocabulary=True, search=search)
    except Refused:
        return "refused", time.process_time() - began
    except Exception:
        return traceback.format_exc(), time.process_time() - began
    seconds = time.process_time() - began
    diagnostics = checked_domain(Source("learned.nid", found.text)).diagnostics
    wrong = [str(each) for each in diagnostics if each.code.startswith("E") or each.code in WARNED]
    return (wrong[0] if wrong else "rules"), seconds


def main() -> int:
    """Try them, tell what is wrong, and count the rest; 1 if anything is."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="?", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--search", choices=SEARCHES, default=SEARCHES[0])
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    number = 40 if options.quick else options.cases
    counts: Counter[tuple[str, str]] = Counter()
    longest, wrong = 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        for place, case in enumerate(itertools.islice(cases(options.seed), number)):
            said, seconds = tried(case, Path(folder), options.search)
            longest = max(longest, seconds)
            if said not in ("rules", "refused") or seconds > LIMIT:
                wrong += 1
                print(f"case {place} ({case.kind}), {seconds:.1f} s: {said}", flush=True)
            counts[case.kind, said if said in ("rules", "refused") else "wrong"] += 1
    for (kind, said), times in sorted(counts.items()):
        print(f"{kind}: {said} {times}")
    print(f"{number} cases, {wrong} wrong, at most {longest:.2f} s of CPU for one")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
