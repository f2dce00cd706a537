"""Studies compare agents of Python with the methods of the program."""

import csv
import functools
import gzip
import json
import warnings

import numpy as np
import pandas
import pytest
import xcscr

WORLDS = ["maze4", "maze5"]


class QLearning:
    """Tabular Q-learning."""

    def __init__(self, n_actions, n_bits, seed):
        assert (n_actions, n_bits) == (4, 16) and seed >= 0
        self.n_actions = n_actions
        self.table = {}

    def __len__(self):
        return len(self.table)

    def values(self, percept):
        return self.table.get(percept, np.zeros(self.n_actions))

    def learn(self, percept, action, reward, next_percept):
        row = self.table.setdefault(percept, np.zeros(self.n_actions))
        best = 0.0 if next_percept is None else max(self.values(next_percept))
        row[action] += 0.2 * (reward + 0.95 * best - row[action])

    def end_episode(self, reached_goal):
        assert isinstance(reached_goal, bool)


class Chooser(QLearning):
    """Always goes east."""

    def choose(self, percept):
        assert isinstance(percept, bytes) and set(percept) <= {0, 1}
        return 1


def study(methods, **arguments):
    return xcscr.study(**{"worlds": WORLDS, "methods": methods, "trials": 3, "episodes": 40} | arguments)


def test_own_agents_run_beside_built_in_methods_with_the_same_seeds():
    result = study(["q-learning", QLearning])
    trials = result.trials()
    assert len(trials) == 2 * 2 * 3
    seeds = trials.groupby("method")["seed"].apply(list)
    assert seeds["q-learning"] == seeds[_own(trials)]
    own = trials[trials["method"] == _own(trials)]
    assert (own["rules"] > 0).all() and own["greedy_steps"].notna().all()
    assert own[own["world"] == "maze4"]["first_optimal_episode"].notna().any(), "it learns"
    assert _own(trials) in result.report()
    assert {"report.html", "report.md", "trials.csv", "summary.json"} <= {path.name for path in result.folder.iterdir()}


def _own(trials):
    (own,) = set(trials["method"]) - set(xcscr.methods())
    return own


def test_episodes_have_a_row_each_and_scores_are_an_array_of_runs_by_tasks():
    result = study(["xcscr-plus", QLearning], worlds=["maze5", "maze4"])
    episodes = result.episodes()
    assert len(episodes) == 2 * 2 * 3 * 40
    assert {"steps", "reward", "reached", "optimal", "greedy_steps"} <= set(episodes.columns)
    scores = result.scores()
    assert list(scores) == ["xcscr-plus", "qlearning"]
    assert all(array.shape == (3, 2) and ((0 <= array) & (array <= 1)).all() for array in scores.values())
    first = episodes.query("method == 'xcscr-plus' and world == 'maze5' and trial == 1")
    assert scores["xcscr-plus"][0, 0] == first["optimal"].mean()
    steps = result.scores(lambda trial: trial["steps"].sum())
    assert steps["qlearning"][0, 0] == episodes.query("method == 'qlearning' and world == 'maze5' and trial == 1")["steps"].sum()


def test_scores_are_the_means_of_the_table_of_episodes_computed_without_pandas():
    result = study(["xcs", "q-learning"], worlds=["maze5", "maze4"])
    result.episodes()
    shares = {}
    with gzip.open(result.folder / "episodes.csv.gz", "rt") as file:
        for row in csv.DictReader(file):
            shares.setdefault((row["method"], row["world"], row["trial"]), []).append(row["optimal"] == "true")
    scores = result.scores()
    assert list(scores) == ["xcs", "q-learning"]
    for method, table in scores.items():
        for column, world in enumerate(["maze5", "maze4"]):
            for row in range(3):
                optimal = shares[method, world, str(row + 1)]
                assert table[row, column] == sum(optimal) / len(optimal), f"{method}, {world}, trial {row + 1}"
    assert len({table.tobytes() for table in scores.values()}) == 2, "control"


@pytest.mark.parametrize("name", ["001", "nan", "NA", "1e5", "null", "true", "0.10", "1_000"])
def test_names_of_worlds_and_agents_stay_text_in_every_table(tmp_path, name):
    world = tmp_path / "world.json"
    world.write_text(json.dumps({"name": name, "rows": ["#####", "#S.G#", "#####"]}))

    class Own(QLearning):
        pass

    Own.__name__ = name if name.isalnum() and name == name.lower() else "own"
    Own.__init__ = lambda self, n_actions, n_bits, seed: setattr(self, "n_actions", n_actions) or setattr(self, "table", {})
    result = study(["q-learning", Own], worlds=["maze4", world], trials=2, episodes=3)
    for table in (result.trials(), result.episodes()):
        assert list(table["world"].unique()) == ["maze4", name]
        assert list(table["method"].unique()) == ["q-learning", Own.__name__]
    assert list(result.scores()) == ["q-learning", Own.__name__]
    assert result.scores()["q-learning"].shape == (2, 2)
    assert {arm["world"] for arm in json.loads((result.folder / "summary.json").read_text())["arms"]} == {"maze4", name}


