use super::*;

/// A walk of `length` cells. Action 1 leads on, action 0 back, action 2 to an end that pays `-loss`. The end of the walk
/// pays `goal`, each other step `step`. Every `slips`-th step goes back.
#[derive(Clone, Copy)]
struct Walk {
    length: u64,
    step: f64,
    goal: f64,
    loss: f64,
    slips: u64,
}

const EXACT: Walk = Walk {
    length: 12,
    step: 0.0,
    goal: 1.0,
    loss: 0.0,
    slips: u64::MAX,
};

impl Walk {
    fn percept(at: u64) -> Percept {
        Percept::from_word(1 << at, 16)
    }

    /// Returns the reward and the next cell.
    fn step(self, at: u64, action: Action, time: u64) -> (f64, Option<u64>) {
        let action = if time % self.slips == 2 {
            0
        } else {
            action.index()
        };
        match action {
            2 => (-self.loss, None),
            1 if at + 1 == self.length => (self.goal, None),
            1 => (self.step, Some(at + 1)),
            _ => (self.step, Some(at.saturating_sub(1))),
        }
    }

    /// Learns for a number of steps; returns the number of steps of each episode that reached the goal.
    fn learn(self, learner: &mut EnvironmentLearner, steps: u64) -> Vec<u64> {
        let (mut lengths, mut at, mut began) = (Vec::new(), 0, 0);
        for time in 0..steps {
            let action = learner.act(&Self::percept(at), true);
            let (reward, next) = self.step(at, action, time);
            learner.update(reward, next.map(Self::percept).as_ref());
            if next.is_none() && reward == self.goal {
                lengths.push(time + 1 - began);
            }
            if next.is_none() {
                began = time + 1;
            }
            at = next.unwrap_or(0);
        }
        lengths
    }
}

fn learner() -> EnvironmentLearner {
    EnvironmentLearner::new(EnvironmentParams::default(), 3, 1).unwrap()
}

fn chosen(learner: &EnvironmentLearner, walk: Walk) -> Vec<usize> {
    let best = |at| {
        let values = learner.values(&Walk::percept(at));
        let best: Vec<_> = values.best_actions().map(Action::index).collect();
        if best.len() == 1 { best[0] } else { usize::MAX }
    };
    (0..walk.length).map(best).collect()
}

#[test]
fn a_long_walk_is_learned_from_rewards_of_any_kind() {
    let step_costs = Walk {
        step: -1.0,
        goal: -1.0,
        loss: 100.0,
        ..EXACT
    };
    for walk in [EXACT, step_costs] {
        let mut learner = learner();
        let lengths = walk.learn(&mut learner, 600);
        assert!(lengths.len() > 20, "{lengths:?}");
        assert!(
            lengths
                .iter()
                .rev()
                .take(5)
                .all(|&steps| steps == walk.length),
            "{lengths:?}"
        );
        assert_eq!(chosen(&learner, walk), [1; 12]);
        assert!(learner.rules().len() < 4, "the rules generalise");
    }
    let mut control = learner();
    EXACT.learn(&mut control, 10);
    assert_ne!(
        chosen(&control, EXACT),
        [1; 12],
        "control: ten steps do not suffice"
    );
}

#[test]
fn a_great_reward_behind_costs_is_found_if_it_is_announced() {
    let walk = Walk {
        step: -1.0,
        goal: 20.0,
        loss: 5.0,
        ..EXACT
    };
    let finds = |best_return| {
        let params = EnvironmentParams {
            best_return,
            ..EnvironmentParams::default()
        };
        let mut learner = EnvironmentLearner::new(params, 3, 1).unwrap();
        walk.learn(&mut learner, 600);
        chosen(&learner, walk) == [1; 12]
    };
    assert!(finds(Some(20.0)));
    assert!(!finds(None), "control");
}

#[test]
fn ending_early_is_best_where_steps_cost_more() {
    let walk = Walk {
        step: -10.0,
        goal: 1.0,
        loss: 5.0,
        ..EXACT
    };
    let mut learner = learner();
    walk.learn(&mut learner, 600);
    assert_eq!(chosen(&learner, walk)[0], 2);
}

#[test]
fn pairs_with_varying_results_are_tried_several_times() {
    let walk = Walk { slips: 5, ..EXACT };
    let mut learner = learner();
    walk.learn(&mut learner, 6_000);
    assert!(learner.progress.varies);
    assert_eq!(chosen(&learner, walk), [1; 12]);
    let mut exact = self::learner();
    EXACT.learn(&mut exact, 6_000);
    assert!(!exact.progress.varies, "control");
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let params = EnvironmentParams {
        gamma: 1.0,
        ..EnvironmentParams::default()
    };
    let fault = EnvironmentLearner::new(params, 2, 1).unwrap_err();
    assert!(fault.to_string().starts_with("`gamma` is 1"), "{fault}");
    assert!(EnvironmentLearner::new(EnvironmentParams::default(), 9, 1).is_err());
}
