"""`cleancli learn`: what experience says about a domain's probabilities, as a diff or in place."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from cleancli.api.accounts import Accounts, suggested, told
from cleancli.api.accounts import as_data as account_data
from cleancli.api.agreements import agreement
from cleancli.api.learned import LearningResult
from cleancli.api.lessons import Counting, lessons
from cleancli.api.structure_result import StructureResult
from cleancli.api.structures import Wanted, structures
from cleancli.cli import options, progress
from cleancli.cli.command_table import command_of
from cleancli.cli.completion import domains
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.files import echo_difference
from cleancli.cli.inputs import may_include_outside, open_loaded, ships_with
from cleancli.cli.progress import working
from cleancli.cli.usage import usage_errors
from cleancli.files.replace import refuse_existing
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.learning.structure.induce import SEARCHES, TREE


@command_of("learn")
@options.learning()
@click.option(
    "--add",
    is_flag=True,
    help="Count on from what DOMAIN has counted, passing over experience that it counts.",
)
@click.option("--replace", is_flag=True, help="Drop what DOMAIN has counted and is not given.")
@click.option(
    "--check",
    is_flag=True,
    help="Learn nothing; say of each rule whether EXPERIENCE agrees with its probabilities.",
)
@click.option(
    "--explain",
    is_flag=True,
    help="Learn nothing; say what each transition counts for, and which outcomes would explain noise.",
)
@click.option(
    "--structure",
    is_flag=True,
    help="Learn whole rules: conditions, references, outcomes and probabilities; see the docs.",
)
@click.option(
    "--vocabulary",
    metavar="FILE",
    shell_complete=domains,
    help="With --structure, in place of DOMAIN: a domain without rules, or whose rules are left aside.",
)
@click.option(
    "--action",
    "actions",
    multiple=True,
    metavar="NAME",
    help="With --structure: learn the rules of this action; may be repeated.  [default: all]",
)
@click.option(
    "--search",
    type=click.Choice(SEARCHES),
    help="With --structure: how contexts are found, by a decision tree or as in 2007; see the docs."
    f"  [default: {TREE.search}]",
)
@options.seed("what --structure holds out", "0")
@options.jobs("Processes that --structure shares the actions among; the rules are the same.")
@click.option(
    "--output",
    type=options.FILE,
    help="Write the learned domain to a file of its own, which must not exist.",
)
@click.option(
    "--write", is_flag=True, help="Change the probabilities in the domain's file and those it includes."
)
@click.option(
    "--diff", is_flag=True, help="Print the change as a diff also with --write, --output or --json."
)
@options.as_json("Print what was learned as JSON.")
def command(
    domain: str | None,
    experience: tuple[Path, ...],
    estimator: str | None,
    m: float | None,
    match: str | None,
    forgetting: float | None,
    add: bool,
    replace: bool,
    check: bool,
    explain: bool,
    structure: bool,
    vocabulary: str | None,
    actions: tuple[str, ...],
    search: str | None,
    seed: int | None,
    jobs: int,
    output: Path | None,
    write: bool,
    diff: bool,
    as_data: bool,
) -> int:
    """Learn the probabilities of DOMAIN from EXPERIENCE: experience.jsonl files, run folders, or folders of
    runs.

    Prints the change as a diff; only --write changes files, and says which. The prior stays in the file
    beside the learned number, and the file says which experience was counted, so that learning again from the
    same experience changes nothing: give every file that shall count, or --add to what was counted. With
    --check the exit code is 1 if a rule disagrees. With --structure whole rules are learned, those of DOMAIN
    where they do not explain EXPERIENCE, or all of them from a --vocabulary alone.
    """
    counting = Counting(estimator, m, match, forgetting, add, replace)
    wanted = Wanted(vocabulary is not None, actions, search or TREE.search, seed or 0, jobs)
    _refuse_mixed(counting, structure, check, explain, write, output, diff)
    if not structure and (search is not None or seed is not None or wanted != Wanted()):
        raise click.UsageError(f"{_OF_STRUCTURE} are for --structure: add it")
    named, experience = _named(domain, experience, vocabulary)
    loaded, is_own = open_loaded(named), Path(named).is_file()
    if write and not is_own:
        raise ships_with(named, loaded)
    if output is not None:
        refuse_existing(output)
    if structure:
        with progress.counting("learning rules, {} actions done", quiet=False) as done, usage_errors():
            rules = structures(loaded, experience, wanted, is_own, may_include_outside(), done)
        return _finish(rules, write, output, diff, as_data)
    if check:
        with working("reading"):
            found = agreement(loaded, experience, counting)
        echo(json.dumps(found.to_dict(), indent=2) if as_data else str(found))
        return ExitCode.DONE if found.agrees else ExitCode.REFUSED
    if explain:
        _explain(Accounts(loaded, experience, counting), as_data)
        return ExitCode.DONE
    with working("learning"):
        learned = lessons(loaded, experience, counting, is_own, may_include_outside())
    return _finish(learned, write, output, diff, as_data)


def _named(
    domain: str | None, experience: tuple[Path, ...], vocabulary: str | None
) -> tuple[str, tuple[Path, ...]]:
    """The domain to learn, and the experience to learn from: with --vocabulary all arguments are that."""
    if vocabulary is not None:
        experience = (*([] if domain is None else [Path(domain)]), *experience)
        domain = vocabulary
        if any(path.suffix == ".nid" for path in experience):
            raise click.UsageError("--vocabulary stands in place of DOMAIN: name experience alone beside it")
    if domain is None or not experience:
        what = "DOMAIN" if domain is None else "EXPERIENCE"
        raise click.UsageError(f"Missing argument '{what}{'' if domain is None else '...'}'.")
    return domain, experience


_OF_STRUCTURE = "--vocabulary, --action, --search, --seed and --jobs"


def _refuse_mixed(
    counting: Counting,
    structure: bool,
    check: bool,
    explain: bool,
    write: bool,
    output: Path | None,
    diff: bool,
) -> None:
    """Refuse options of which one has nothing to do beside another."""
    if (check or explain) and (counting.adding or counting.replacing or write or output or diff):
        asked = "--check" if check else "--explain"
        others = "--add, --replace, --output, --write and --diff"
        raise click.UsageError(f"{asked} learns nothing: leave out {others}")
    if output is not None and write:
        raise click.UsageError("--write changes DOMAIN, and --output leaves it alone: ask for one")
    if counting.adding and counting.replacing:
        raise click.UsageError("--add keeps what was counted, and --replace drops it: ask for one")
    if structure and (counting != Counting() or check or explain):
        raise click.UsageError(
            "--structure learns rules from all that is given: leave out --estimator, --m, --match,"
            " --forgetting, --add, --replace, --check and --explain"
        )


def _finish(
    learned: LearningResult | StructureResult, write: bool, output: Path | None, diff: bool, as_data: bool
) -> int:
    """Tell what was learned, and write what is to be written."""
    if as_data:
        data = {**learned.to_dict(), "diff": learned.diff} if diff else learned.to_dict()
        click.echo(json.dumps(data, indent=2))
    else:
        _tell(learned, diff or not (write or output is not None))
    if write:
        wrote = learned.write()
        for changed in wrote:
            echo(f"wrote {changed}", err=as_data)
        if not wrote:
            echo(f"nothing new: {learned.changes[0].path} says all of this already", err=as_data)
    if output is not None:
        learned.write_copy(output)
        echo(f"wrote {output}", err=as_data)
    return ExitCode.DONE


def _tell(learned: LearningResult | StructureResult, diff: bool) -> None:
    """What is noteworthy of what was learned, below the change if that is wanted."""
    for change in learned.changes if diff else ():
        echo_difference(Source(change.path, change.before), change.after, "learned")
    if isinstance(learned, StructureResult):
        echo(str(learned.table()))
    for note in learned.notes:
        echo(note)


def _explain(accounts: Accounts, as_data: bool) -> None:
    """Each transition as it is read, and then what is suggested; as data a line of JSON each."""
    for note in accounts.notes:
        echo(f"note: {note}", err=True)
    for account in accounts:
        if as_data:
            echo(json.dumps(account_data(accounts.model, account)))
        else:
            for line in told(accounts.model, account):
                echo(line)
    for found in accounts.suggestions:
        if as_data:
            rule = accounts.model.rules[found.rule].name
            echo(json.dumps({"suggestion": {**asdict(found), "rule": rule}}))
        else:
            echo(suggested(accounts.model, found))
