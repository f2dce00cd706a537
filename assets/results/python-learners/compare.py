"""Compares xcscr with xcsf and scikit-XCS at equal work: the same trials, population size and parameters.

pip install "./python[sklearn]" xcsf==1.5.0 scikit-XCS==1.0.8
python assets/results/python-learners/compare.py            # adds runs to compare.json; started again, it goes on
python assets/results/python-learners/compare.py --table    # prints the first table of docs/src/results/python-learners.md

`--parts real` and `--programs xcscr xcsf` run some of it.
"""

import argparse
import statistics
import time
from pathlib import Path

import numpy
import xcscr
from learning import read, write
from sklearn.datasets import load_breast_cancer, load_iris, load_wine
from sklearn.model_selection import StratifiedKFold

FILE = Path(__file__).with_name("compare.json")
#: The parameters of all programs, which are not the defaults of xcscr.XCS.
ONE_STEP = {"epsilon_0": 10.0, "theta_ga": 25, "theta_sub": 20}
SEEDS = range(1, 6)
# Address bits, population size, P#, trials.
MULTIPLEXERS = [(2, 400, 0.33, 10_000), (3, 800, 0.5, 20_000), (4, 2000, 0.75, 60_000)]
# Address bits, population size, trials.
REALS = [(1, 1000, 20_000), (2, 2000, 50_000)]
TABLES = {"iris": load_iris, "wine": load_wine, "breast cancer": load_breast_cancer}
TABLE_TRIALS, TABLE_SIZE = 50_000, 1600
RECTANGLE = {"type": "hyperrectangle_ubr", "args": {"min": 0.0, "max": 1.0, "spread_min": 0.1, "eta": 0.0}}
# scikit-XCS takes minutes for what the others do in seconds.
MOST_SKXCS_TRIALS, SKXCS_SEEDS = 20_000, range(1, 3)


def multiplexer(address_bits, count, seed):
    inputs = numpy.random.default_rng(seed).integers(0, 2, (count, address_bits + 2**address_bits))
    address = inputs[:, :address_bits] @ (1 << numpy.arange(address_bits)[::-1])
    return inputs, inputs[numpy.arange(count), address_bits + address]


def with_xcscr_bits(inputs, answers, tests, size, p_hash, seed):
    learner = xcscr.XCS(2, n_bits=inputs.shape[1], p_explore=1.0, population_size=size, p_hash=p_hash, seed=seed, **ONE_STEP)
    learner.fit_table(inputs, answers, trials=len(inputs))
    return numpy.array([learner.policy(one) for one in tests]), learner.n_rules


def with_xcscr_table(inputs, answers, tests, size, trials, seed):
    model = xcscr.XCSClassifier(trials, population_size=size, s0=1.0, random_state=seed).fit(inputs, answers)
    return model.predict(tests), len(model.rules())


def xcsf_learner(width, actions, size, condition, seed):
    import xcsf

    return xcsf.XCS(
        x_dim=width,
        y_dim=1,
        n_actions=actions,
        omp_num_threads=1,
        random_state=seed,
        pop_init=False,
        pop_size=size,
        loss_func="mae",
        e0=0.01,
        alpha=0.1,
        nu=5,
        beta=0.2,
        delta=0.1,
        theta_del=20,
        theta_sub=20,
        set_subsumption=True,
        ea={"select_type": "roulette", "theta_ea": 25, "p_crossover": 0.8, "err_reduc": 0.25, "subsumption": True},
        action={"type": "integer"},
        condition=condition,
        prediction={"type": "constant"},
    )


def with_xcsf(inputs, answers, tests, size, condition, seed, actions=2):
    learner = xcsf_learner(inputs.shape[1], actions, size, condition, seed)
    for one, answer in zip(inputs, answers, strict=True):
        learner.init_trial()
        learner.init_step()
        reward = float(learner.decision(one, True) == answer)
        learner.update(reward, True)
        learner.end_step()
        learner.end_trial()
    return numpy.argmax(learner.predict(numpy.asarray(tests, dtype=float)), axis=1), learner.pset_size()


def with_skxcs(inputs, answers, tests, size, p_hash, seed, trials):
    import skXCS

    learner = skXCS.XCS(
        learning_iterations=trials,
        N=size,
        p_general=p_hash,
        p_explore=1.0,
        do_action_set_subsumption=True,
        init_prediction=0,
        random_state=seed,
    )
    learner.fit(inputs, answers)
    return learner.predict(tests), len(learner.population.popSet)


def with_xcscr_reals(inputs, answers, tests, size, seed):
    learner = xcscr.XCS(2, n_features=inputs.shape[1], p_explore=1.0, population_size=size, seed=seed, **ONE_STEP)
    learner.fit_table(inputs, answers, trials=len(inputs))
    return numpy.array([learner.policy(one) for one in tests]), learner.n_rules