def test_a_summary_has_the_numbers_of_the_trials_and_becomes_a_table_of_latex():
    result = study(["q-learning", QLearning])
    summary, trials = result.summary(), result.trials()
    assert list(summary["method"]) == ["q-learning", "qlearning"] * 2 or list(summary["world"]) == ["maze4", "maze4", "maze5", "maze5"]
    for _, row in summary.iterrows():
        own = trials[(trials["world"] == row["world"]) & (trials["method"] == row["method"])]
        assert (row["trials"], row["successes"]) == (3, own["first_optimal_episode"].notna().sum())
    latex = summary[["world", "method", "successes"]].to_latex(index=False)
    assert "\\toprule" in latex and "maze5 & qlearning & " in latex


def test_curves_count_the_trials_that_are_optimal_after_so_many_environment_steps():
    result = study(["xcs", "q-learning"])
    curves, episodes = result.curves(points=30), result.episodes()
    assert set(curves["world"]) == set(WORLDS) and set(curves["method"]) == {"xcs", "q-learning"}
    for _, row in curves.iterrows():
        solved = 0
        for _, trial in episodes[(episodes["world"] == row["world"]) & (episodes["method"] == row["method"])].groupby("trial"):
            steps = is_optimal = 0
            for one, optimal in zip(trial["steps"], trial["optimal"], strict=True):
                steps += one
                is_optimal = optimal if steps <= row["steps"] else is_optimal
            solved += is_optimal
        assert row["optimal"] == solved / 3
        assert row["low"] <= row["optimal"] <= row["high"]
    last = curves.groupby(["world", "method"]).last()["optimal"]
    retained = result.trials().groupby(["world", "method"])["retained"].mean()
    assert last.to_dict() == retained.to_dict() and curves["optimal"].nunique() > 2
    # By hand: Wilson's interval of 0 of 3 ends at z^2 / (3 + z^2).
    z = 1.959963984540054
    none = curves[curves["optimal"] == 0.0].iloc[0]
    assert none["low"] == 0.0 and none["high"] == pytest.approx(z**2 / (3 + z**2), abs=1e-9)


def test_progress_counts_the_trials_of_a_call_and_its_exception_ends_the_study(tmp_path):
    calls = []
    study(["q-learning"], worlds=["maze4"], out=tmp_path / "own", progress=lambda *counts: calls.append(counts))
    assert calls == [(1, 3), (2, 3), (3, 3)]
    study(["q-learning"], worlds=["maze4"], trials=5, out=tmp_path / "own", progress=lambda *counts: calls.append(counts))
    assert calls[3:] == [(1, 2), (2, 2)]

    def broken(done, trials):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        study(["q-learning"], progress=broken)


def test_results_do_not_depend_on_the_number_of_threads_and_a_folder_resumes(tmp_path):
    one = study(["q-learning", QLearning], out=tmp_path / "one", jobs=1).trials()
    many = study(["q-learning", QLearning], out=tmp_path / "many", jobs=4).trials()
    pandas.testing.assert_frame_equal(one, many)
    again = study(["q-learning", QLearning], out=tmp_path / "one")
    assert len(again.episodes()) == 480
    pandas.testing.assert_frame_equal(one, study(["q-learning", QLearning], out=tmp_path / "one").trials())


def test_a_reference_is_chosen_and_trials_and_agents_are_added_to_a_study(tmp_path):
    few = study(["xcscr", QLearning], out=tmp_path / "a", trials=2, reference=QLearning)
    report = few.report()
    assert "qlearning − xcscr" in report and "xcscr − qlearning" not in report

    class Other(QLearning):
        pass

    more = study(["xcscr", "q-learning", QLearning, Other], out=tmp_path / "a", trials=3, reference="q-learning")
    at_once = study(["xcscr", "q-learning", QLearning, Other], trials=3, reference="q-learning")
    pandas.testing.assert_frame_equal(more.trials(), at_once.trials())
    assert more.report() == at_once.report()
    assert len(list((tmp_path / "a" / "journals").iterdir())) == 2
    with pytest.raises(ValueError, match="`reference` has 'xcs', which is unknown"):
        study(["xcscr", QLearning], reference="xcs")


def test_agents_have_the_names_of_pairs_and_run_without_other_methods_with_the_same_results():
    class Rate(QLearning):
        def __init__(self, rate, **given):
            super().__init__(**given)
            self.rate = rate

        def learn(self, percept, action, reward, next_percept):
            for _ in range(self.rate):
                super().learn(percept, action, reward, next_percept)

    pairs = [("once", functools.partial(Rate, 1)), ("twice", functools.partial(Rate, 2))]
    alone = study(pairs, reference="once")
    assert "once − twice" in alone.report()
    beside = study(["xcs", *pairs]).trials().query("method != 'xcs'").reset_index(drop=True)
    pandas.testing.assert_frame_equal(alone.trials(), beside)
    assert list(beside["method"].unique()) == ["once", "twice"]


