//! The methods and their names.

use strum::{IntoStaticStr, VariantArray};

use crate::agent::credit::{Combined, Standard};
use crate::agent::plus::{RMax, Repair, WorldModel, XcscrPlus};
use crate::agent::tabular::{Algorithm, Tabular};
use crate::agent::{Agent, Knowledge, Params, PlusParams, Sharing, TabularParams};
use xcs::Xcs;
use xcs::random::Stream;
use xcscr_robot::streams::StreamName;

/// The reward methods.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    serde::Serialize,
    serde::Deserialize,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Method {
    /// Standard XCS.
    Xcs,
    /// XCS with adaptive action mapping: rules for the best actions only.
    Xcsam,
    /// XCS adapted to robots, reward shared evenly (Eq. 7 and 8).
    AdaptedEven,
    /// XCS adapted to robots, reward discounted (Eq. 7 and 9).
    AdaptedDiscounted,
    /// The paper's combined reward method.
    #[default]
    Xcscr,
    /// `xcscr` in which two co-evolving XCS decide what is imprinted.
    XcscrCoevolved,
    /// `xcscr` with a learned model: planned exploration, and repair of the rules.
    XcscrPlus,
    /// Q-learning in a table.
    QLearning,
    /// Sarsa with eligibility traces in a table.
    SarsaLambda,
    /// Q-learning that replays remembered transitions.
    DynaQ,
    /// The model of `xcscr-plus` without rules: its plan chooses.
    RMax,
}

impl Method {
    /// All methods, in reporting order.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the name used on the command line and in files.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Returns the method that learned this knowledge, if it can be determined. Several methods learn rules on
    /// percepts, and several learn tables.
    pub fn of(knowledge: &Knowledge) -> Option<Self> {
        match knowledge {
            Knowledge::PerceptRules { .. } => Some(Self::XcscrPlus),
            Knowledge::Rules(_) | Knowledge::RulesOverMatchSet(_) | Knowledge::Table(_) => None,
        }
    }

    /// Returns true if the method learns rules, false if it learns a table.
    pub fn learns_rules(self) -> bool {
        match self {
            Self::Xcs | Self::Xcsam | Self::AdaptedEven | Self::AdaptedDiscounted => true,
            Self::Xcscr | Self::XcscrCoevolved | Self::XcscrPlus => true,
            Self::QLearning | Self::SarsaLambda | Self::DynaQ | Self::RMax => false,
        }
    }

    /// Creates an untrained learner for `actions` actions. The first `ring` bits of a percept form
    /// a ring around the robot. `seed` is the trial's root seed.
    pub fn build(self, actions: usize, ring: usize, setup: Setup, seed: u64) -> Box<dyn Agent> {
        let (xcs, reward, plus) = (setup.xcs, setup.reward, setup.plus);
        let stream = |name| Stream::new(seed, name);
        let xcs = xcs::Params {
            // The fewest rules of `xcscr-plus` are selected for the usual action values.
            value_over_match_set: xcs.value_over_match_set && self != Self::XcscrPlus,
            ..xcs
        };
        let learner = || Xcs::new(xcs.clone(), actions, stream(StreamName::Evolution));
        let combined =
            |reward: Params| Combined::new(learner(), reward, stream(StreamName::Imprinting));
        let model = |reward: Params| {
            WorldModel::new(
                actions,
                ring,
                setup.layout.clone(),
                reward,
                plus.clone(),
                stream(StreamName::Planning),
            )
        };
        let table = |algorithm| -> Box<dyn Agent> {
            let (reward, own) = (reward.clone(), setup.tabular.clone());
            Box::new(Tabular::new(algorithm, actions, reward, own))
        };
        match self {
            Self::Xcs => Box::new(Standard::new(learner(), reward)),
            Self::Xcsam => Box::new(Standard::new(learner().with_adaptive_mapping(), reward)),
            Self::AdaptedEven => Box::new(combined(reward.adapted(Sharing::Even))),
            Self::AdaptedDiscounted => Box::new(combined(reward.adapted(Sharing::Discounted))),
            Self::Xcscr => Box::new(combined(reward)),
            Self::XcscrCoevolved => {
                let streams = [
                    StreamName::Experts,
                    StreamName::PolicySelector,
                    StreamName::BehaviourCloner,
                ];
                Box::new(combined(reward).with_experts(streams.map(stream)))
            }
            Self::XcscrPlus => {
                let stream = stream(StreamName::Replay);
                let repair = Repair::new(&reward, setup.layout.clone(), stream);
                let repair = plus.repair.then_some(repair);
                let model = model(reward.clone());
                Box::new(XcscrPlus::new(combined(reward), model, repair))
            }
            Self::RMax => Box::new(RMax::new(model(reward.clone()), reward)),
            Self::QLearning => table(Algorithm::QLearning),
            Self::SarsaLambda => table(Algorithm::sarsa_lambda()),
            Self::DynaQ => table(Algorithm::dyna_q(stream(StreamName::Replay))),
        }
    }
}

/// The parameters of all methods, and properties of the percept. The parameters must have been
/// checked. Each method uses the parts that it needs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Setup {
    /// Parameters of XCS.
    pub xcs: xcs::Params,
    /// Rewards, and parameters of the reward methods.
    pub reward: Params,
    /// Parameters of the tabular methods.
    pub tabular: TabularParams,
    /// Parameters of `xcscr-plus` and `r-max`.
    pub plus: PlusParams,
    /// The numbers in a percept.
    pub layout: xcs::Layout,
}