# Each part yields: problem, program, seed, a function that learns and returns its predictions and number of rules, and the
# true answers.


def multiplexers():
    for address_bits, size, p_hash, trials in MULTIPLEXERS:
        name = f"{address_bits + 2**address_bits}-multiplexer"
        ternary = {"type": "ternary", "args": {"bits": 1, "p_dontcare": p_hash}}
        tests, truth = multiplexer(address_bits, 1000, 1000)
        for seed in SEEDS:
            x, y = multiplexer(address_bits, trials, seed)
            yield name, "xcscr", seed, lambda: with_xcscr_bits(x, y, tests, size, p_hash, seed), truth
            yield name, "xcsf", seed, lambda: with_xcsf(x.astype(float), y, tests, size, ternary, seed), truth
            if trials <= MOST_SKXCS_TRIALS and seed in SKXCS_SEEDS:
                yield name, "scikit-XCS", seed, lambda: with_skxcs(x, y, tests, size, p_hash, seed, trials), truth


def reals():
    """The multiplexer of numbers from 0 to 1, each of which counts as 1 from 0.5 on."""
    for address_bits, size, trials in REALS:
        name = f"real-valued {address_bits + 2**address_bits}-multiplexer"

        def drawn(count, seed, address_bits=address_bits):
            bits, answers = multiplexer(address_bits, count, seed)
            return (bits + numpy.random.default_rng(seed + 10_000).random(bits.shape)) / 2, answers

        tests, truth = drawn(1000, 1000)
        for seed in SEEDS:
            x, y = drawn(trials, seed)
            yield name, "xcscr", seed, lambda: with_xcscr_reals(x, y, tests, size, seed), truth
            yield name, "xcsf", seed, lambda: with_xcsf(x, y, tests, size, RECTANGLE, seed), truth


def tables():
    for name, load in TABLES.items():
        X, y = load(return_X_y=True)
        actions = len(set(y))
        for seed, (train, test) in enumerate(StratifiedKFold(5, shuffle=True, random_state=1).split(X, y), start=1):
            low, high = X[train].min(axis=0), X[train].max(axis=0)
            scaled = ((X - low) / (high - low)).clip(0.0, 1.0)
            drawn = numpy.random.default_rng(seed).choice(train, TABLE_TRIALS)
            ours = (X[train], y[train], X[test])
            others = (scaled[drawn], y[drawn], scaled[test])
            yield name, "xcscr", seed, lambda: with_xcscr_table(*ours, TABLE_SIZE, TABLE_TRIALS, seed), y[test]
            yield name, "xcsf", seed, lambda: with_xcsf(*others, TABLE_SIZE, RECTANGLE, seed, actions), y[test]
            if seed in SKXCS_SEEDS and name == "iris":
                yield name, "scikit-XCS", seed, lambda: with_skxcs(*ours, TABLE_SIZE, 0.5, seed, MOST_SKXCS_TRIALS), y[test]


PARTS = {"multiplexers": multiplexers, "real": reals, "tables": tables}
PROGRAMS = ["xcscr", "xcsf", "scikit-XCS"]


def measured(learn, truth):
    start = time.process_time()
    predicted, rules = learn()
    spent = time.process_time() - start
    return {"accuracy": float(numpy.mean(numpy.asarray(predicted).astype(int) == truth)), "cpu_s": spent, "rules": int(rules)}


def table(rows):
    print("| problem | program | accuracy | SD | CPU s | rules | runs |\n|---|---|---|---|---|---|---|")
    for problem, program in dict.fromkeys((row["problem"], row["program"]) for row in rows):
        own = [row for row in rows if (row["problem"], row["program"]) == (problem, program)]
        accuracy, seconds, rules = ([row[key] for row in own] for key in ("accuracy", "cpu_s", "rules"))
        spread = statistics.stdev(accuracy) if len(accuracy) > 1 else 0.0
        figures = f"{statistics.mean(accuracy):.3f} | {spread:.3f} | {statistics.mean(seconds):.2f}"
        print(f"| {problem} | {program} | {figures} | {statistics.mean(rules):.0f} | {len(own)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="print the table of the results so far")
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=list(PARTS))
    parser.add_argument("--programs", nargs="*", choices=PROGRAMS, default=PROGRAMS)
    parser.add_argument("--file", type=Path, default=FILE, help="results, to which rows are added")
    given = parser.parse_args()
    rows = read(given.file)
    if given.table:
        return table(rows)
    done = {(row["problem"], row["program"], row["seed"]) for row in rows}
    for part in given.parts:
        for problem, program, seed, learn, truth in PARTS[part]():
            if program in given.programs and (problem, program, seed) not in done:
                rows.append({"problem": problem, "program": program, "seed": seed} | measured(learn, truth))
                print(rows[-1], flush=True)
                write(given.file, rows)


if __name__ == "__main__":
    main()