class Random(QLearning):
    """Chooses by a generator that no seed determines."""

    def choose(self, percept):
        return int(np.random.default_rng().integers(4))


def test_results_of_a_changed_or_random_agent_are_never_mixed(tmp_path):
    def changed(gain):
        class Own(QLearning):
            def choose(self, percept):
                return gain

        return Own

    first = study(["q-learning", changed(1)], worlds=["maze4"], out=tmp_path / "own")
    for _ in range(2):
        study(["q-learning", changed(1)], worlds=["maze4"], out=tmp_path / "own")
    with pytest.raises(ValueError, match="trial 1 of maze4 own .* another result when it is repeated.*`out`"):
        study(["q-learning", changed(2)], worlds=["maze4"], out=tmp_path / "own")
    assert len(first.episodes()) == 2 * 3 * 40, "control"
    with pytest.raises(ValueError, match="random .* another result when it is repeated"):
        study(["q-learning", Random], worlds=["maze4"]).episodes()


def test_an_agent_may_choose_its_actions():
    episodes = study(["q-learning", Chooser], worlds=["maze4"], trials=1, episodes=3).episodes()
    own = episodes[episodes["method"] == "chooser"]
    assert not own["reached"].any() and (own["explored"] == 0).all()


def test_a_built_in_method_in_a_study_is_the_one_of_train():
    first = study(["q-learning"], worlds=["maze4"]).episodes().query("trial == 1")
    alone = xcscr.train("maze4", "q-learning", arena="grid", sensor="neighbours", episodes=40, seed=int(first["seed"].iloc[0]))
    assert list(alone.episodes()["steps"]) == list(first["steps"])


def test_a_trial_that_failed_is_repeated_by_the_same_call(tmp_path):
    class Fragile(QLearning):
        is_broken = True

        def learn(self, *step):
            if self.is_broken:
                raise KeyError("mine")
            super().learn(*step)

    given = {"worlds": ["maze4"], "out": tmp_path / "own"}
    for _ in range(2):
        with pytest.raises(KeyError, match="mine"):
            study(["q-learning", Fragile], **given)
    Fragile.is_broken = False
    trials = study(["q-learning", Fragile], **given).trials()
    assert len(trials) == 6 and (trials["error"] == "").all()


def test_an_exception_of_an_agent_ends_the_study():
    class Broken(QLearning):
        def learn(self, *step):
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        study(["q-learning", Broken])

    class Short(QLearning):
        def values(self, percept):
            return [1.0]

    with pytest.raises(ValueError, match="1 numbers for 4 actions"):
        study(["q-learning", Short])


def test_ctrl_c_ends_a_study():
    import _thread
    import threading

    class Slow(QLearning):
        def end_episode(self, reached_goal):
            threading.Event().wait(0.01)

    threading.Timer(0.5, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        study(["q-learning", Slow], trials=1000, jobs=2)


def test_a_world_that_a_percept_cannot_solve_is_a_warning():
    with pytest.warns(UserWarning, match="rooms-12-3: the sensor `neighbours` cannot distinguish .*`sensor=neighbours-position`") as caught:
        study(["q-learning", "xcs"], worlds=["rooms-12-3", "maze4"], trials=1, episodes=1)
    assert len([one for one in caught if one.category is UserWarning]) == 1
    with pytest.warns(UserWarning, match="cannot distinguish"):
        xcscr.train("rooms-12-3", "q-learning", arena="grid", sensor="neighbours", episodes=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study(["q-learning"], worlds=["rooms-12-3"], sensor="position", trials=1, episodes=1)


def test_bad_input_is_refused_with_the_message_of_the_program(tmp_path):
    with pytest.raises(ValueError, match="did you mean `q-learning`"):
        study(["q-lerning"])
    with pytest.raises(ValueError, match="there is no world `maze99`"):
        study(["xcs"], worlds=["maze99"])
    with pytest.raises(ValueError, match="list worlds and methods"):
        study([])
    with pytest.raises(ValueError, match="`maze4 xcs grid neighbours` twice"):
        study(["xcs", "xcs"])
    with pytest.raises(ValueError, match="invalid agent name `A b`"):
        study([("A b", QLearning)])
    with pytest.raises(ValueError, match="is the name of another method"):
        study(["xcs", QLearning, QLearning])
    with pytest.raises(ValueError, match="did you mean `xcs.beta`"):
        study(["xcs"], settings={"xcs.betta": 0.1})
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ValueError, match="did not create"):
        study(["xcs"], out=tmp_path)
