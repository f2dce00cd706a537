"""Searches settings of XCSCR with Optuna, and confirms the best ones with new seeds.

    pip install "./python[pandas]" optuna
    python examples/tune_with_optuna.py [combinations, 30 by default]

The objective is the share of trials that are globally optimal at the end (retained), in two mazes. A search that only
asks for a first optimum finds settings that lose it again. The best of many combinations looks better than it is, so
the last lines compare it with the defaults in trials with another seed.
"""

import sys

import optuna
import xcscr

WORLDS = ["maze4", "maze6"]


def retained(settings, trials, seed):
    """The share of trials that are optimal at the end."""
    study = xcscr.study(WORLDS, ["xcscr"], trials=trials, episodes=180, settings=settings, seed=seed)
    return study.trials()["retained"].mean()


def objective(trial):
    settings = {
        "reward.step_threshold": trial.suggest_int("reward.step_threshold", 50, 800, log=True),
        "xcs.dont_care": trial.suggest_float("xcs.dont_care", 0.0, 0.5),
        "xcs.mu": trial.suggest_float("xcs.mu", 0.01, 0.1, log=True),
        "xcs.theta_ga": trial.suggest_int("xcs.theta_ga", 12, 100, log=True),
        "xcs.population_size": trial.suggest_categorical("xcs.population_size", [1600, 3200, 6400]),
    }
    return retained(settings, trials=10, seed=trial.number + 1)


optuna.logging.set_verbosity(optuna.logging.WARNING)
search = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=1))
search.optimize(objective, n_trials=int(sys.argv[1]) if len(sys.argv) > 1 else 30)
print(f"best of {len(search.trials)}: retained {search.best_value:.2f} in the search, with {search.best_params}")
print(f"with new seeds: {retained(search.best_params, trials=50, seed=424242):.2f}")
print(f"defaults, with the same seeds: {retained({}, trials=50, seed=424242):.2f}")
