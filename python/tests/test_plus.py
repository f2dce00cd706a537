"""`xcscr.Plus` on environments of Gymnasium."""

import gymnasium
import numpy
import pytest
import xcscr
from gymnasium import spaces
from xcscr.percepts import states_of


class Lake(gymnasium.ObservationWrapper):
    """FrozenLake with row and column in place of a number."""

    def __init__(self, size="4x4", slippery=False):
        super().__init__(gymnasium.make("FrozenLake-v1", map_name=size, is_slippery=slippery))
        self.side = int(size[0])
        self.observation_space = spaces.MultiDiscrete([self.side, self.side])

    def observation(self, observation):
        return numpy.array(divmod(int(observation), self.side))


class Cliff(gymnasium.Env):
    """Ten cells; each step costs 1. Action 8 leads on, 9 costs 100 and leads back to the start, 10 does nothing."""

    observation_space = spaces.Dict({"cell": spaces.Discrete(10, start=5), "lamp": spaces.MultiBinary(2)})
    action_space = spaces.Discrete(3, start=8)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at = 0
        return self.seen(), {}

    def seen(self):
        return {"lamp": numpy.array([self.at % 2, 1], numpy.int8), "cell": 5 + self.at}

    def step(self, action):
        self.at = {8: self.at + 1, 9: 0, 10: self.at}[int(action)]
        done = self.at == 10
        self.at = min(self.at, 9)
        return self.seen(), -100.0 if action == 9 else -1.0, done, False, {}


def length(learner, env, seed=1):
    """Returns the steps of the greedy policy, at most 200, and the sum of its rewards."""
    observation, _ = env.reset(seed=seed)
    total = 0.0
    for step in range(200):
        observation, reward, terminated, truncated, _ = env.step(learner.policy(observation))
        total += float(reward)
        if terminated or truncated:
            return step + 1, total
    return 200, total


def test_an_environment_with_traps_is_solved_by_the_shortest_path():
    learner = xcscr.Plus.for_env(Lake("8x8"), feature_names=["row", "column"], seed=1).fit(Lake("8x8"), steps=3000)
    assert length(learner, Lake("8x8")) == (14, 1.0)
    assert 0 < learner.n_rules < 40
    words = {word for rule in learner.rules() for word in rule.condition.split() if word.isalpha()}
    assert words <= {"row", "column", "and"} and "row" in words
    control = xcscr.Plus.for_env(Lake("8x8"), seed=1).fit(Lake("8x8"), steps=10)
    assert length(control, Lake("8x8"))[1] == 0.0, "control"


def test_slippery_ice_is_learned_as_well():
    learner = xcscr.Plus.for_env(Lake(slippery=True), seed=1).fit(Lake(slippery=True), steps=20_000)
    share = numpy.mean([length(learner, Lake(slippery=True), seed)[1] for seed in range(200)])
    assert share > 0.6, share


def test_costs_and_numbers_of_actions_and_states_may_begin_anywhere():
    learner = xcscr.Plus.for_env(Cliff(), seed=1).fit(Cliff(), steps=300)
    assert length(learner, Cliff()) == (10, -10.0)
    assert {rule.action for rule in learner.rules()} == {8}
    values = learner.values({"lamp": [1, 1], "cell": 14})
    # The best action is replayed with a payoff of 1000, and the others with 0.
    assert values[0] > 900.0 and all(value is None or value < 100.0 for value in values[1:])


def test_without_exploration_the_rules_choose():
    learner = xcscr.Plus.for_env(Cliff(), seed=1).fit(Cliff(), episodes=40)
    observation = {"lamp": numpy.array([1, 1], numpy.int8), "cell": 8}
    assert learner.act(observation, explore=False) == learner.policy(observation) == 8


def test_the_same_seed_gives_the_same_rules():
    def rules(seed):
        return xcscr.Plus.for_env(Lake(slippery=True), seed=seed).fit(Lake(slippery=True), steps=6000).rules()

    assert rules(3) == rules(3)
    assert rules(3) != rules(4), "control"


def test_wrong_arguments_percepts_and_calls_are_refused():
    for arguments, message in [
        ({"gamma": 1.0}, "`gamma` is 1"),
        ({"gamma": float("nan")}, "`gamma` is nan"),
        ({"tries": 1}, "`tries` is 1"),
        ({"seed": -1}, "`seed` is -1"),
        ({"best_return": 10**400}, "`best_return` is 1000"),
        ({"population_size": 0}, "`population_size` is 0"),
        ({"best_return": float("inf")}, "best_return"),
        ({"n_bits": 321}, "`n_bits` is 321, but must be from 1 to 320"),
        ({"n_bits": 0}, "n_bits"),
    ]:
        with pytest.raises(ValueError, match=message):
            xcscr.Plus(2, **({"n_bits": 3} | arguments))
    with pytest.raises(ValueError, match="`n_actions` is 9, but must be from 1 to 8"):
        xcscr.Plus(9, n_bits=3)
    with pytest.raises(TypeError, match="Discrete"):
        xcscr.Plus.for_env(gymnasium.make("Pendulum-v1"))
    with pytest.raises(TypeError, match="with integers"):
        xcscr.Plus.for_env(gymnasium.make("CartPole-v1"))
    learner = xcscr.Plus(2, n_bits=3)
    with pytest.raises(ValueError, match="not a whole number"):
        learner.act([0.9, 0.9, -0.5])
    with pytest.raises(ValueError, match="outside of its space"):
        learner.act([0, 2, 1])
    with pytest.raises(ValueError, match="call act before update"):
        learner.update(1.0)
    learner.act([0, 1, 1])
    with pytest.raises(ValueError, match="reward"):
        learner.update(float("nan"))


def test_discrete_spaces_of_all_kinds_become_named_bits():
    space = spaces.Dict(
        {
            "image": spaces.Box(0, 3, (1, 2), numpy.uint8),
            "hand": spaces.Tuple((spaces.Discrete(2), spaces.MultiDiscrete([3]))),
            "flags": spaces.MultiBinary(2),
        }
    )
    percepts = states_of(space)
    names = ("flags0", "flags1", "hand0", "hand10", "image[0,0]", "image[0,1]")
    assert percepts.names == names
    one = {"image": numpy.array([[3, 0]], numpy.uint8), "hand": (1, numpy.array([2])), "flags": numpy.array([0, 1], numpy.int8)}
    assert percepts.rows(one).tolist() == [[0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0]]
    assert percepts.words([(1, 1, 1), (2, 0, 0), (9, 1, 1)]) == "flags1 = 1 and hand0 = 0 and image[0,0] = 3"
    with pytest.raises(TypeError, match="not supported"):
        states_of(spaces.Dict({"text": spaces.Text(3)}))
    with pytest.raises(TypeError, match="too many values"):
        states_of(spaces.Box(-(2**40), 2**40, (1,), numpy.int64))


def test_the_rules_are_a_frame():
    pandas = pytest.importorskip("pandas")
    frame = xcscr.Plus.for_env(Lake(), seed=1).fit(Lake(), steps=300).rules_frame()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == list(xcscr.XCSRule._fields)
    assert len(frame) > 0
