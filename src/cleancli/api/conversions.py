"""Files of other languages as the texts of a domain and its problems."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cleancli.api.checks import check_between, check_one_of, check_share
from cleancli.api.conversion_result import ConversionResult
from cleancli.conversion.convert import Wishes as LibpradaWishes
from cleancli.conversion.convert import convert as convert_libprada
from cleancli.conversion.pddl.convert import Wishes
from cleancli.conversion.pddl.convert import convert as convert_pddl
from cleancli.conversion.pddl.recognized import SUFFIXES, is_pddl
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import read_source
from cleancli.planning.plan import BadOption

FORMATS = ("pddl", "libprada")
LIBPRADA = ("rules.dat", "state.dat", "symbols.dat")


def convert(
    *files: str | Path,
    format: str | None = None,
    domain_name: str | None = None,
    horizon: int | None = None,
    reward: str | None = None,
    discount: float | None = None,
    predicates: bool = False,
) -> ConversionResult:
    """Convert PDDL and PPDDL, paths or texts of a domain and any number of its problems, or libPRADA's rules,
    state and symbols, by path or by that of their folder. `format` is told by names where it is not given.

    `reward`, `discount` and `predicates` are for libPRADA. Raises Refused with every mistake in the files,
    and BadOption.
    """
    options = (reward, discount, predicates)
    return converted([str(file) for file in files], format, domain_name, horizon, *options)


def converted(
    files: Sequence[str],
    format: str | None,
    domain_name: str | None,
    horizon: int | None,
    reward: str | None,
    discount: float | None,
    predicates: bool,
    folder: Path = Path(),
) -> ConversionResult:
    """As `convert`; mistakes that are found in new texts go by their paths in `folder`."""
    if format is not None:
        check_one_of("format", format, FORMATS)
    check_between(1, 1000, horizon=horizon)
    check_share("discount", discount)
    if any(name.lower().endswith(".rddl") for name in files):
        raise BadOption("RDDL is not converted: only PDDL, PPDDL and libPRADA's files are")
    names_pddl = any(name.lower().endswith(SUFFIXES) or is_pddl(Source("", name)) for name in files)
    if format == "pddl" or (format is None and names_pddl):
        if reward is not None or discount is not None or predicates:
            raise BadOption("reward, discount and predicates are for libPRADA's files")
        return _from_pddl(files, Wishes(domain_name, horizon))
    usual = 0.95 if discount is None else discount
    wishes = LibpradaWishes(domain_name or "domain", reward, horizon, usual, predicates)
    return _from_libprada(files, wishes, folder)


def _from_pddl(files: Sequence[str], wishes: Wishes) -> ConversionResult:
    sources = [
        Source(f"<text {number}>", given) if is_pddl(Source("", given)) else read_source(given)
        for number, given in enumerate(files, 1)
    ]
    made = convert_pddl(sources, wishes)
    told = (made.notes, made.diagnostics, made.sources)
    return ConversionResult(made.name, made.domain, made.problems, {}, *told)


def _from_libprada(files: Sequence[str], wishes: LibpradaWishes, folder: Path) -> ConversionResult:
    if len(files) not in (1, len(LIBPRADA)):
        raise BadOption("give a folder, or the files of rules, state and symbols")
    paths = files if len(files) == len(LIBPRADA) else [str(Path(files[0]) / name) for name in LIBPRADA]
    rules, state, symbols = (read_source(path) for path in paths)
    targets = (str(folder / f"{wishes.name}.nid"), str(folder / "problem.nid"))
    made = convert_libprada(rules, state, symbols, wishes, targets)
    told = (made.notes, made.diagnostics, made.sources)
    return ConversionResult(wishes.name, made.domain, {"problem": made.problem}, made.functions, *told)
