"""PPDDL texts drawn at random: small domains in which all constructs meet."""

from __future__ import annotations

from random import Random

TYPES = ("thing", "box", "car")
PREDICATES: dict[str, tuple[str, ...]] = {
    "ready": (), "wet": ("thing",), "full": ("box",), "at": ("thing", "thing"), "Big-One": ("thing",),
}  # fmt: skip
OBJECTS = {"b1": "box", "b2": "box", "c1": "car", "t1": "thing"}
_CHANCES = ("1/2", "0.25", "1/3", "0.1", "1")

Bound = tuple[tuple[str, str], ...]
"""Variables and constants that may stand at a place, with their types."""


class Drawn:
    """Draws a text; the same generator draws the same."""

    def __init__(self, rng: Random) -> None:
        self._rng = rng
        self._variables = 0

    def text(self) -> str:
        """A domain and a problem of it."""
        actions = "\n".join(self._action(number) for number in range(self._rng.choice((1, 2, 2))))
        predicates = " ".join(
            f"({name} {' '.join(f'?v{n} - {kind}' for n, kind in enumerate(kinds))})"
            for name, kinds in PREDICATES.items()
        )
        objects = " ".join(f"{name} - {kind}" for name, kind in OBJECTS.items() if name != "b1")
        facts = " ".join(self._fact() for _ in range(self._rng.randrange(6)))
        return (
            f"(define (domain drawn) (:types box car - thing) (:constants b1 - box)\n"
            f" (:predicates {predicates})\n{actions})\n"
            f"(define (problem one) (:domain drawn) (:objects {objects})\n"
            f" (:init {facts})\n (:goal {self._condition((('b1', 'box'),), 2)}))\n"
        )

    def _fits(self, kind: str, wanted: str) -> bool:
        return wanted in (kind, "thing")

    def _atom(self, bound: Bound) -> str:
        while True:
            name, kinds = self._rng.choice(list(PREDICATES.items()))
            terms = []
            for kind in kinds:
                fitting = [term for term, own in bound if self._fits(own, kind)]
                if not fitting:
                    break
                terms.append(self._rng.choice(fitting))
            if len(terms) == len(kinds):
                return f"({' '.join((name, *terms))})"

    def _fact(self) -> str:
        return self._atom(tuple(OBJECTS.items()))

    def _variable(self, kinds: tuple[str, ...] = (*TYPES, "(either box car)")) -> tuple[str, str, str]:
        """The name of a new variable, its type, and the type that it is taken to have where it is used."""
        self._variables += 1
        kind = self._rng.choice(kinds)
        # Names return, so that inner variables hide outer ones.
        return f"?v{self._variables % 5}", kind, "thing" if kind.startswith("(") else kind

    def _condition(self, bound: Bound, depth: int) -> str:
        form = self._rng.randrange(8) if depth else 0
        inner = depth - 1
        match form:
            case 1 | 2:
                word = "and" if form == 1 else "or"
                parts = [self._condition(bound, inner) for _ in range(self._rng.randrange(1, 4))]
                return f"({word} {' '.join(parts)})"
            case 3:
                return f"(not {self._condition(bound, inner)})"
            case 4:
                return f"(imply {self._condition(bound, inner)} {self._condition(bound, inner)})"
            case 5:
                word = self._rng.choice(("exists", "forall"))
                name, kind, own = self._variable()
                shown = self._condition(_with(bound, name, own), inner)
                return f"({word} ({name} - {kind}) {shown})"
            case 6:
                return f"(= {self._rng.choice(bound)[0]} {self._rng.choice(bound)[0]})"
            case _:
                atom = self._atom(bound)
                return f"(not {atom})" if self._rng.random() < 0.4 else atom

    def _effect(self, bound: Bound, depth: int) -> str:
        form = self._rng.choice((0, 1, 1, 2, 3, 4)) if depth else 0
        inner = depth - 1
        match form:
            case 1:
                parts = [self._effect(bound, inner) for _ in range(self._rng.randrange(2, 4))]
                return f"(and {' '.join(parts)})"
            case 2:
                return f"(when {self._condition(bound, 1)} {self._effect(bound, inner)})"
            case 3:
                name, kind, own = self._variable(("box", "car", "box", "thing"))
                return f"(forall ({name} - {kind}) {self._effect(_with(bound, name, own), inner)})"
            case 4:
                first = self._rng.choice(_CHANCES)
                second = f" 0 {self._effect(bound, 0)}"
                if first != "1":
                    second = f" 0.2 {self._effect(bound, inner)}" if self._rng.random() < 0.5 else ""
                return f"(probabilistic {first} {self._effect(bound, inner)}{second})"
            case _:
                atom = self._atom(bound)
                return f"(not {atom})" if self._rng.random() < 0.4 else atom

    def _action(self, number: int) -> str:
        parameters = [self._variable() for _ in range(self._rng.choice((0, 1, 2, 2)))]
        distinct = {name: (kind, own) for name, kind, own in parameters}
        bound: Bound = (("b1", "box"), *((name, own) for name, (_, own) in distinct.items()))
        shown = " ".join(f"{name} - {kind}" for name, (kind, _) in distinct.items())
        return (
            f" (:action act-{number} :parameters ({shown})\n"
            f"  :precondition {self._condition(bound, 2)}\n  :effect {self._effect(bound, 3)})"
        )


def _with(bound: Bound, name: str, kind: str) -> Bound:
    return (*((other, own) for other, own in bound if other != name), (name, kind))
