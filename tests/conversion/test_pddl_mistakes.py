"""PPDDL files with mistakes: each is located, all are told at once, and what is plainly meant is mended."""

from __future__ import annotations

import time
from fractions import Fraction
from random import Random

import pytest

from cleancli.conversion.pddl.convert import Converted, Wishes, convert
from cleancli.conversion.pddl.models import models_of
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import Lines
from cleancli.language.load import load_domain, load_problem

TEXT = """\
(define (domain tidy)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (in ?a - area ?c - container))
  (:functions (total-cost))
  (:action push
    :parameters (?a - area)
    :precondition (dirt ?a)
    :effect (and (probabilistic 0.8 (in ?a bin)) (not (dirt ?a)) (increase (total-cost) 2))))
(define (problem two)
  (:domain tidy)
  (:objects a1 a2 - area)
  (:init (dirt a1) (dirt a2))
  (:goal (forall (?a - area) (not (dirt ?a))))
  (:metric minimize (total-cost)))
"""

MISTAKES = {
    # name: (what stands there, what it becomes, code, line and column, words of the message)
    "nothing": (TEXT, "", "E915", (1, 1), "no domain is defined"),
    "a word outside": (
        "(define (domain",
        "tidy (define (domain",
        "E915",
        (1, 1),
        "outside of all parentheses",
    ),
    "no definition": ("(define (problem two)", "(defin (problem two)", "E915", (10, 2), "neither a domain"),
    "two domains": (TEXT, TEXT * 2, "E915", (16, 17), "second domain"),
    "action without name": ("(:action push", "(:action", "E915", (7, 5), "expected the name of the action"),
    "unknown part": (":effect", ":effects", "E915", (9, 5), "`:effects`"),
    "a group for a part": (
        ":precondition (dirt ?a)\n    :effect (and",
        ":effect (and (dirt ?a)) :precondition",
        "E915",
        (8, 75),
        "expected",
    ),
    "no group": (
        ":precondition (dirt ?a)",
        ":precondition dirt",
        "E915",
        (8, 19),
        "condition in parentheses",
    ),
    "no variable": ("(?a - area)\n    :pre", "(a - area)\n    :pre", "E915", (7, 18), "no variable"),
    "object with question mark": ("a1 a2 - area", "?a1 a2 - area", "E915", (12, 13), "is a variable"),
    "no type": ("a1 a2 - area", "a1 a2 -", "E915", (12, 19), "no type"),
    "too deep": (
        "(dirt ?a)\n    :eff",
        f"{'(not ' * 90}(dirt ?a){')' * 90}\n    :eff",
        "E915",
        (8, 404),
        "deep",
    ),
    "not of two": ("(not (dirt ?a)) (inc", "(not (dirt ?a) (dirt ?a)) (inc", "E915", (9, 50), "one atom"),
    "or as effect": ("(not (dirt ?a)) (inc", "(or (dirt ?a)) (inc", "E915", (9, 50), "no effect"),
    "no number": ("0.8 (in", "most (in", "E915", (9, 33), "expected a probability"),
    "no pair": ("0.8 (in ?a bin)", "0.8", "E915", (9, 18), "pairs"),
    "above one": ("0.8 (in", "80 (in", "E918", (9, 33), "`80` is no probability"),
    "below zero": ("0.8 (in", "-0.8 (in", "E918", (9, 33), "`-0.8` is no probability"),
    "sum": ("0.8 (in ?a bin)", "0.8 (in ?a bin) 0.3 (dirt ?a)", "E918", (9, 18), "sum to 1.1"),
    "unbound": ("(not (dirt ?a)) (inc", "(not (dirt ?b)) (inc", "E916", (9, 61), "`?b` is not bound"),
    "unknown object": ("(in ?a bin)", "(in ?a bim)", "E916", (9, 44), "unknown object `bim`"),
    "unknown predicate": (":precondition (dirt", ":precondition (dirty", "E916", (8, 20), "`dirty`"),
    "number of terms": (
        ":precondition (dirt ?a)",
        ":precondition (dirt ?a bin)",
        "E916",
        (8, 19),
        "1 term, not 2",
    ),
    "type": ("(in ?a bin)", "(in ?a ?a)", "E916", (9, 44), "is of type `area`"),
    "unknown type": (
        "(?a - area)\n    :pre",
        "(?a - aera)\n    :pre",
        "E916",
        (7, 23),
        "unknown type `aera`",
    ),
    "bound twice": ("(?a - area)\n    :pre", "(?a ?a - area)\n    :pre", "E916", (7, 21), "bound twice"),
    "second goal": (
        "(:metric",
        "(:goal (dirt a1)) (:metric",
        "E915",
        (15, 3),
        "a second `:goal`",
    ),
    "goal of two": ("(:goal (", "(:goal (dirt a1) (", "E915", (14, 20), "`:goal` holds one thing"),
    "metric nearly": ("minimize (total-cost)", "minimize (total-costs)", "E916", (15, 22), "`total-costs`"),
    "circle": (
        "area container - place)",
        "area container - place place - area)",
        "E916",
        (2, 11),
        "below itself",
    ),
    "two parents": (
        "area container - place)",
        "area - (either a b))",
        "E917",
        (2, 26),
        "below several types",
    ),
    "declared in two ways": (
        "(dirt ?a - area)",
        "(dirt ?a - area) (dirt ?c - container)",
        "E916",
        (4, 34),
        "in two ways",
    ),
    "comparison": (
        ":precondition (dirt ?a)",
        ":precondition (> (total-cost) 1)",
        "E917",
        (8, 19),
        "compared",
    ),
    "no chances": ("(probabilistic 0.8 (in", "(oneof (ready) (in", "E917", (9, 18), "how likely"),
    "assignment": ("(increase (total-cost) 2)", "(assign (total-cost) 2)", "E917", (9, 66), "`assign`"),
    "unknown function": ("(total-cost) 2)", "(total-cost) (far ?a))", "E916", (9, 90), "function `far`"),
    "cost that is no sum": ("(total-cost) 2)", "(total-cost) (/ 1 0))", "E917", (9, 66), "never change"),
    "earning": ("(increase (total-cost) 2)", "(decrease (total-cost) 2)", "E917", (6, 12), "`push` earns"),
    "cost by many conditions": (
        "(increase (total-cost) 2)",
        "".join(f"(when (in ?a c{n}) (increase (total-cost) {n}))" for n in range(1, 6)),
        "E917",
        (6, 12),
        "more conditions",
    ),
    "metric": ("minimize (total-cost)", "minimize (+ (total-cost) (x))", "E917", (15, 21), "one function"),
    "initial condition": (
        "(dirt a2))",
        "(probabilistic 0.5 (when (dirt a1) (dirt a2))))",
        "E917",
        (13, 20),
        "before the first action",
    ),
    "never": ("(forall (?a - area) (not (dirt ?a)))", "(= a1 a2)", "E917", (14, 10), "never hold"),
    "preference": ("(dirt ?a)\n", "(preference p (dirt ?a))\n", "E917", (8, 19), "preferences"),
    "course of a plan": (
        "(forall (?a - area) (not (dirt ?a)))",
        "(always (dirt a1))",
        "E917",
        (14, 10),
        "course of a plan",
    ),
    "timed literal": ("(dirt a2))", "(at 5 (dirt a2)))", "E917", (13, 20), "at a time of its own"),
    "derived": ("  (:functions", "  (:derived (p) (and)) (:functions", "E917", (5, 4), "derived predicates"),
}

