#!/usr/bin/env python3
"""Prints what each switch of an ablation adds to the share of solved trials.

    python3 assets/results/ablation.py FOLDER/trials.csv

The trials of a seed are not independent, so each seed gives one number: the difference with and without the switch,
averaged over the states of the other switches. A sign-flip test over the seeds gives p.
"""

import csv
import random
import sys
from itertools import product
from statistics import mean

MOST_EXACT = 16
DRAWS = 20_000


def settings(variant):
    """The varied settings of a row, by key."""
    return dict(word.split("=", 1) for word in variant.split())


def differences(trials, switch):
    """One number per seed. `trials` has (seed, settings, solved). Counts only pairs of trials that differ in nothing else."""
    pairs = {}
    for seed, states, solved in trials:
        others = tuple(sorted((key, value) for key, value in states.items() if key != switch))
        pairs.setdefault(seed, {}).setdefault(others, {})[states.get(switch)] = solved
    matched = ([pair["true"] - pair["false"] for pair in own.values() if {"true", "false"} <= pair.keys()] for own in pairs.values())
    return [mean(numbers) for numbers in matched if numbers]


def sign_flip_p(numbers):
    """The two-sided p that the mean is 0, over all signs, or over random ones of many numbers."""
    found = abs(sum(numbers))
    if len(numbers) <= MOST_EXACT:
        signs = list(product((1, -1), repeat=len(numbers)))
    else:
        chance = random.Random(1)
        signs = [[1] * len(numbers)] + [[chance.choice((1, -1)) for _ in numbers] for _ in range(DRAWS)]
    extreme = sum(abs(sum(s * n for s, n in zip(row, numbers))) >= found - 1e-9 for row in signs)
    return extreme / len(signs)


def check():
    """A switch without effect must not change the p of another one: five seeds give 2 / 2^5. Unmatched trials do not count."""
    states = [{"a": a, "b": b, "c": c} for a, b, c in product(("true", "false"), ("true", "false"), "12")]
    trials = [(seed, state, state["a"] == "true") for seed in range(6) for state in states]
    assert sign_flip_p(differences(trials, "a")) == 0.03125
    assert sign_flip_p(differences(trials[:40], "a")) == 0.0625
    assert sign_flip_p(differences(trials, "b")) == 1
    # A sample in which a is on where c is 1, and off where it is 2, says nothing about a.
    assert differences([trial for trial in trials if (trial[1]["a"] == "true") == (trial[1]["c"] == "1")], "a") == []


def main():
    places = {}
    with open(sys.argv[1], newline="") as file:
        for row in csv.DictReader(file):
            if not row["error"]:
                trial = (row["seed"], settings(row["variant"]), row["first_optimal_episode"] != "")
                place = [row[key] for key in ("world", "method", "arena", "sensor")]
                places.setdefault(" ".join(place), []).append(trial)
    for place, trials in places.items():
        for switch in sorted({key for _, states, _ in trials for key, value in states.items() if value in ("true", "false")}):
            effect = differences(trials, switch)
            if effect:
                print(f"{place} {switch}: {100 * mean(effect):+.1f} points, {len(effect)} seeds, p = {sign_flip_p(effect):.4f}")


if __name__ == "__main__":
    main()
