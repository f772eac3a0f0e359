"""What is printed reads as itself: `python benchmarks/roundtrip.py [files] [--seed N]`.

Shipped and generated files are tried.

Each generated domain comes with a problem, and every third file is a scene; their texts have odd blanks, line
ends and comments. A text must give the same model as its tokens with single blanks between them, its printed
model must read as the same model, and printing twice must change nothing. The same holds for the layout of
the text, which must also keep every comment. Exit code 1, with the seed, where that fails. 2,000 files take
about a minute.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import domain_named, kind_of, load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain, print_problem
from cleancli.resources import shipped
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from cleancli.scene.model import Scene

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support import random_texts

Model = Domain | Problem | Scene


def printed(model: Model, domain: Domain | None) -> str:
    """The model as text; a problem's needs its domain."""
    match model:
        case Domain():
            return print_domain(model)
        case Problem():
            return print_problem(model, domain)
        case Scene():
            return print_scene(model)


def differs(text: str, load: Callable[[Source], Model], domain: Domain | None = None) -> str:
    """What goes wrong when a text is read, printed and read again; "" for nothing."""
    model = load(Source("given", text))
    first = printed(model, domain)
    again = load(Source("printed", first))
    if again != model:
        return f"reads as another model:\n{first}"
    if printed(again, domain) != first:
        return f"prints differently the second time:\n{first}"
    return laid_out_differs(text, model, load)


def laid_out_differs(text: str, model: Model, load: Callable[[Source], Model]) -> str:
    """What goes wrong when a text of a model is laid out; "" for nothing."""
    tidy = layout(text)
    if load(Source("laid out", tidy)) != model:
        return f"reads as another model when laid out:\n{tidy}"
    if random_texts.comments_of(tidy) != random_texts.comments_of(text):
        return f"has other comments when laid out:\n{tidy}"
    return "" if layout(tidy) == tidy else f"is laid out differently the second time:\n{tidy}"


def generated(seed: int) -> Iterator[tuple[random_texts.Generated, Callable[[Source], Model], Domain]]:
    """The files of one seed, with what reads them and the seed's domain."""
    rng = Random(seed)
    made, world = random_texts.domain(rng)
    domain = load_domain(Source("plain", made.plain))
    yield made, load_domain, domain
    yield random_texts.problem(world, rng), lambda source: load_problem(source, domain), domain
    yield random_texts.scene(rng), load_scene, domain


def wrong_with_shipped(path: Path) -> str:
    """What goes wrong with a shipped file."""
    source = read_source(path)
    match kind_of(source):
        case "domain":
            return differs(source.text, load_domain)
        case "scene":
            return differs(source.text, load_scene)
        case _:
            domain = load_domain(read_source(find(domain_named(source).text, "domains")))
            return differs(source.text, lambda given: load_problem(given, domain), domain)


def wrong_with_generated(seed: int) -> Iterator[tuple[str, str]]:
    """The kind of each file of a seed, and what goes wrong with it."""
    try:
        for made, load, domain in generated(seed):
            same = load(Source("text", made.text)) == load(Source("plain", made.plain))
            wrong = differs(made.text, load, domain) if same else f"the layout matters:\n{made.text}"
            yield made.tokens[0], wrong
    except Refused as refused:
        yield "refused", str(refused)


def main() -> int:
    """Try them all; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", type=int, nargs="?", default=2000)
    parser.add_argument("--seed", type=int, default=0, help="the first; every three files have one")
    options = parser.parse_args()
    counts: Counter[str] = Counter()
    for path in sorted([*shipped("domains").glob("*.nid"), *shipped("problems").glob("*.nid")]):
        counts["shipped"] += 1
        if wrong := wrong_with_shipped(path):
            print(f"{path.name} {wrong}")
            return 1
    for seed in range(options.seed, options.seed - (-options.files // 3)):
        for kind, wrong in wrong_with_generated(seed):
            counts[kind] += 1
            if wrong:
                print(f"seed {seed}, {kind}: {wrong}")
                return 1
    print(", ".join(f"{count} {kind}" for kind, count in counts.items()) + ": all read as themselves")
    return 0


if __name__ == "__main__":
    sys.exit(main())