MENDED = {
    "parenthesis too many": ("2))))", "2)))))", (9, 94), "closes nothing"),
    "parentheses missing at the end": (
        "(total-cost)))\n",
        "(total-cost)\n",
        (10, 1),
        "2 parentheses are missing",
    ),
    "parenthesis missing inside": (
        "(?c - container))".replace("(?", "?"),
        "?c - container)",
        (4, 3),
        "missing",
    ),
    "no blank": ("(dirt ?a - area) (in", "(dirt ?a -area) (in", (4, 25), "no blank stands behind `-`"),
    "declared twice": ("(:constants bin", "(:constants bin bin", (3, 19), "`bin` is declared twice"),
    "type declared twice": ("(:types area", "(:types area - place area", (2, 24), "`area` is declared twice"),
    "predicate declared twice": ("(dirt ?a - area)", "(dirt ?a - area) (dirt ?b - area)", (4, 34), "twice"),
    "a fact and its opposite": (
        "(dirt a1)",
        "(not (dirt a1)) (dirt a1)",
        (13, 15),
        "`dirt` holds, and does not hold, of the same",
    ),
    "metric of nothing": (
        "minimize (total-cost)",
        "minimize (fuel)",
        (15, 22),
        "the function `fuel` is not declared",
    ),
    "a fact twice": ("(dirt a1)", "(dirt a1) (dirt a1)", (13, 20), "holds twice"),
    "undeclared predicate": ("(not (dirt ?a)) (inc", "(seen ?a) (not (dirt ?a)) (inc", (9, 51), "`seen`"),
    "undeclared type": ("a2 - area", "a2 - area m - machine", (12, 30), "`machine` is not declared"),
    "an object of the problem": (
        "(dirt ?a)\n",
        "(and (dirt ?a) (dirt a1))\n",
        (8, 40),
        "only a problem declares",
    ),
    "narrow predicate": ("(?a - area)\n    :pre", "(?a - place)\n    :pre", (8, 25), "is of type `place`"),
    "unknown section": ("(:functions", "(:fluents", (5, 3), "no section"),
    "another domain": ("(:domain tidy)", "(:domain tidier)", (11, 12), "for `tidier`"),
    "section behind the end": (
        "(total-cost)))",
        "(total-cost))) (:objects a3 - area)",
        (15, 36),
        "behind the end",
    ),
}


