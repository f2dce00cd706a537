//! The methods and their names.

use strum::{IntoStaticStr, VariantArray};

use crate::agent::composed::{Composed, MapLearner, PerceptLearner};
use crate::agent::credit::{Combined, Standard};
use crate::agent::estimator::map::Vision;
use crate::agent::policy::PolicyKind;
use crate::agent::tabular::{Algorithm, Tabular};
use crate::agent::{
    Agent, Estimator, Knowledge, MapParams, Params, PlusParams, Sharing, TabularParams,
};
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
    Xcscr,
    /// `xcscr` in which two co-evolving XCS decide what is imprinted.
    XcscrCoevolved,
    /// A small set of best-action rules, distilled from the decisions of a planner on a learned
    /// model.
    XcscrPlus,
    /// Q-learning in a table.
    QLearning,
    /// Sarsa with eligibility traces in a table.
    SarsaLambda,
    /// Q-learning that replays remembered transitions.
    DynaQ,
    /// The learner of `xcscr-plus` without rules: its plan chooses.
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
            Knowledge::PerceptRules { .. } | Knowledge::MapRules { .. } => Some(Self::XcscrPlus),
            Knowledge::Planned(_) => Some(Self::RMax),
            Knowledge::Rules(_) | Knowledge::RulesOverMatchSet(_) | Knowledge::Table(_) => None,
        }
    }

    /// Returns true if the paper compares this method.
    pub fn is_of_paper(self) -> bool {
        matches!(
            self,
            Self::Xcs | Self::AdaptedEven | Self::AdaptedDiscounted | Self::Xcscr
        )
    }

    /// Returns true if the method learns rules, false if it learns a table.
    pub fn learns_rules(self) -> bool {
        match self {
            Self::Xcs | Self::Xcsam | Self::AdaptedEven | Self::AdaptedDiscounted => true,
            Self::Xcscr | Self::XcscrCoevolved | Self::XcscrPlus => true,
            Self::QLearning | Self::SarsaLambda | Self::DynaQ | Self::RMax => false,
        }
    }

    /// Returns true if the method may build a map with these settings, and so distinguish cells
    /// with equal percepts.
    pub fn may_draw_maps(self, plus: &PlusParams) -> bool {
        matches!(self, Self::XcscrPlus | Self::RMax) && plus.estimator != Estimator::Percept
    }

    /// Creates an untrained learner for `actions` actions. The first `ring` bits of a percept form
    /// a ring around the robot. `seed` is the trial's root seed.
    pub fn build(self, actions: usize, ring: usize, setup: Setup, seed: u64) -> Box<dyn Agent> {
        let (xcs, reward, plus) = (setup.xcs, setup.reward, setup.plus);
        let stream = |name| Stream::new(seed, name);
        let learner = || Xcs::new(xcs.clone(), actions, stream(StreamName::Evolution));
        let combined = |reward| -> Box<dyn Agent> {
            let imprinting = stream(StreamName::Imprinting);
            Box::new(Combined::new(learner(), reward, imprinting))
        };
        let composed = |reward: Params, policy| -> Box<dyn Agent> {
            let vision = if setup.sensed {
                Vision::Lidar
            } else {
                Vision::GroundTruth
            };
            let estimator = match plus.estimator {
                Estimator::Auto if !setup.shows_surroundings => Estimator::Percept,
                chosen => chosen,
            };
            let planning = || (policy, stream(StreamName::Replay));
            let own = (actions, vision);
            let map = MapLearner::new(own, xcs.clone(), reward.clone(), setup.map, planning());
            let rules = xcs::Params {
                value_over_match_set: false,
                ..xcs.clone()
            };
            let rules = Xcs::new(rules, actions, stream(StreamName::Evolution));
            let percept = PerceptLearner::new(
                rules,
                (ring, setup.layout.clone()),
                reward,
                plus,
                planning(),
            );
            Box::new(Composed::new(estimator, percept, map))
        };
        let table = |algorithm| -> Box<dyn Agent> {
            let (reward, own) = (reward.clone(), setup.tabular.clone());
            Box::new(Tabular::new(algorithm, actions, reward, own))
        };
        match self {
            Self::Xcs => Box::new(Standard::new(learner(), reward)),
            Self::Xcsam => Box::new(Standard::new(learner().with_adaptive_mapping(), reward)),
            Self::AdaptedEven => combined(reward.adapted(Sharing::Even)),
            Self::AdaptedDiscounted => combined(reward.adapted(Sharing::Discounted)),
            Self::Xcscr => combined(reward),
            Self::XcscrCoevolved => {
                let streams = [
                    StreamName::Experts,
                    StreamName::PolicySelector,
                    StreamName::BehaviourCloner,
                ];
                let method = Combined::new(learner(), reward, stream(StreamName::Imprinting));
                Box::new(method.with_experts(streams.map(stream)))
            }
            Self::XcscrPlus => composed(reward, PolicyKind::Rules),
            Self::RMax => composed(reward, PolicyKind::Plan),
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
    /// Parameters of the maps of `xcscr-plus` and `r-max`.
    pub map: MapParams,
    /// True if the percept comes from the robot's sensors, which show neither goals nor hidden
    /// corners.
    pub sensed: bool,
    /// True if the percept begins with the eight cells around the robot and does not contain its position.
    pub shows_surroundings: bool,
    /// The numbers in a percept.
    pub layout: xcs::Layout,
}
