"""Teach a robot to clean: probabilistic rules in, motion out, better rules back.

What may be relied on in Python is what `__all__` names (docs/python.md); all else is private. Nothing is
loaded before it is asked for.
"""

TYPE_CHECKING = False  # mypy takes it for true by its name; `typing` takes longer to load than all of this
if TYPE_CHECKING:
    from cleancli.api.conversions import convert
    from cleancli.api.evaluations import evaluate
    from cleancli.api.executions import execute, execute_series, resume, resume_series
    from cleancli.api.explanations import explain
    from cleancli.api.inputs import load_domain, load_problem
    from cleancli.api.lessons import learn
    from cleancli.api.observations import perceive
    from cleancli.api.plans import plan
    from cleancli.api.rule_comparisons import compare_rules
    from cleancli.api.simulations import simulate
    from cleancli.api.structures import learn_structure
    from cleancli.experiment.conduct import run_study
    from cleancli.language.diagnostics.refused import Refused

__version__ = "0.1.0"

__all__ = [
    "Refused",
    "__version__",
    "compare_rules",
    "convert",
    "evaluate",
    "execute",
    "execute_series",
    "explain",
    "learn",
    "learn_structure",
    "load_domain",
    "load_problem",
    "perceive",
    "plan",
    "resume",
    "resume_series",
    "run_study",
    "simulate",
]

_PLACES = {
    "Refused": "language.diagnostics.refused",
    "compare_rules": "api.rule_comparisons",
    "convert": "api.conversions",
    "evaluate": "api.evaluations",
    "execute": "api.executions",
    "execute_series": "api.executions",
    "explain": "api.explanations",
    "learn": "api.lessons",
    "learn_structure": "api.structures",
    "load_domain": "api.inputs",
    "load_problem": "api.inputs",
    "perceive": "api.observations",
    "plan": "api.plans",
    "resume": "api.executions",
    "resume_series": "api.executions",
    "run_study": "experiment.conduct",
    "simulate": "api.simulations",
}
"""The module that each name is loaded from when it is first asked for."""


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    found: object = getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