def converted(text: str) -> Converted:
    return convert([Source("given.pddl", text)], Wishes())


def place(diagnostic: Diagnostic, text: str) -> tuple[int, int]:
    assert diagnostic.span is not None
    return Lines(text).place(diagnostic.span.start)


def test_the_file_without_a_mistake_is_converted() -> None:
    assert converted(TEXT).diagnostics == ()


@pytest.mark.parametrize("name", MISTAKES)
def test_each_mistake_is_located(name: str) -> None:
    old, new, code, where, words = MISTAKES[name]
    assert old in TEXT, "the mistake is not in the text"
    text = TEXT.replace(old, new, 1)
    if name == "cost by many conditions":
        text = text.replace("bin - container", "bin c1 c2 c3 c4 c5 - container", 1)
    with pytest.raises(Refused) as caught:
        converted(text)
    found = [(d.code, place(d, text), d.message) for d in caught.value.diagnostics]
    assert any(each[:2] == (code, where) and words in each[2] for each in found), found


@pytest.mark.parametrize("name", MENDED)
def test_what_is_plainly_meant_is_a_warning(name: str) -> None:
    old, new, where, words = MENDED[name]
    assert old in TEXT, "the fault is not in the text"
    text = TEXT.replace(old, new, 1)
    made = converted(text)
    found = [(place(d, text), d.message) for d in made.diagnostics if d.code == "W911"]
    assert any(each[0] == where and words in each[1] for each in found), found
    assert all(d.code in ("W911", "W402") and d.label for d in made.diagnostics if d.code == "W911")


@pytest.mark.parametrize(
    ("written", "is_mended"),
    [
        ("0.95 (in ?a bin) 0.050000000000000044", True),
        ("0.9 (in ?a bin) 0.09999999999999998", True),
        ("0.3333333333333333 (in ?a bin) 0.6666666666666666", True),
        ("1/3 (in ?a bin) 2/3", False),
    ],
)
def test_probabilities_that_miss_one_by_rounding_sum_to_one(written: str, is_mended: bool) -> None:
    text = TEXT.replace("0.8 (in ?a bin)", f"{written} (dirt ?a)", 1)
    made = converted(text)
    found = [(d.code, place(d, text)) for d in made.diagnostics]
    assert found == ([("W911", (9, 18))] if is_mended else [])
    first, second = (Fraction(part) for part in written.split(" (in ?a bin) "))
    domain = load_domain(Source("tidy.nid", made.domain))
    chances = [outcome.probability for rule in domain.rules for outcome in rule.outcomes]
    assert sum(chances) == len(domain.rules)
    assert len(chances) == 2 * len(domain.rules)
    assert max(chances) == pytest.approx(float(max(first, second)), abs=1e-15)


def test_probabilities_that_miss_one_by_more_are_as_they_are() -> None:
    """A third to six digits leaves a millionth, in which nothing changes."""
    made = converted(TEXT.replace("0.8 (in ?a bin)", "0.333333 (in ?a bin) 0.666666 (dirt ?a)", 1))
    assert made.diagnostics == ()
    assert "0.000001" in made.domain or "rest" in made.domain


LAMP = """\
(define (domain lamp)
  (:predicates (lit) (broken))
  (:action switch
    :parameters ()
    :precondition (and (not (lit)) (not (broken)))
    :effect (probabilistic 0.9 (lit) 0.1 (broken)))
  (:action darken :precondition (lit) :effect (not (lit))))
(define (problem dark) (:domain lamp) (:init (lit)) (:goal (not (lit))))
"""


