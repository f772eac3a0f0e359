"""How often intervals of few runs hold the mean, and what stopping does: python benchmarks/run_statistics.py

Seconds are drawn from a gamma distribution, which is skewed as those of runs are, with a mean of 1; `spread`:
their standard deviation. `held`: how many intervals of 95 % hold the mean: Student's, plain percentiles of
resampled means, BCa, and what `cleancli.statistics` does. Of ratios, pairs share half of their variance.
Then runs go on until the mean is known to 10 % (`enough`): how many there are, how far from 1 their mean is,
and how many intervals hold 1 then.

About a minute of CPU; `--quick` draws twenty samples of each, in about two seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator

import numpy as np
from scipy.stats import bootstrap, t

from cleancli.array_types import Floats
from cleancli.statistics.bootstrap import FEWEST, mean_of, ratio_of, resampled
from cleancli.statistics.stopping import enough

COUNTS = (FEWEST, 10, 20, 50)
SPREADS = (0.1, 0.2, 0.3, 0.5)
SHARE = 0.1
LONGEST = 400

Ends = Callable[[Floats], tuple[float, float]]


def student(values: Floats) -> tuple[float, float]:
    """Student's interval of the mean."""
    reach = t.ppf(0.975, len(values) - 1) * values.std(ddof=1) / np.sqrt(len(values))
    return float(values.mean() - reach), float(values.mean() + reach)


def percentile(values: Floats) -> tuple[float, float]:
    """The plain interval of resampled means."""
    low, high = np.quantile(resampled(values[:, None])[:, 0], (0.025, 0.975))
    return float(low), float(high)


def bca(values: Floats) -> tuple[float, float]:
    """Bias-corrected and accelerated (Efron 1987), by scipy."""
    found = bootstrap((values,), np.mean, n_resamples=2000, method="BCa", rng=0).confidence_interval
    return float(found.low), float(found.high)


def ours(values: Floats) -> tuple[float, float]:
    """The one that results are told with."""
    found = mean_of(values)
    return found.low, found.high


INTERVALS: dict[str, Ends] = {"Student's": student, "percentile": percentile, "BCa": bca, "ours": ours}


def drawn(rng: np.random.Generator, spread: float, count: int) -> Floats:
    """Seconds of so many runs."""
    return rng.gamma(spread**-2, spread**2, count)


def held(rng: np.random.Generator, samples: int) -> Iterator[str]:
    """The lines of the first table."""
    yield f"| runs | {' | '.join(INTERVALS)} | ours, of a ratio |"
    yield "|---" * (len(INTERVALS) + 2) + "|"
    for count in COUNTS:
        data = [drawn(rng, 0.5, count) for _ in range(samples)]
        shares = [np.mean([low <= 1 <= high for low, high in map(ends, data)]) for ends in INTERVALS.values()]
        shares.append(np.mean([ratio_held(rng, each) for each in data]))
        yield f"| {count} | {' | '.join(f'{share:.1%}' for share in shares)} |"


def ratio_held(rng: np.random.Generator, shared: Floats) -> bool:
    """Whether the interval holds the ratio of pairs that is 1/2."""
    first, second = (shared + drawn(rng, 0.5, len(shared)) for _ in range(2))
    found = ratio_of(first / 2, second)
    return found.low <= 0.5 <= found.high


def stopped(rng: np.random.Generator, samples: int) -> Iterator[str]:
    """The lines of the second table."""
    yield "| spread | runs until enough | mean, less 1 | intervals that hold 1 |"
    yield "|---|---|---|---|"
    for spread in SPREADS:
        found = [until_enough(drawn(rng, spread, LONGEST)) for _ in range(samples)]
        bias = np.mean([values.mean() for values in found]) - 1
        holds = np.mean([low <= 1 <= high for low, high in map(student, found)])
        yield f"| {spread} | {np.mean([len(each) for each in found]):.1f} | {bias:+.2%} | {holds:.1%} |"


def until_enough(values: Floats) -> Floats:
    """The values up to the one after which there are enough."""
    return values[: next((n for n in range(1, LONGEST) if enough(values[:n], SHARE)), LONGEST)]


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    for line in held(rng, 20 if options.quick else 2000):
        print(line, flush=True)
    print()
    for line in stopped(rng, 20 if options.quick else 2000):
        print(line, flush=True)


if __name__ == "__main__":
    main()
