"""Files of other languages as the texts of a domain and its problems, and the other way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.checks import check_between, check_one_of, check_share
from cleancli.api.conversion_result import ConversionResult
from cleancli.api.experience_files import (
    DATA,
    Traces,
    is_experience,
    traces_in,
    with_experience,
    with_recorded,
)
from cleancli.api.exports import exported, opened
from cleancli.conversion.convert import Wishes as LibpradaWishes
from cleancli.conversion.convert import convert as convert_libprada
from cleancli.conversion.export.written import NOISE
from cleancli.conversion.pddl.convert import Wishes
from cleancli.conversion.pddl.convert import convert as convert_pddl
from cleancli.conversion.pddl.recognized import SUFFIXES, is_pddl
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Problem
from cleancli.planning.plan import BadOption

FORMATS = ("nid", "pddl", "libprada")
TARGETS = ("nid", "ppddl", "rddl", "libprada")
REWARD = "reward.dat"
LIBPRADA = ("rules.dat", "state.dat", "symbols.dat")


def convert(
    *files: str | Path,
    format: str | None = None,
    to: str = "nid",
    domain_name: str | None = None,
    horizon: int | None = None,
    reward: str | None = None,
    discount: float | None = None,
    predicates: bool = False,
    noise: str = "unchanged",
) -> ConversionResult:
    """Convert PDDL and PPDDL, paths or texts of a domain and any number of its problems, or libPRADA's rules,
    state and symbols, by path or by that of their folder. `format` is told by names where it is not given.

    With `to="ppddl"` a domain and its problems, .nid or PPDDL, are written as PPDDL: names of shipped files,
    paths or texts; with `to="rddl"` or `to="libprada"` a domain and one problem so. `noise` says what becomes
    of noise there. `reward`, `discount` and `predicates` are for libPRADA's files.

    Experience (.jsonl) becomes trajectories of PDDL, or data.dat of libPRADA, and these become experience.
    They are given beside their domain, and data.dat with the problem too, or in libPRADA's
    folder.

    Raises Refused with every mistake in the files, or with all that can't be said, and BadOption.
    """
    wanted = Wanted(format, to, domain_name, horizon, reward, discount, predicates, noise)
    return converted([str(file) for file in files], wanted)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a conversion is asked for; the fields are as in `convert`."""

    format: str | None
    to: str
    domain_name: str | None
    horizon: int | None
    reward: str | None
    discount: float | None
    predicates: bool
    noise: str


def converted(
    files: Sequence[str], wanted: Wanted, folder: Path = Path(), include_outside: bool = False
) -> ConversionResult:
    """As `convert`; mistakes that are found in new texts go by their paths in `folder`. A domain may include
    files from outside its folder where `include_outside` says so."""
    if wanted.format is not None:
        check_one_of("format", wanted.format, FORMATS)
    check_one_of("to", wanted.to, TARGETS)
    check_between(1, 1000, horizon=wanted.horizon)
    check_share("discount", wanted.discount)
    if any(name.lower().endswith(".rddl") for name in files):
        raise BadOption(
            "RDDL is not converted: only PDDL, PPDDL and libPRADA's files are; it can be written (`rddl`)"
        )
    of_libprada = wanted.reward is not None or wanted.discount is not None or wanted.predicates
    traces = traces_in(files)
    if wanted.to != "nid":
        if traces.trajectories or traces.data:
            raise BadOption("trajectories and data.dat become experience: leave out `to`")
        _refuse_for_export(wanted, of_libprada)
        return exported(files, wanted.to, wanted.noise, include_outside)
    if wanted.noise != NOISE[0]:
        raise BadOption("noise has a word of its own in .nid files: `noise` is for what is written of them")
    if traces.trajectories or traces.data:
        return _from_traces(files, traces, wanted, include_outside)
    format = wanted.format or _format_of(files)
    if any(map(is_experience, files)):
        raise BadOption("this is experience: say what to write of it, and of its domain: ppddl, libprada")
    if format == "nid":
        raise BadOption(f"these are .nid files: say what to write: {', '.join(TARGETS[1:])}")
    if format == "pddl":
        if of_libprada:
            raise BadOption("reward, discount and predicates are for libPRADA's files")
        return _from_pddl(files, Wishes(wanted.domain_name, wanted.horizon))
    usual = 0.95 if wanted.discount is None else wanted.discount
    name = wanted.domain_name or "domain"
    wishes = LibpradaWishes(name, wanted.reward, wanted.horizon, usual, wanted.predicates)
    return _from_libprada(files, wishes, folder)


