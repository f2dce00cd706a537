"""XCS on environments of Gymnasium, and by itself."""

import json
import pickle

import gymnasium
import numpy
import pytest
import xcscr
from gymnasium import spaces


class Multiplexer(gymnasium.Env):
    """The 6-multiplexer, one action an episode; real-valued where `real`, with inputs from -1 to 3."""

    def __init__(self, real=False):
        self.real = real
        self.observation_space = spaces.Box(-1.0, 3.0, (6,)) if real else spaces.MultiBinary(6)
        self.action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        numbers = self.np_random.random(6)
        self.bits = numbers >= 0.5
        return (4.0 * numbers - 1.0 if self.real else self.bits.astype(numpy.int8)), {}

    def answer(self):
        return int(self.bits[2 + 2 * self.bits[0] + self.bits[1]])

    def step(self, action):
        return numpy.zeros(6, numpy.int8), 1000.0 * (action == self.answer()), True, False, {}


class Corridor(gymnasium.Env):
    """Five cells; action 6 leads on, 5 back, and the end pays 1000."""

    observation_space = spaces.Discrete(5, start=10)
    action_space = spaces.Discrete(2, start=5)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at = 0
        return 10, {}

    def step(self, action):
        self.at = max(self.at + 2 * (int(action) - 5) - 1, 0)
        return min(10 + self.at, 14), 1000.0 * (self.at == 5), self.at == 5, False, {}


def right(learner, env, count=500):
    inputs = [env.reset(seed=at)[0] for at in range(10_000, 10_000 + count)]
    answers = []
    for at in range(10_000, 10_000 + count):
        env.reset(seed=at)
        answers.append(env.answer())
    return numpy.mean([learner.policy(one) == answer for one, answer in zip(inputs, answers, strict=True)])


#: Parameters for problems of one step that pay 1000.
ONE_STEP = {"p_hash": 0.5, "population_size": 800, "epsilon_0": 10.0, "theta_ga": 25, "theta_sub": 20}


def multiplexer(seed=1, real=False, steps=6000):
    env = Multiplexer(real)
    return xcscr.XCS.for_env(env, p_explore=1.0, seed=seed, **ONE_STEP).fit(env, steps=steps)


def test_the_multiplexer_is_learned_in_readable_rules():
    learner = multiplexer()
    assert right(learner, Multiplexer()) == 1.0
    assert len(learner.episode_returns) == 6000
    best = [rule for rule in learner.rules() if rule.prediction > 990 and rule.experience > 100]
    assert "bit0 = 1 and bit1 = 0 and bit4 = 1" in {rule.condition for rule in best if rule.action == 1}
    assert right(multiplexer(steps=10), Multiplexer()) < 0.9, "control: ten steps do not suffice"


def test_the_real_valued_multiplexer_is_learned_in_units_of_the_space():
    learner = multiplexer(real=True, steps=25_000)
    assert right(learner, Multiplexer(real=True)) > 0.93
    rule = next(rule for rule in learner.rules() if rule.prediction > 990 and rule.experience > 100)
    # 0.5 of the scaled range is 1 in units of the space.
    assert "x" in rule.condition and any(text in rule.condition for text in ("<=", ">=")), rule


def test_a_multistep_problem_is_learned_with_discounted_values():
    learner = xcscr.XCS.for_env(Corridor(), p_hash=0.0, ga=False, gamma=0.5, seed=1).fit(Corridor(), episodes=200)
    assert [learner.policy(cell) for cell in range(10, 15)] == [6] * 5
    values = [max(learner.values(cell)) for cell in range(10, 15)]
    assert values == pytest.approx([62.5, 125, 250, 500, 1000], rel=0.02)
    assert "state = 14" in learner.rules()[0].condition or len(learner.rules()) > 0


def test_the_defaults_learn_a_problem_of_several_steps_with_most_seeds():
    """The control are the parameters that the package had as defaults."""

    def reaches_the_goal(learner, env):
        observation, _ = env.reset()
        reward = done = 0
        while not done:
            observation, reward, terminated, truncated, _ = env.step(learner.policy(observation))
            done = terminated or truncated
        return reward == 1.0

    def learns(seed, **parameters):
        """Whether two tests in a row succeed, 500 steps apart, within 6,000 steps."""
        lake = gymnasium.make("FrozenLake-v1", is_slippery=False)
        coordinates = spaces.MultiDiscrete([4, 4])
        env = gymnasium.wrappers.TransformObservation(lake, lambda state: numpy.array(divmod(int(state), 4)), coordinates)
        learner = xcscr.XCS.for_env(env, seed=seed, **parameters)
        tests = [reaches_the_goal(learner.fit(env, steps=500, seed=seed + at), env) for at in range(12)]
        return any(map(all, zip(tests, tests[1:])))

    earlier = {"gamma": 0.71, "p_explore": 0.5, "p_hash": 0.3, "theta_ga": 25, "theta_sub": 20, "epsilon_0": 10.0}
    counts = [sum(learns(seed, **given) for seed in range(1, 6)) for given in ({}, earlier)]
    assert counts[0] >= 3 and counts[1] <= 1, counts


def test_a_table_of_bits_is_learned():
    percepts = numpy.array([[at >> bit & 1 for bit in range(6)] for at in range(64)])
    actions = percepts[numpy.arange(64), 2 + 2 * percepts[:, 0] + percepts[:, 1]]
    learner = xcscr.XCS(2, n_bits=6, p_explore=1.0, **ONE_STEP)
    learner.fit_table(percepts, actions, trials=6000)
    assert [learner.policy(one) for one in percepts] == actions.tolist()
    with pytest.raises(ValueError, match="not one of the learner's 2"):
        learner.fit_table(percepts, actions + 1, trials=1)


