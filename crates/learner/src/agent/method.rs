//! The methods by their names.

use strum::{IntoStaticStr, VariantArray};

use crate::agent::composed::Composed;
use crate::agent::estimator::map::Vision;
use crate::agent::map_learner::MapLearner;
use crate::agent::percept_learner::PerceptLearner;
use crate::agent::policy::PolicyKind;
use crate::agent::{
    Agent, Combined, Estimator, Knowledge, MapParams, Params, PlusParams, Sharing, Standard,
    Tabular, TabularParams,
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
    /// The same; what is imprinted is decided by two XCS that co-evolve with it.
    XcscrCoevolved,
    /// Few best-action rules, distilled from the decisions of a planner on a learned model.
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
    /// All methods, in the order in which they are reported.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The method that has learned this, where that can be told: more than one learns rules, or a table,
    /// that only look at percepts.
    pub fn of(knowledge: &Knowledge) -> Option<Self> {
        match knowledge {
            Knowledge::Foresighted { .. } | Knowledge::Remembering { .. } => Some(Self::XcscrPlus),
            Knowledge::Planned(_) => Some(Self::RMax),
            Knowledge::Rules(_) | Knowledge::RulesOverMatchSet(_) | Knowledge::Table(_) => None,
        }
    }

    /// Is it one of those that the paper compares?
    pub fn is_of_paper(self) -> bool {
        matches!(
            self,
            Self::Xcs | Self::AdaptedEven | Self::AdaptedDiscounted | Self::Xcscr
        )
    }

    /// Does it learn rules, and not a table?
    pub fn learns_rules(self) -> bool {
        match self {
            Self::Xcs | Self::Xcsam | Self::AdaptedEven | Self::AdaptedDiscounted => true,
            Self::Xcscr | Self::XcscrCoevolved | Self::XcscrPlus => true,
            Self::QLearning | Self::SarsaLambda | Self::DynaQ | Self::RMax => false,
        }
    }

    /// May the method draw a map, with these settings, and tell cells apart that share a percept?
    pub fn may_draw_maps(self, plus: &PlusParams) -> bool {
        matches!(self, Self::XcscrPlus | Self::RMax) && plus.estimator != Estimator::Percept
    }

    /// A learner that knows nothing yet, for `actions` actions and percepts whose first `ring` bits
    /// lie in a ring around the robot. `seed` is the trial's root seed.
    pub fn build(self, actions: usize, ring: usize, setup: Setup, seed: u64) -> Box<dyn Agent> {
        let Setup {
            xcs,
            reward,
            tabular,
            plus,
            map: map_settings,
            sensed,
            shows_surroundings,
        } = setup;
        let stream = |name| Stream::new(seed, name);
        let learner = || Xcs::new(xcs.clone(), actions, stream(StreamName::Evolution));
        let combined = |reward| -> Box<dyn Agent> {
            let imprinting = stream(StreamName::Imprinting);
            Box::new(Combined::new(learner(), reward, imprinting))
        };
        let composed = |reward: Params, policy| -> Box<dyn Agent> {
            let vision = if sensed {
                Vision::Lidar
            } else {
                Vision::LookedUp
            };
            let estimator = match plus.estimator {
                Estimator::Auto if !shows_surroundings => Estimator::Percept,
                chosen => chosen,
            };
            let step_threshold = reward.step_threshold;
            let planning = || (policy, stream(StreamName::Replay));
            let own = (actions, vision);
            let map = MapLearner::new(own, xcs.clone(), reward.clone(), map_settings, planning());
            let rules = xcs::Params {
                value_over_match_set: false,
                ..xcs.clone()
            };
            let rules = Xcs::new(rules, actions, stream(StreamName::Evolution));
            let percept = PerceptLearner::new(rules, ring, reward, plus, planning());
            Box::new(Composed::new(estimator, percept, map, step_threshold))
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
                    StreamName::Keeper,
                    StreamName::BehaviourCloner,
                ];
                let method = Combined::new(learner(), reward, stream(StreamName::Imprinting));
                Box::new(method.with_experts(streams.map(stream)))
            }
            Self::XcscrPlus => composed(reward, PolicyKind::Rules),
            Self::RMax => composed(reward, PolicyKind::Plan),
            Self::QLearning => Box::new(Tabular::q_learning(actions, reward, tabular)),
            Self::SarsaLambda => Box::new(Tabular::sarsa_lambda(actions, reward, tabular)),
            Self::DynaQ => {
                let replay = stream(StreamName::Replay);
                Box::new(Tabular::dyna_q(actions, reward, tabular, replay))
            }
        }
    }
}

/// The parameters of all methods, which must have been checked, and what else they are told; each
/// takes what it needs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Setup {
    /// XCS.
    pub xcs: xcs::Params,
    /// Rewards and reward methods.
    pub reward: Params,
    /// Tabular methods.
    pub tabular: TabularParams,
    /// `xcscr-plus` and `r-max`.
    pub plus: PlusParams,
    /// Their maps.
    pub map: MapParams,
    /// Is the percept what a robot senses, which shows neither goals nor hidden corners?
    pub sensed: bool,
    /// Does the percept begin with the eight cells around the robot, and tell nothing of its position?
    pub shows_surroundings: bool,
}
