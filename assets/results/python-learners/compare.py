"""Compares xcscr with xcsf and scikit-XCS at equal work: the same trials, population size and parameters.

pip install "./python[sklearn]" xcsf==1.5.0 scikit-XCS==1.0.8
python assets/results/python-learners/compare.py          # prints the first table of docs/src/results/python-learners.md
python assets/results/python-learners/compare.py real     # one part of it; writes real.json
"""

import json
import statistics
import sys
import time
from pathlib import Path

import numpy
import xcscr
import xcsf
from sklearn.datasets import load_breast_cancer, load_iris, load_wine
from sklearn.model_selection import StratifiedKFold

SEEDS = range(1, 6)
# Address bits, population size, P#, trials.
MULTIPLEXERS = [(2, 400, 0.33, 10_000), (3, 800, 0.5, 20_000), (4, 2000, 0.75, 60_000)]
# Address bits, population size, trials.
REALS = [(1, 1000, 20_000), (2, 2000, 50_000)]
TABLES = {"iris": load_iris, "wine": load_wine, "breast cancer": load_breast_cancer}
TABLE_TRIALS, TABLE_SIZE = 50_000, 1600
# scikit-XCS takes minutes for what the others do in seconds.
MOST_SKXCS_TRIALS, SKXCS_SEEDS = 20_000, range(1, 3)


def multiplexer(address_bits, count, seed):
    inputs = numpy.random.default_rng(seed).integers(0, 2, (count, address_bits + 2**address_bits))
    address = inputs[:, :address_bits] @ (1 << numpy.arange(address_bits)[::-1])
    return inputs, inputs[numpy.arange(count), address_bits + address]


def with_xcscr_bits(inputs, answers, tests, size, p_hash, seed):
    learner = xcscr.XCS(2, n_bits=inputs.shape[1], p_explore=1.0, population_size=size, p_hash=p_hash, seed=seed)
    learner.fit_table(inputs, answers, trials=len(inputs))
    return numpy.array([learner.policy(one) for one in tests]), learner.n_rules


def with_xcscr_table(inputs, answers, tests, size, trials, seed):
    model = xcscr.XCSClassifier(trials, population_size=size, random_state=seed).fit(inputs, answers)
    return model.predict(tests), len(model.rules())


def xcsf_learner(width, actions, size, condition, seed):
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


def measured(learn, truth):
    start = time.process_time()
    predicted, rules = learn()
    return float(numpy.mean(numpy.asarray(predicted).astype(int) == truth)), time.process_time() - start, rules


def row(problem, program, results):
    accuracy, seconds, rules = (list(column) for column in zip(*results, strict=True))
    spread = statistics.stdev(accuracy) if len(accuracy) > 1 else 0.0
    figures = f"{statistics.mean(accuracy):.3f} | {spread:.3f} | {statistics.mean(seconds):.2f}"
    print(f"| {problem} | {program} | {figures} | {statistics.mean(rules):.0f} | {len(results)} |", flush=True)


def compare_multiplexers():
    for address_bits, size, p_hash, trials in MULTIPLEXERS:
        name = f"{address_bits + 2**address_bits}-multiplexer"
        ternary = {"type": "ternary", "args": {"bits": 1, "p_dontcare": p_hash}}
        data = {seed: multiplexer(address_bits, trials, seed) for seed in SEEDS}
        tests, truth = multiplexer(address_bits, 1000, 1000)
        runs = {
            "xcscr": (SEEDS, lambda x, y, seed: with_xcscr_bits(x, y, tests, size, p_hash, seed)),
            "xcsf": (SEEDS, lambda x, y, seed: with_xcsf(x.astype(float), y, tests, size, ternary, seed)),
        }
        if trials <= MOST_SKXCS_TRIALS:
            runs["scikit-XCS"] = (SKXCS_SEEDS, lambda x, y, seed: with_skxcs(x, y, tests, size, p_hash, seed, trials))
        for program, (seeds, learn) in runs.items():
            row(name, program, [measured(lambda: learn(*data[seed], seed), truth) for seed in seeds])


def with_xcscr_reals(inputs, answers, tests, size, seed):
    learner = xcscr.XCS(2, n_features=inputs.shape[1], p_explore=1.0, population_size=size, seed=seed)
    learner.fit_table(inputs, answers, trials=len(inputs))
    return numpy.array([learner.policy(one) for one in tests]), learner.n_rules


def compare_reals():
    """The multiplexer of numbers from 0 to 1, each of which counts as 1 from 0.5 on."""
    rows = []
    for address_bits, size, trials in REALS:
        name = f"real-valued {address_bits + 2**address_bits}-multiplexer"

        def drawn(count, seed, address_bits=address_bits):
            bits, answers = multiplexer(address_bits, count, seed)
            return (bits + numpy.random.default_rng(seed + 10_000).random(bits.shape)) / 2, answers

        data, (tests, truth) = {seed: drawn(trials, seed) for seed in SEEDS}, drawn(1000, 1000)
        rectangle = {"type": "hyperrectangle_ubr", "args": {"min": 0.0, "max": 1.0, "spread_min": 0.1, "eta": 0.0}}
        learners = {"xcscr": with_xcscr_reals, "xcsf": lambda x, y, t, n, seed: with_xcsf(x, y, t, n, rectangle, seed)}
        for program, learn in learners.items():
            results = [measured(lambda: learn(*data[seed], tests, size, seed), truth) for seed in SEEDS]
            row(name, program, results)
            rows += [
                {"problem": name, "program": program, "seed": seed, "accuracy": share, "cpu_s": seconds, "rules": rules}
                for seed, (share, seconds, rules) in zip(SEEDS, results, strict=True)
            ]
    Path(__file__).with_name("real.json").write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")


def compare_tables():
    rectangle = {"type": "hyperrectangle_ubr", "args": {"min": 0.0, "max": 1.0, "spread_min": 0.1, "eta": 0.0}}
    for name, load in TABLES.items():
        X, y = load(return_X_y=True)
        folds = list(StratifiedKFold(5, shuffle=True, random_state=1).split(X, y))
        actions, results = len(set(y)), {"xcscr": [], "xcsf": [], "scikit-XCS": []}
        for seed, (train, test) in enumerate(folds, start=1):
            low, high = X[train].min(axis=0), X[train].max(axis=0)
            scaled = ((X - low) / (high - low)).clip(0.0, 1.0)
            drawn = numpy.random.default_rng(seed).choice(train, TABLE_TRIALS)
            learners = {
                "xcscr": lambda: with_xcscr_table(X[train], y[train], X[test], TABLE_SIZE, TABLE_TRIALS, seed),
                "xcsf": lambda: with_xcsf(
                    scaled[drawn], y[drawn], scaled[test], TABLE_SIZE, rectangle, seed, actions
                ),
            }
            if seed in SKXCS_SEEDS and name == "iris":
                learners["scikit-XCS"] = lambda: with_skxcs(
                    X[train], y[train], X[test], TABLE_SIZE, 0.5, seed, MOST_SKXCS_TRIALS
                )
            for program, learn in learners.items():
                results[program].append(measured(learn, y[test]))
        for program, measurements in results.items():
            if measurements:
                row(name, program, measurements)


if __name__ == "__main__":
    print("| problem | program | accuracy | SD | CPU s | rules | runs |\n|---|---|---|---|---|---|---|")
    parts = {"multiplexers": compare_multiplexers, "real": compare_reals, "tables": compare_tables}
    for part in sys.argv[1:] or parts:
        parts[part]()