def test_the_same_seed_gives_the_same_rules():
    first, same, other = (multiplexer(seed, steps=1000).rules() for seed in (3, 3, 4))
    assert first == same
    assert first != other, "control"


@pytest.mark.parametrize("real", [False, True])
@pytest.mark.parametrize("way", ["pickle", "file"])
def test_a_copy_goes_on_to_the_bit_within_an_episode(tmp_path, way, real):
    learner = multiplexer(real=real, steps=500)
    percepts = numpy.random.default_rng(1).random((300, 6)).round(0 if not real else 6)

    def step(one, at):
        one.update(float(at % 7), percepts[at], terminated=at % 5 == 0)
        return one.act(percepts[at])

    learner.act(percepts[0])
    if way == "file":
        learner.save(tmp_path / "learner.json")
        copy = xcscr.XCS.load(tmp_path / "learner.json")
    else:
        copy = pickle.loads(pickle.dumps(learner))
    assert [step(learner, at) for at in range(1, 300)] == [step(copy, at) for at in range(1, 300)]
    assert learner.rules() == copy.rules()
    assert learner.episode_returns == copy.episode_returns


def test_a_damaged_file_is_refused(tmp_path):
    path = tmp_path / "learner.json"
    multiplexer(steps=50).save(path)
    good = json.loads(path.read_text())
    for change in ({"state": "AAAA"}, {"format": "other"}, {"arguments": [3]}, {"percepts": ["bits", {"names": ["a"]}]}):
        path.write_text(json.dumps(good | change))
        with pytest.raises(ValueError):
            xcscr.XCS.load(path)
    path.write_text("[]")
    with pytest.raises(ValueError):
        xcscr.XCS.load(path)


def test_parameters_are_checked_by_the_names_of_the_field():
    with pytest.raises(ValueError, match="`p_hash` is 2, but must be from 0 to 1"):
        xcscr.XCS(2, n_bits=6, p_hash=2.0)
    with pytest.raises(ValueError, match="`s0` is -1"):
        xcscr.XCS(2, n_features=6, s0=-1.0)
    with pytest.raises(ValueError, match="`gamma` is 1.5"):
        xcscr.XCS(2, n_features=6, gamma=1.5)
    with pytest.raises(TypeError, match="unknown parameter 'tau': choose from population_size"):
        xcscr.XCS(2, n_features=6, tau=0.4)
    with pytest.raises(ValueError, match="n_bits or n_features"):
        xcscr.XCS(2)


def test_wrong_percepts_and_calls_are_refused():
    learner = xcscr.XCS(2, n_bits=3)
    with pytest.raises(ValueError, match="the value 2.0: only 0 and 1"):
        learner.act([0, 2, 1])
    with pytest.raises(ValueError):
        learner.act([0, 1])
    with pytest.raises(ValueError, match="call act before update"):
        learner.update(1.0)
    learner.act([0, 1, 1])
    with pytest.raises(ValueError, match="reward"):
        learner.update(float("nan"))
    with pytest.raises(ValueError, match="attribute 1 of the percept is not a number"):
        xcscr.XCS(2, n_features=2).act([0.0, float("nan")])
    with pytest.raises(ValueError, match="low= and high="):
        xcscr.XCS.for_env(gymnasium.make("CartPole-v1"), low=-numpy.inf)


def test_spaces_become_percepts_and_words():
    from xcscr.percepts import of_space

    grid = of_space(spaces.MultiDiscrete([3, 100]), ["column", "row"])
    # Three bits for the column, and seven for 0 to 99: 69 is 0b1000101.
    assert grid.rows([2, 69]).tolist() == [[0, 0, 1, 1, 0, 1, 0, 0, 0, 1]]
    assert grid.words([(1, 0, 0), (2, 1, 1), (5, 1, 1)]) == "column != 1 and column = 2 and bit 2 of row = 1"
    box = of_space(spaces.Box(numpy.array([-2.0, 0.0]), numpy.array([2.0, 10.0]), dtype=float))
    assert box.rows([1.0, 2.5]).tolist() == [[0.75, 0.25]]
    assert box.words([(0, 0.25, 0.5), (1, 0.5, 1.0)]) == "-1 <= x0 <= 0 and x1 >= 5"
    with pytest.raises(ValueError, match="outside of its space"):
        grid.rows([3, 0])
    with pytest.raises(TypeError, match="not supported"):
        of_space(spaces.Text(3))


def test_many_bits_and_many_actions_are_learned_with_intervals():
    learner = xcscr.XCS(10, n_bits=400, p_explore=1.0, population_size=400, seed=1)
    rng = numpy.random.default_rng(1)
    for _ in range(200):
        percept = rng.integers(0, 2, 400)
        learner.update(1000.0 * (learner.act(percept) == 9 * percept[0]))
    assert {rule.action for rule in learner.rules()} == set(range(10))
    assert "= " in learner.rules()[0].condition or learner.rules()[0].condition == ""


def test_the_rules_are_a_frame():
    pandas = pytest.importorskip("pandas")
    frame = multiplexer(steps=500).rules_frame()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == list(xcscr.XCSRule._fields)
    assert frame["numerosity"].is_monotonic_decreasing