@pytest.mark.parametrize(
    ("old", "new", "where", "words"),
    [
        ("0.9 (lit) 0.1", "0.9 lit 0.1", (6, 32), "`lit` stands without parentheses"),
        ("(not (broken))", "(not broken)", (5, 41), "`broken` stands without parentheses"),
        ("(lit) :effect", "lit :effect", (7, 33), "`lit` stands without parentheses"),
        (":effect (not (lit))", ":effect (not lit)", (7, 52), "`lit` stands without parentheses"),
        (":goal (not (lit))", ":goal (not lit)", (8, 65), "`lit` stands without parentheses"),
        (":parameters ()", ":parameters", (4, 5), "nothing stands behind `:parameters`"),
    ],
)
def test_what_is_left_out_of_parentheses_is_a_warning(
    old: str, new: str, where: tuple[int, int], words: str
) -> None:
    """The simulator of the planning competitions takes a predicate alone, and files rely on it."""
    text = LAMP.replace(old, new, 1)
    made = converted(text)
    assert [(d.code, place(d, text), d.message) for d in made.diagnostics] == [("W911", where, words)]
    assert (made.domain, made.problems) == (converted(LAMP).domain, converted(LAMP).problems)


LIDS = """\
(define (domain lids)
  (:types box lid)
  (:predicates (shut ?b - box) (open) (done))
  (:action go
    :precondition (exists (?l - lid) (open))
    :effect (and (forall (?l - lid) (done)) (forall (?b - box) (shut ?b)))))
"""
A_PROBLEM = "(define (problem {0}) (:domain lids) (:objects {1}) (:init (open)) (:goal (done)))\n"
WITH, WITHOUT = A_PROBLEM.format("one", "b - box l - lid"), A_PROBLEM.format("two", "b - box")


@pytest.mark.parametrize("problems", ["", WITH + WITHOUT])
def test_a_type_of_which_a_problem_may_have_no_object_is_told(problems: str) -> None:
    text = LIDS + problems
    found = [d for d in converted(text).diagnostics if d.code == "W912"]
    assert [place(d, text) for d in found] == [(5, 19), (6, 37)]
    assert all("an object of type `lid`" in d.message for d in found)


@pytest.mark.parametrize(
    "text", [LIDS + WITH, LIDS + WITHOUT, LIDS.replace("box lid)", "box lid)\n(:constants l - lid)")]
)
def test_nothing_is_told_where_it_is_known_whether_a_type_has_objects(text: str) -> None:
    assert "W912" not in {d.code for d in converted(text).diagnostics}


@pytest.mark.parametrize(
    ("types", "places"),
    [
        ("a - b b - c c - b", [(2, 17)]),
        ("a - a b - a", [(2, 11)]),
        ("a - b b - a c - d d - c", [(2, 11), (2, 23)]),
    ],
)
def test_of_a_circle_one_type_is_told_and_none_of_those_below_it(
    types: str, places: list[tuple[int, int]]
) -> None:
    text = TEXT.replace("(:types area", f"(:types {types} area")
    with pytest.raises(Refused) as refused:
        converted(text)
    assert [place(each, text) for each in refused.value.diagnostics] == places


@pytest.mark.parametrize(("last", "circles"), [("area", []), ("t0", ["the type `t0` is below itself"])])
def test_long_lines_of_types_and_many_at_once_are_read_quickly(last: str, circles: list[str]) -> None:
    """3,000 types took a minute when each line was followed anew, and one of either 6 s."""
    line = " ".join(f"t{n} - t{n + 1}" for n in range(3000))
    beside = " ".join(f"u{n}" for n in range(3000))
    text = TEXT.replace("(:types area", f"(:types {line} t3000 - {last} {beside} area")
    text = text.replace("(in ?a - area", f"(in ?a - (either area {beside})")
    started = time.process_time()
    assert mistakes_of(text) == circles
    assert time.process_time() - started < 5