def _format_of(files: Sequence[str]) -> str:
    """What files are, by their names, or by how they begin where they are texts."""
    if any(name.lower().endswith(SUFFIXES) or is_pddl(Source("", name)) for name in files):
        return "pddl"
    return "nid" if any(name.lower().endswith(".nid") or "{" in name for name in files) else "libprada"


def _refuse_for_export(wanted: Wanted, of_libprada: bool) -> None:
    """Raises BadOption for what says how .nid files are to be made."""
    if wanted.format == "libprada":
        raise BadOption("convert libPRADA's files to .nid files first, and those then")
    if of_libprada or wanted.domain_name is not None or wanted.horizon is not None:
        raise BadOption("domain_name, horizon, reward, discount and predicates are for making .nid files")


def _from_pddl(files: Sequence[str], wishes: Wishes) -> ConversionResult:
    sources = [
        Source(f"<text {number}>", given) if is_pddl(Source("", given)) else read_source(given)
        for number, given in enumerate(files, 1)
    ]
    made = convert_pddl(sources, wishes)
    told = (made.notes, made.diagnostics, made.sources)
    texts = _files({made.name: made.domain, **made.problems})
    return ConversionResult(made.name, made.domain, made.problems, {}, *told, texts, {})


def _from_traces(
    files: Sequence[str], traces: Traces, wanted: Wanted, include_outside: bool
) -> ConversionResult:
    """Experience of a domain that is given: of a .nid file, or of PPDDL, which is converted too."""
    rest = [name for name in files if name not in (*traces.trajectories, *traces.data)]
    if _format_of(rest) == "pddl":
        made = _from_pddl(rest, Wishes(wanted.domain_name, wanted.horizon))
        domain = load_domain(Source(f"{made.name}.nid", made.domain))
        texts = made.problems.items()
        problems = [load_problem(Source(f"{name}.nid", text), domain) for name, text in texts]
        return with_experience(made, traces, domain, problems, whole=False)
    loaded, given = opened(rest, include_outside)
    made = ConversionResult(loaded.name, str(loaded), {}, {}, (), (), (), {}, {})
    models = [each.model for each in given if isinstance(each.model, Problem)]
    return with_experience(made, traces, loaded.model, models, whole=True)


def _from_libprada(files: Sequence[str], wishes: LibpradaWishes, folder: Path) -> ConversionResult:
    if len(files) not in (1, len(LIBPRADA), len(LIBPRADA) + 1):
        raise BadOption("give a folder, or the files of rules, state and symbols, and perhaps of data")
    paths = list(files)
    reward = Path(files[0]) / REWARD if len(files) == 1 else None
    if len(files) == 1:
        paths = [str(Path(files[0]) / name) for name in LIBPRADA]
        paths += [str(data)] if (data := Path(files[0]) / DATA).exists() else []
    rules, state, symbols, *data_sources = (read_source(path) for path in paths)
    targets = (str(folder / f"{wishes.name}.nid"), str(folder / "problem.nid"))
    goal = read_source(str(reward)) if reward is not None and reward.exists() else None
    made = convert_libprada(rules, state, symbols, wishes, targets, goal)
    told = (made.notes, made.diagnostics, made.sources)
    problems = {"problem": made.problem}
    texts = _files({wishes.name: made.domain, **problems})
    result = ConversionResult(wishes.name, made.domain, problems, made.functions, *told, texts, {})
    return with_recorded(result, data_sources[0], made) if data_sources else result


def _files(texts: Mapping[str, str]) -> dict[str, str]:
    """Texts by the names of their files."""
    return {f"{name}.nid": text for name, text in texts.items()}
