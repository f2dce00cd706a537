"""XCS as a classifier of scikit-learn."""

import pickle
import subprocess
import sys
import warnings

import numpy
import pytest

pytest.importorskip("sklearn")

from sklearn.datasets import load_iris, load_wine, make_classification  # noqa: E402
from sklearn.exceptions import ConvergenceWarning  # noqa: E402
from sklearn.model_selection import GridSearchCV, cross_val_score  # noqa: E402
from sklearn.utils.estimator_checks import parametrize_with_checks  # noqa: E402
from xcscr import XCSClassifier  # noqa: E402


def test_the_package_imports_without_scikit_learn_and_the_classifier_says_what_it_needs():
    code = """
import sys
sys.modules["sklearn"] = None
from xcscr import *
try:
    import xcscr
    xcscr.XCSClassifier
except ImportError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "XCSClassifier needs scikit-learn: pip install xcscr[sklearn]\n"


@parametrize_with_checks([XCSClassifier()])
def test_scikit_learns_checks_pass(estimator, check):
    check(estimator)


@pytest.mark.parametrize("load", [load_iris, load_wine])
def test_tables_are_learned(load):
    X, y = load(return_X_y=True)
    assert cross_val_score(XCSClassifier(), X, y, cv=5).mean() > 0.9


def test_rules_are_in_units_of_the_features_and_name_the_class():
    pytest.importorskip("pandas")
    table = load_iris(as_frame=True)
    names = table.target_names[table.target]
    model = XCSClassifier().fit(table.data, names)
    frame = model.rules_frame()
    assert {"setosa", "versicolor", "virginica"} <= set(frame["class"])
    assert (frame["class"].str.startswith("not ") == (frame["prediction"] < 500)).all()
    assert any("petal length (cm) <=" in condition for condition in frame["condition"])
    assert model.predict(table.data.iloc[:1]).tolist() == ["setosa"]


def test_few_rules_make_the_same_right_decisions():
    X, y = load_wine(return_X_y=True)
    model = XCSClassifier(20_000).fit(X[::2], y[::2])
    few = model.compact(X[::2], y[::2])
    right = model.predict(X[::2]) == y[::2]
    assert (few.predict(X[::2]) == y[::2])[right].all()
    assert len(few.rules()) < 20 < len(model.rules())
    assert few.score(X[1::2], y[1::2]) > 0.85
    statistics = {(rule.condition, rule.action, rule.prediction, rule.fitness, rule.experience) for rule in model.rules()}
    for rule in few.rules():
        assert (rule.condition, rule.action, rule.prediction, rule.fitness, rule.experience) in statistics
    assert pickle.loads(pickle.dumps(few)).rules() == few.rules()
    with pytest.raises(ValueError, match="`y` has the class 7"):
        model.compact(X, y + 7)


@pytest.mark.parametrize("parameters", [{}, {"s0": 0.15}], ids=["some rows are disputed", "some rows have no rule"])
def test_few_rules_of_a_bad_fit_make_its_right_decisions_too(parameters):
    X, y = make_classification(300, 6, n_informative=4, n_redundant=0, n_classes=4, n_clusters_per_class=1, flip_y=0.3, random_state=1)
    model = XCSClassifier(1000, **parameters).fit(X, y)
    right = model.predict(X) == y
    assert 0.3 < right.mean() < 0.95, "control: the fit is not exact"
    few = model.compact(X, y)
    assert (few.predict(X)[right] == y[right]).all()
    assert len(few.rules()) < len(model.rules()) / 4


def test_parameters_set_after_fit_do_not_change_what_was_learned():
    X, y = load_iris(return_X_y=True)
    model = XCSClassifier(1000).fit(X, y)
    rules = model.rules()
    model.set_params(population_size=20, s0=0.5)
    assert pickle.loads(pickle.dumps(model)).rules() == rules


def test_the_spread_of_covering_follows_the_features():
    X = numpy.random.default_rng(1).random((300, 30))
    y = X[:, 0] > 0.5
    few, many, given = (XCSClassifier(10, **one).fit(X[:, :width], y).s0_ for width, one in ((2, {}), (30, {}), (30, {"s0": 0.7})))
    assert 0.1 < few < 1.0 < 2.0 < many
    assert given == 0.7


def test_a_fit_that_is_no_better_than_the_largest_class_warns():
    X, y = load_iris(return_X_y=True)
    with pytest.warns(ConvergenceWarning, match="33% of the training rows"):
        XCSClassifier(1, s0=1000.0).fit(X, y)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ConvergenceWarning)
        XCSClassifier(2000).fit(X, y)


def test_more_classes_than_a_ternary_learner_has_actions_are_learned():
    X = numpy.random.default_rng(1).random((1200, 2))
    y = (12 * X[:, 1]).astype(int)
    model = XCSClassifier(60_000).fit(X[:1000], y[:1000])
    assert len(model.classes_) == 12
    assert model.score(X[1000:], y[1000:]) > 0.9


def test_a_pickled_model_answers_alike_and_the_seed_decides():
    X, y = load_iris(return_X_y=True)
    model = XCSClassifier(5000).fit(X, y)
    copy = pickle.loads(pickle.dumps(model))
    assert copy.rules() == model.rules()
    assert numpy.array_equal(copy.predict_proba(X), model.predict_proba(X))
    assert XCSClassifier(5000).fit(X, y).rules() == model.rules()
    assert XCSClassifier(5000, random_state=2).fit(X, y).rules() != model.rules(), "control"


def test_parameters_are_searched_and_checked():
    X, y = load_iris(return_X_y=True)
    search = GridSearchCV(XCSClassifier(2000), {"s0": [0.2, 0.8]}, cv=2).fit(X, y)
    assert search.best_params_["s0"] in (0.2, 0.8)
    with pytest.raises(ValueError, match="`beta` is 2"):
        XCSClassifier(beta=2.0).fit(X, y)
    with pytest.raises(ValueError, match="`iterations` is 0"):
        XCSClassifier(0).fit(X, y)
