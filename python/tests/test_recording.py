"""Recordings of agents of Python can be repeated to the bit."""

import gymnasium
import numpy as np
import pytest
import xcscr


def record(folder, seed=1, record="all", episodes=3, **arguments):
    """Records a random agent, and returns what the environment said."""
    env = xcscr.Record(gymnasium.make("xcscr/Maze4-v0", max_steps=20, **arguments), folder, record)
    env.action_space.seed(seed)
    said = []
    for episode in range(episodes):
        env.reset(seed=seed if episode == 0 else None)
        done = False
        while not done:
            *_, terminated, truncated, info = env.step(env.action_space.sample())
            done = terminated or truncated
            said.append(info)
    env.close()
    return said


@pytest.mark.parametrize("arguments", [{"arena": "grid", "slip": 0.2}, {"arena": "physics"}, {"arena": "physics", "noise": 2.0}])
def test_every_file_is_sound_and_bit_identical_to_a_repeated_run(arguments, tmp_path):
    record(tmp_path / "run", **arguments)
    files = sorted(path.name for path in (tmp_path / "run").glob("*.mcap"))
    assert files == ["ep-0001.mcap", "ep-0002.mcap", "ep-0003.mcap", "run.mcap"]
    for name in files:
        assert xcscr.verify_recording(tmp_path / "run" / name) is None, name


def test_a_recording_ends_where_the_robot_is(tmp_path):
    """The recorder repeats each episode at another time, and must see the same."""
    env = xcscr.Record(gymnasium.make("xcscr/Maze4-v0", arena="physics", noise=2.0), tmp_path / "run")
    env.reset(seed=1)
    env.step(np.int64(1))
    env.unwrapped._robot.reset((1, 1))
    with pytest.raises(RuntimeError, match="ends at"):
        env.reset()


def test_the_same_seed_gives_the_same_bytes_and_another_one_others(tmp_path):
    for name, seed in [("one", 1), ("again", 1), ("other", 2)]:
        record(tmp_path / name, seed=seed, arena="grid")
    read = lambda name: (tmp_path / name / "run.mcap").read_bytes()
    assert read("one") == read("again")
    assert read("one") != read("other"), "control"


def test_an_episode_that_is_broken_off_is_recorded_too(tmp_path):
    env = xcscr.Record(gymnasium.make("xcscr/Maze4-v0", arena="grid"), tmp_path / "run")
    for steps in (3, 0, 2):
        env.reset(seed=1)
        for _ in range(steps):
            env.step(np.int64(1))
    env.close()
    env.close()
    assert [path.name for path in sorted((tmp_path / "run").glob("ep-*"))] == ["ep-0001.mcap", "ep-0002.mcap"]
    assert xcscr.verify_recording(tmp_path / "run/run.mcap") is None


def test_a_recording_with_the_actions_of_another_one_is_refuted(tmp_path):
    for name, seed in [("one", 1), ("other", 2)]:
        record(tmp_path / name, seed=seed, arena="grid")
    (tmp_path / "other/run.mcap").replace(tmp_path / "one/run.mcap")
    assert xcscr.verify_recording(tmp_path / "one/ep-0001.mcap")


def test_modes_choose_the_episodes(tmp_path):
    record(tmp_path / "run", record="every:2", arena="grid")
    assert [path.name for path in sorted((tmp_path / "run").glob("ep-*"))] == ["ep-0001.mcap", "ep-0003.mcap"]
    with pytest.raises(ValueError, match="not a recording mode"):
        record(tmp_path / "bad", record="some", arena="grid")


@pytest.mark.parametrize("mode", list(gymnasium.vector.AutoresetMode))
@pytest.mark.parametrize("arguments", [{"arena": "grid", "slip": 0.2}, {"arena": "physics", "noise": 2.0}])
def test_each_environment_of_a_vector_is_recorded_as_if_it_were_alone(mode, arguments, tmp_path):
    given = {"max_steps": 8, **arguments}
    make = lambda: gymnasium.make_vec(
        "xcscr/Maze4-v0", num_envs=3, vectorization_mode="vector_entry_point", autoreset_mode=mode, **given
    )
    env = xcscr.RecordVector(make(), tmp_path / "many")
    env.reset(seed=1)
    rng, done, taken = np.random.default_rng(1), np.zeros(3, bool), []
    for _ in range(20):
        if mode == gymnasium.vector.AutoresetMode.DISABLED and done.any():
            env.reset(options={"reset_mask": done})
        actions = rng.integers(0, 4, 3)
        # In the step after an episode, NEXT_STEP resets and does not act.
        if not (mode == gymnasium.vector.AutoresetMode.NEXT_STEP and done[1]):
            taken.append(actions[1])
        _, _, terminated, truncated, _ = env.step(actions)
        done = terminated | truncated
    env.close()
    alone = xcscr.Record(gymnasium.make("xcscr/Maze4-v0", **given), tmp_path / "one")
    alone.reset(seed=2)
    for at, action in enumerate(taken):
        *_, terminated, truncated, _ = alone.step(action)
        if (terminated or truncated) and at + 1 < len(taken):
            alone.reset()
    alone.close()
    for lane in range(3):
        for file in sorted((tmp_path / f"many/env-{lane}").glob("*.mcap")):
            assert xcscr.verify_recording(file) is None, file
    read = lambda name: (tmp_path / name / "run.mcap").read_bytes()
    assert read("many/env-1") == read("one")
    assert read("many/env-0") != read("one"), "control"


