"""Trials in Python are those of the program."""

import pytest
import xcscr


def test_a_trial_has_figures_rules_and_a_path():
    result = xcscr.train("maze4", arena="grid", sensor="neighbours", episodes=20)
    frame = result.episodes()
    assert list(frame.index) == list(range(1, 21))
    assert result.retained and frame["optimal"].iloc[-1]
    assert frame["optimal"].idxmax() == result.first_optimal_episode
    assert len(result.greedy_path) == 11
    rules = result.rules()
    assert 1 <= len(rules) <= 20 and "east" in rules[0].condition + rules[1].condition
    assert {rule.action for rule in rules} <= {"north", "east", "south", "west"}


def test_every_method_runs_and_the_same_seed_gives_the_same_trial():
    for method in xcscr.methods():
        run = lambda seed: xcscr.train("maze4", method, arena="grid", sensor="neighbours", episodes=5, seed=seed)
        rows = [run(seed).episodes().to_numpy().tolist() for seed in (3, 3, 4)]
        assert rows[0] == rows[1], method
        assert rows[0] != rows[2], f"control: {method}"


def test_a_method_has_its_own_defaults():
    steps = lambda **settings: xcscr.train("maze4", "xcs", arena="grid", episodes=3, **settings).episodes()["steps"]
    assert steps().max() > 50, "the step limit of `xcs` is 600"
    common = {"reward.step_threshold": 50}
    assert steps(settings=common).max() == 50, "control: the common limit"


def test_unknown_methods_are_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="xcscr-plus"):
        xcscr.train("maze4", "dqn")
