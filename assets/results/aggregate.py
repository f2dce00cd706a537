#!/usr/bin/env python3
"""Prints aggregates of a study over its worlds, as rliable defines them (Agarwal et al. 2021).

    python3 assets/results/aggregate.py FOLDER [--score path|retained|solved] [--reference METHOD]

For each method: the interquartile mean of the scores of all its trials, and the performance profile, which is the share
of trials with at least a score. For the reference: the probability that its score is higher than that of each other
method, averaged over the worlds; ties count half. The 95 % intervals are of a bootstrap that draws the trials of each
world anew. `path` is the share of starts from which the final greedy policy reaches a goal, times the optimum as a
share of its steps there.
"""

import argparse
import csv
import random
from pathlib import Path
from statistics import mean

RESAMPLES = 2_000
THRESHOLDS = (0.25, 0.5, 0.75, 0.9, 1.0)
SCORES = {
    "path": lambda row: float(row["greedy_score"]),
    "retained": lambda row: float(row["retained"] == "true"),
    "solved": lambda row: float(row["first_optimal_episode"] != ""),
}


def iqm(worlds):
    """The mean of the middle half of all scores."""
    scores = sorted(score for scores in worlds for score in scores)
    cut = len(scores) // 4
    return mean(scores[cut : len(scores) - cut])


def profile(worlds):
    """The shares of scores that reach the thresholds."""
    scores = [score for scores in worlds for score in scores]
    return [mean(score >= least - 1e-9 for score in scores) for least in THRESHOLDS]


def improvement(ours, theirs):
    """The probability that a score of ours is higher than one of theirs in the same world."""
    wins = [[(a > b) + (a == b) / 2 for a in own for b in other] for own, other in zip(ours, theirs)]
    return mean(mean(pairs) for pairs in wins)


def bootstrap(statistic, *methods, comparisons=1):
    """The statistic and its 95 % interval, which Bonferroni's method widens for several comparisons.

    Each resample draws as many trials of each world as there are.
    """
    outside = RESAMPLES // (40 * comparisons)
    chance = random.Random(1)
    draw = lambda worlds: [chance.choices(scores, k=len(scores)) for scores in worlds]
    values = sorted(statistic(*map(draw, methods)) for _ in range(RESAMPLES))
    return statistic(*methods), values[outside], values[-1 - outside]


def read(folder, score):
    """The scores of each method and variant in the worlds that all share, these worlds, and the trials without a score."""
    methods, missing = {}, {}
    with open(folder / "trials.csv", newline="") as file:
        for row in csv.DictReader(file):
            world = " ".join(row[key] for key in ("world", "arena", "sensor"))
            name = f"{row['method']} {row['variant']}".strip()
            scores = methods.setdefault(name, {}).setdefault(world, [])
            if not row["error"] and (score != "path" or row["greedy_score"]):
                scores.append(SCORES[score](row))
            else:
                missing[name] = missing.get(name, 0) + 1
    if not methods:
        raise SystemExit(f"{folder} has no trials")
    shared = [world for world in next(iter(methods.values())) if all(own.get(world) for own in methods.values())]
    return {name: [own[world] for world in shared] for name, own in methods.items()}, shared, missing


def check():
    """The figures of rliable 1.2.0 for the same scores. Its intervals are of 50,000 and of 5,000 resamples."""
    chance = random.Random(7)
    ours, theirs = ([[round(chance.random() ** power, 3) for _ in range(10)] for _ in range(3)] for power in (1, 2))
    for found, value, limits in (
        (bootstrap(iqm, ours), 0.3480625, (0.225, 0.4903)),
        (bootstrap(iqm, theirs)[:1], 0.25675, ()),
        (bootstrap(improvement, ours, theirs), 0.616667, (0.47, 0.76)),
    ):
        assert abs(found[0] - value) < 1e-6 and all(abs(a - b) < 0.015 for a, b in zip(found[1:], limits)), found
    assert profile([[0.5, 1.0], [0.8, 0.2]]) == [0.75, 0.75, 0.5, 0.25, 0.25]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("folder", type=Path, help="the folder of a study")
    arguments.add_argument("--score", choices=SCORES, default="path")
    arguments.add_argument("--reference", help="the method to compare with the others [default: the first]")
    options = arguments.parse_args()
    if not (options.folder / "trials.csv").exists():
        arguments.error(f"{options.folder} has no trials.csv: it is not the folder of a finished study")
    methods, worlds, missing = read(options.folder, options.score)
    reference = options.reference or next(iter(methods))
    if reference not in methods or not worlds:
        arguments.error(f"give a reference of {', '.join(methods)}, and a study with scores in a world that all of them share")
    print(f"score {options.score}, worlds: {', '.join(worlds)}")
    counts = (f"{name} {sum(map(len, own))} ({missing.get(name, 0)} without a score left out)" for name, own in methods.items())
    print("trials: " + ", ".join(counts))
    print("method: IQM [95 % interval]; share of trials with a score of at least " + ", ".join(map(str, THRESHOLDS)))
    for name, own in methods.items():
        value, low, high = bootstrap(iqm, own)
        print(f"{name}: {value:.3f} [{low:.3f}, {high:.3f}]; {', '.join(f'{share:.2f}' for share in profile(own))}")
    for name, own in methods.items():
        if name != reference:
            value, low, high = bootstrap(improvement, methods[reference], own)
            print(f"P({reference} > {name}) = {value:.3f} [{low:.3f}, {high:.3f}]")


if __name__ == "__main__":
    main()