def test_a_refused_reset_leaves_the_episodes_of_a_vector_as_they_are(tmp_path):
    read = {}
    for name in ("plain", "refused"):
        env = xcscr.RecordVector(gymnasium.make_vec("xcscr/Maze4-v0", num_envs=2, arena="grid"), tmp_path / name)
        env.reset(seed=1)
        env.step(np.array([1, 1]))
        if name == "refused":
            with pytest.raises(ValueError, match="free cell"):
                env.reset(options={"start": (0, 0)})
        env.step(np.array([1, 2]))
        env.close()
        read[name] = [(tmp_path / name / f"env-{lane}/run.mcap").read_bytes() for lane in range(2)]
    assert read["refused"] == read["plain"]


def test_the_robots_of_a_vector_are_observed_once_for_all_episodes_that_end_together(tmp_path):
    env = xcscr.RecordVector(gymnasium.make_vec("xcscr/Maze4-v0", num_envs=16, arena="grid", max_steps=1), tmp_path / "run")
    robots, calls = env._mazes._robots, []

    class Counting:
        def __getattr__(self, name):
            calls.append(name)
            return getattr(robots, name)

    env.reset(seed=1)
    env._mazes._robots = Counting()
    for _ in range(4):
        env.step(np.zeros(16, int))
    assert calls.count("observe") == 2 and calls.count("step") == 4, calls
    env.close()


def drive(folder, last=0.2):
    """Records two episodes of wheel speeds, and returns the rewards."""
    env = xcscr.Record(gymnasium.make("xcscr/Wheels-v0", max_steps=40, noise=2.0, collision_reward=-1.0), folder)
    speeds, rewards = np.random.default_rng(1), []
    for episode in range(2):
        env.reset(seed=episode, options={"start": (1, 1)})
        for step in range(40):
            action = [1.0, 0.3] if step % 20 else speeds.uniform(-1, 1, 2)
            rewards.append(env.step(np.array(action if step < 39 else [0.2, last], np.float32))[1])
    env.close()
    return rewards


def test_wheel_speeds_are_recorded_and_repeated_to_the_bit(tmp_path):
    assert min(drive(tmp_path / "run")) < 0, "control: the robot hits a wall"
    for name in ["ep-0001.mcap", "ep-0002.mcap", "run.mcap"]:
        assert xcscr.verify_recording(tmp_path / "run" / name) is None, name
    drive(tmp_path / "again")
    drive(tmp_path / "other", last=0.3)
    read = lambda name: (tmp_path / name / "run.mcap").read_bytes()
    assert read("run") == read("again")
    (tmp_path / "run/run.mcap").replace(tmp_path / "other/run.mcap")
    assert xcscr.verify_recording(tmp_path / "other/ep-0001.mcap"), "control: another speed"


def test_a_recording_of_wheel_speeds_ends_where_the_robot_is(tmp_path):
    env = xcscr.Record(gymnasium.make("xcscr/Wheels-v0"), tmp_path / "run")
    env.reset(seed=1)
    env.step(np.array([1.0, 0.5], np.float32))
    env.unwrapped._wheels.reset((1, 1), 0.0)
    with pytest.raises(RuntimeError, match="ends at"):
        env.reset()


def test_what_cannot_be_recorded_is_refused(tmp_path):
    (tmp_path / "full").mkdir()
    (tmp_path / "full/notes.txt").write_text("mine")
    maze = lambda: gymnasium.make("xcscr/Maze4-v0", arena="grid")
    with pytest.raises(ValueError, match="contains files"):
        xcscr.Record(maze(), tmp_path / "full")
    with pytest.raises(ValueError, match="only the environments"):
        xcscr.Record(gymnasium.make("CartPole-v1"), tmp_path / "pole")
    with pytest.raises(ValueError, match="only vector environments"):
        xcscr.RecordVector(gymnasium.make_vec("CartPole-v1"), tmp_path / "poles")
    env = xcscr.Record(maze(), tmp_path / "run")
    with pytest.raises(ValueError, match="one world"):
        env.reset(options={"goal": (1, 1)})
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.int64(1))
    with pytest.raises(ValueError, match="cannot read|No such file"):
        xcscr.verify_recording(tmp_path / "nothing.mcap")