LONG = [f"1/{10**17 + 2 * n + 1}" for n in range(500)]
"""Numbers of which no two have much of their denominators in common."""
TOO_MANY = "the common denominator of this number and of those before it has too many digits"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(total-cost) 2)", "(total-cost) 1e400)", "this number has too many digits for a .nid file"),
        ("(total-cost) 2)", f"(total-cost) {'9' * 31})", "this number has too many digits for a .nid file"),
        ("(total-cost) 2)", "(total-cost) 1e30)", "this number has too many digits for a .nid file"),
        ("(total-cost) 2)", f"(total-cost) (* {'1e9 ' * 4000}))", "this number has too many digits"),
        ("(total-cost) 2)", f"(total-cost) (* {'1e-9 ' * 4000}))", "this number has too many digits"),
        ("(total-cost) 2)", f"(total-cost) (+ {' '.join(LONG)}))", TOO_MANY),
        ("(increase", f"{' '.join(f'(increase (total-cost) {each})' for each in LONG)} (increase", TOO_MANY),
        ("0.8 (in ?a bin)", " ".join(f"{each} (in ?a bin)" for each in LONG), TOO_MANY),
        ("(dirt a2)", f"(probabilistic {' '.join(f'{each} (dirt a2)' for each in LONG)})", TOO_MANY),
        (
            "(probabilistic 0.8 (in ?a bin))",
            f"{f'(probabilistic 0.{60 * chr(55)} ' * 70}(in ?a bin){')' * 70}",
            "a probability, reward or cost of `push` has too many digits for a .nid file",
        ),
        ("(:metric minimize (total-cost))", "(:goal-reward 1e50)", "this number has too many digits"),
    ],
)
def test_numbers_that_no_text_can_state_are_refused_at_once(old: str, new: str, message: str) -> None:
    """docs/diagnostics.md, E917: what was read of them could not be written, or took long to add up."""
    text = TEXT.replace(old, new, 1)
    started = time.process_time()
    with pytest.raises(Refused) as refused:
        converted(text)
    assert time.process_time() - started < 5
    (found,) = refused.value.diagnostics
    assert (found.code, found.message[: len(message)]) == ("E917", message)
    assert mistakes_of(text) == [found.message]


@pytest.mark.parametrize(
    "number",
    [
        "1e29",
        "1e-99",
        "1/999999999999999999",
        "123456789012345678.5",
        "1e-3",
        ".5",
        f"0.{'3' * 70}",
        "9" * 30,
    ],
)
def test_long_numbers_are_stated(number: str) -> None:
    text = TEXT.replace("(total-cost) 2)", f"(total-cost) {number})")
    domain = load_domain(Source("tidy.nid", converted(text).domain))
    assert [action.cost.number for action in domain.actions] == [Fraction(number)]


def mistakes_of(text: str) -> list[str]:
    try:
        found = models_of(Source("given.pddl", text)).diagnostics
    except Refused as refused:
        found = refused.diagnostics
    return [each.message for each in found if each.level is Level.ERROR]


def test_too_many_outcomes_are_refused() -> None:
    """Ten independent draws have 1024 results, and the push doubles them."""
    places = " ".join(f"m{n}" for n in range(10))
    text = TEXT.replace("bin - container", f"bin - container {places} - area", 1)
    draws = " ".join(f"(probabilistic 0.5 (dirt {place}))" for place in places.split())
    with pytest.raises(Refused, match="`push` has more than 512 outcomes") as caught:
        converted(text.replace("(not (dirt ?a)) (inc", f"{draws} (inc"))
    assert "divide the draws among several actions" in caught.value.diagnostics[0].help


def test_a_function_without_values_for_too_many_objects_is_refused() -> None:
    """A .nid problem would state them all, and 3 to the power of 40 fill any memory."""
    parameters = " ".join(f"?x{n}" for n in range(40))
    text = TEXT.replace("(total-cost))\n  (:action", f"(total-cost) (far {parameters}))\n  (:action")
    text = text.replace("(increase (total-cost) 2)", f"(increase (total-cost) (far {'?a ' * 40}))")
    with pytest.raises(Refused) as refused:
        converted(text)
    (wrong,) = refused.value.diagnostics
    assert (wrong.code, place(wrong, text)) == ("E917", (9, 90))
    assert "no value for more than 50000 combinations" in wrong.message


def test_mistakes_are_told_at_once() -> None:
    text = TEXT.replace("(in ?a bin)", "(in ?a bim)").replace("(dirt a2))", "(dirt a9))")
    text = text.replace(":precondition (dirt ?a)", ":precondition (dirt ?z)")
    with pytest.raises(Refused) as caught:
        converted(text)
    assert [d.code for d in caught.value.diagnostics] == ["E916"] * 3


