//! The methods by their names.

use strum::{IntoStaticStr, VariantArray};

use super::recall::Vision;
use super::{
    Agent, Combined, Knowledge, MemoryParams, Params, Plus, PlusParams, Recall, Sharing, Standard,
    Tabular, TabularParams,
};
use crate::streams::StreamName;
use xcs::Xcs;
use xcs::random::Stream;

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
    /// Rules that a model teaches.
    XcscrPlus,
    /// Rules that remember where they are, and tell places apart that look alike.
    XcscrMemory,
    /// Q-learning in a table.
    QLearning,
    /// Sarsa with eligibility traces in a table.
    SarsaLambda,
    /// Q-learning that replays remembered transitions.
    DynaQ,
    /// Planning on a model that takes the unknown for the best.
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
            Knowledge::Foresighted { .. } => Some(Self::XcscrPlus),
            Knowledge::Remembering { .. } => Some(Self::XcscrMemory),
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
            Self::Xcscr | Self::XcscrCoevolved | Self::XcscrPlus | Self::XcscrMemory => true,
            Self::QLearning | Self::SarsaLambda | Self::DynaQ | Self::RMax => false,
        }
    }

    /// Does it draw charts, with these settings, and tell places apart that look alike? Then it needs
    /// percepts that begin with the eight cells around the robot.
    pub fn draws_charts(self, tabular: &TabularParams) -> bool {
        self == Self::XcscrMemory || self == Self::RMax && tabular.memory
    }

    /// A learner that knows nothing yet, for `actions` actions and percepts whose first `ring` bits
    /// lie in a ring around the robot. `seed` is the trial's root seed.
    pub fn build(self, actions: usize, ring: usize, setup: Setup, seed: u64) -> Box<dyn Agent> {
        let Setup {
            xcs,
            reward,
            tabular,
            plus,
            memory,
            sensed,
        } = setup;
        let stream = |name| Stream::new(seed, name);
        let learner = || Xcs::new(xcs.clone(), actions, stream(StreamName::Evolution));
        let combined = |reward| -> Box<dyn Agent> {
            let imprinting = stream(StreamName::Imprinting);
            Box::new(Combined::new(learner(), reward, imprinting))
        };
        let recall = |reward| {
            let vision = match sensed {
                true => Vision::Lidar,
                false => Vision::LookedUp,
            };
            Recall::new(
                (actions, vision),
                xcs.clone(),
                reward,
                memory,
                stream(StreamName::Replay),
            )
        };
        let (foresight, certainty) = (tabular.foresight, plus.certainty);
        let rival = |tabular: Tabular| -> Box<dyn Agent> {
            match foresight {
                true => Box::new(tabular.with_foresight(ring, certainty)),
                false => Box::new(tabular),
            }
        };
        match self {
            Self::Xcs => Box::new(Standard::new(learner(), reward)),
            Self::Xcsam => Box::new(Standard::new(learner().with_adaptive_mapping(), reward)),
            Self::AdaptedEven => combined(reward.adapted(Sharing::Even)),
            Self::AdaptedDiscounted => combined(reward.adapted(Sharing::Discounted)),
            Self::Xcscr => combined(reward),
            Self::XcscrCoevolved => {
                let streams = [StreamName::Experts, StreamName::Keeper, StreamName::Cloner];
                let method = Combined::new(learner(), reward, stream(StreamName::Imprinting));
                Box::new(method.with_experts(streams.map(stream)))
            }
            Self::XcscrPlus => {
                let streams = [StreamName::Evolution, StreamName::Replay].map(stream);
                Box::new(Plus::new(xcs, [actions, ring], reward, plus, streams))
            }
            Self::XcscrMemory => Box::new(recall(reward)),
            Self::QLearning => Box::new(Tabular::q_learning(actions, reward, tabular)),
            Self::SarsaLambda => Box::new(Tabular::sarsa_lambda(actions, reward, tabular)),
            Self::DynaQ => {
                let replay = stream(StreamName::Replay);
                rival(Tabular::dyna_q(actions, reward, tabular, replay))
            }
            Self::RMax if tabular.memory => Box::new(recall(reward).by_plan()),
            Self::RMax => rival(Tabular::r_max(actions, reward, tabular)),
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
    /// The repairs of `xcscr-plus`.
    pub plus: PlusParams,
    /// `xcscr-memory`, and `r-max` with `tabular.memory`.
    pub memory: MemoryParams,
    /// Is the percept what a robot senses, which shows neither goals nor hidden corners?
    pub sensed: bool,
}
