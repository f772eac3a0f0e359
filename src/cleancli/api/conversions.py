"""Files of other languages as the texts of a domain and its problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.checks import check_between, check_one_of, check_share
from cleancli.api.plain import fields_of
from cleancli.conversion.convert import Wishes as LibpradaWishes
from cleancli.conversion.convert import convert as convert_libprada
from cleancli.conversion.pddl.convert import Wishes
from cleancli.conversion.pddl.convert import convert as convert_pddl
from cleancli.conversion.pddl.recognized import SUFFIXES, is_pddl
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.load import read_source
from cleancli.planning.plan import BadOption

FORMATS = ("pddl", "libprada")
LIBPRADA = ("rules.dat", "state.dat", "symbols.dat")


@dataclass(frozen=True, slots=True)
class ConversionResult:
    """The texts of a domain and its problems, by their names, and what has to be told about them. `functions`
    has the predicates of libPRADA that a function stands for; `sources` has the texts that `diagnostics`
    point into. Prints as the domain's text."""

    name: str
    domain: str
    problems: Mapping[str, str]
    functions: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]

    def __str__(self) -> str:
        return self.domain

    def files(self, folder: str | Path) -> dict[Path, str]:
        """The texts by the paths that they have in a folder, the domain's first."""
        texts = {self.name: self.domain, **self.problems}
        return {Path(folder) / f"{name}.nid": text for name, text in texts.items()}

    def write(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Writes all files or none into a folder, and says which; `force` replaces those that exist. Raises
        Refused."""
        files = self.files(folder)
        before = [read_source(str(path)).text if force and path.exists() else None for path in files]
        for path in files:
            path.parent.mkdir(parents=True, exist_ok=True)
        pairs = zip(files.items(), before, strict=True)
        write_all(Replacement(path, text, old) for (path, text), old in pairs)
        return tuple(files)

    def to_dict(self) -> dict[str, object]:
        """Everything but what the diagnostics point into."""
        return fields_of(self, ("diagnostics", "sources"))


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