def test_what_cannot_be_said_hides_no_mistake() -> None:
    """What is left out for having no word is told beside all mistakes of names."""
    text = TEXT.replace("(dirt ?a)\n", "(preference p (dirt ?a))\n").replace("(dirt a2)", "(dirt a3)")
    text = text.replace("(forall (?a - area) (not (dirt ?a)))", "(sometime (in a1 bin))")
    with pytest.raises(Refused) as refused:
        converted(text)
    told = [(each.code, place(each, text)) for each in refused.value.diagnostics]
    assert told == [("E917", (8, 19)), ("E916", (13, 26)), ("E917", (14, 10))]


@pytest.mark.parametrize(
    "facts",
    [
        "(dirt a1) (dirt a3) (clean a1) (in a1)",
        "(dirt a1)\n  (DIRT A1) ; again\n  (in a1 a2)",
        "(in bin a1) (dirt) (wiped) (wiped)",
        "(dirt a1) (not a1) (increase a1)",
        "(dirt a1)(in a2 bin)( dirt\n a2 )(dart a1)",
    ],
)
def test_facts_alone_are_told_as_those_beside_other_things_are(facts: str) -> None:
    """An `:init` of facts alone is read in one piece; a value at its end makes it be read one by one."""

    def told(more: str) -> list[Diagnostic]:
        text = TEXT.replace("(dirt a1) (dirt a2))\n", f"{facts}{more})\n")
        try:
            found = converted(text).diagnostics
        except Refused as refused:
            found = refused.diagnostics
        return [each for each in found if each.span is not None and each.span.path == "given.pddl"]

    assert told("") == told(" (= (total-cost) 0)") != []


def test_facts_of_the_objects_of_another_problem_are_mistakes() -> None:
    text = LIDS + WITH + WITHOUT.replace("(open)", "(open) (shut l)")
    text = text.replace("(shut ?b - box)", "(shut ?b - object)", 1)
    with pytest.raises(Refused) as caught:
        converted(text)
    (found,) = (each for each in caught.value.diagnostics if each.code != "W912")
    assert (found.code, found.message) == ("E916", "unknown object `l`")
    assert found.span is not None
    assert text[found.span.start - len("(shut ") : found.span.end + 1] == "(shut l)"


def test_an_object_has_in_each_problem_the_type_that_it_has_there() -> None:
    """A name of two problems is two objects: the last of them was taken in both."""
    head, start = TEXT.split("(define (problem")
    others = f"(define (problem{start}(define (problem{start}".replace("problem two", "problem one", 1)
    wide = others.replace("(:objects a1 a2 - area)", "(:objects a1 a2 - place)", 1)
    found = converted(head + wide).diagnostics
    assert [(each.code, place(each, head + wide)) for each in found] == [("W911", (13, 16))]
    domain = load_domain(Source("tidy.nid", converted(head + wide).domain))
    for text in converted(head + wide).problems.values():
        load_problem(Source("problem.nid", text), domain)


@pytest.mark.parametrize("seed", range(3))
def test_damaged_files_are_refused_or_converted(seed: int) -> None:
    """Whatever stands in a file, it is a located refusal, or texts that the checker can read."""
    rng = Random(seed)
    for _ in range(60):
        text = TEXT
        for _ in range(rng.choice((1, 1, 3))):
            text = damaged(text, rng)
        made = converted_or_refused(text)
        codes = {d.code for d in made.diagnostics}
        if isinstance(made, Refused):
            assert codes <= {"E915", "E916", "E917", "E918", "W911", "W912"}
            assert all(d.span is not None for d in made.diagnostics)
        else:
            assert not [code for code in codes if code.startswith("E")], text


def converted_or_refused(text: str) -> Converted | Refused:
    try:
        return converted(text)
    except Refused as refused:
        return refused


def damaged(text: str, rng: Random) -> str:
    """The text with a word lost, doubled or exchanged, or a sign in a wrong place."""
    words = text.replace("(", " ( ").replace(")", " ) ").split(" ") or [""]
    at = rng.randrange(len(words))
    match rng.randrange(5):
        case 0:
            words[at] = ""
        case 1:
            words[at] += f" {words[at]}"
        case 2:
            words[at] = rng.choice(words)
        case 3:
            words[at] = rng.choice(
                ["(", ")", "-", "?", ":", "?x", "1/0", "\x00", "é", "and", "when", ":init"]
            )
        case _:
            words = words[:at]
    return " ".join(words)
