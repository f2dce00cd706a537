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


def switches(variant):
    words = (word.split("=") for word in variant.split())
    return {key: value == "true" for key, value in words if value in ("true", "false")}


def differences(trials, switch):
    """One number per seed. `trials` has (seed, states of the switches, solved)."""
    by_seed = {}
    for seed, states, solved in trials:
        by_seed.setdefault(seed, {True: [], False: []})[states[switch]].append(solved)
    return [mean(own[True]) - mean(own[False]) for own in by_seed.values()]


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
    """A switch without effect must not change the p of another one: five seeds give 2 / 2^5."""
    states = [{"a": a, "b": b} for a, b in product((True, False), repeat=2)]
    trials = [(seed, state, state["a"]) for seed in range(6) for state in states]
    assert sign_flip_p(differences(trials, "a")) == 0.03125
    assert sign_flip_p(differences(trials[:20], "a")) == 0.0625
    assert sign_flip_p(differences(trials, "b")) == 1


def main():
    places = {}
    with open(sys.argv[1], newline="") as file:
        for row in csv.DictReader(file):
            if not row["error"]:
                trial = (row["seed"], switches(row["variant"]), row["first_optimal_episode"] != "")
                places.setdefault((row["world"], row["method"]), []).append(trial)
    for (world, method), trials in places.items():
        for switch in trials[0][1]:
            effect = differences(trials, switch)
            print(f"{world} {method} {switch}: {100 * mean(effect):+.1f} points, p = {sign_flip_p(effect):.4f}")


if __name__ == "__main__":
    main()
