//! The table of the readers of each setting.

use std::sync::LazyLock;

use super::{Condition, ReadBy, Reader, Readers, Robot};
use crate::agent::{Estimator, Method, Sharing};
use xcscr_robot::arena::CautiousDriving;

const XCSAM: [Method; 1] = [Method::Xcsam];
const STANDARD: [Method; 2] = [Method::Xcs, Method::Xcsam];
const ADAPTED_EVEN: [Method; 1] = [Method::AdaptedEven];
const ADAPTED_DISCOUNTED: [Method; 1] = [Method::AdaptedDiscounted];
const ADAPTED: [Method; 2] = [Method::AdaptedEven, Method::AdaptedDiscounted];
const XCSCR_ALONE: [Method; 1] = [Method::Xcscr];
const COEVOLVED: [Method; 1] = [Method::XcscrCoevolved];
const XCSCR: [Method; 2] = [Method::Xcscr, Method::XcscrCoevolved];
const XCS: [Method; 6] = [
    Method::Xcs,
    Method::Xcsam,
    Method::AdaptedEven,
    Method::AdaptedDiscounted,
    Method::Xcscr,
    Method::XcscrCoevolved,
];
const XCSCR_PLUS: [Method; 1] = [Method::XcscrPlus];
const COMPOSED: [Method; 2] = [Method::XcscrPlus, Method::RMax];
const SARSA_LAMBDA: [Method; 1] = [Method::SarsaLambda];
const DYNA_Q: [Method; 1] = [Method::DynaQ];
const VALUE_TABLES: [Method; 3] = [Method::QLearning, Method::SarsaLambda, Method::DynaQ];

const UNPLANNED: Condition = Condition {
    text: "`plus.planned_exploration=false`",
    holds: |all| !all.settings.plus.planned_exploration,
};
const EVEN: Condition = Condition {
    text: "`reward.sharing=even`",
    holds: |all| all.settings.reward.sharing == Sharing::Even,
};
const DISCOUNTED: Condition = Condition {
    text: "`reward.sharing=discounted`",
    holds: |all| all.settings.reward.sharing == Sharing::Discounted,
};
const FILTER: Condition = Condition {
    text: "`reward.short_term_filter=true`",
    holds: |all| all.settings.reward.short_term_filter,
};
const IMPRINTING: Condition = Condition {
    text: "`reward.imprinting=true`",
    holds: |all| all.settings.reward.imprinting,
};
const LEARNED_STEP_LIMIT: Condition = Condition {
    text: "`reward.learning_step_threshold=true`",
    holds: |all| all.settings.reward.learning_step_threshold,
};
const SEVERAL_RATES: Condition = Condition {
    text: "`reward.learning_rate_switching=true`",
    holds: |all| all.settings.reward.learning_rate_switching,
};
const ONE_RATE: Condition = Condition {
    text: "`reward.learning_rate_switching=false`",
    holds: |all| !(SEVERAL_RATES.holds)(all),
};
const RATE_OF_FILTER: Condition = Condition {
    text: "`reward.short_term_filter=true` and `reward.learning_rate_switching=true`",
    holds: |all| (FILTER.holds)(all) && (SEVERAL_RATES.holds)(all),
};
/// The experts of `xcscr-coevolved` learn at `xcs.beta`, and only for imprinting.
const ONE_RATE_OR_EXPERTS: Condition = Condition {
    text: "`reward.learning_rate_switching=false` or `reward.imprinting=true`",
    holds: |all| (ONE_RATE.holds)(all) || (IMPRINTING.holds)(all),
};
const ALTERNATING: Condition = Condition {
    text: "`episode.alternate=true`",
    holds: |all| all.settings.episode.alternate,
};
const NOT_ALTERNATING: Condition = Condition {
    text: "`episode.alternate=false`",
    holds: |all| !(ALTERNATING.holds)(all),
};
const UNPLANNED_NOT_ALTERNATING: Condition = Condition {
    text: "`plus.planned_exploration=false` and `episode.alternate=false`",
    holds: |all| (UNPLANNED.holds)(all) && (NOT_ALTERNATING.holds)(all),
};
/// `xcs.ga_clock` does not need the GA: the time stamps of the rules show it.
const GA: Condition = Condition {
    text: "`xcs.ga=true`",
    holds: |all| all.settings.xcs.ga,
};
const SUBSUMPTION_IN_SETS: Condition = Condition {
    text: "`xcs.action_set_subsumption=true`",
    holds: |all| all.settings.xcs.action_set_subsumption,
};
const SUBSUMPTION: Condition = Condition {
    text: "`xcs.action_set_subsumption=true` (or `xcs.ga=true` and `xcs.ga_subsumption=true`)",
    holds: |all| {
        let by_parents = (GA.holds)(all) && all.settings.xcs.ga_subsumption;
        by_parents || (SUBSUMPTION_IN_SETS.holds)(all)
    },
};
const ON_PERCEPTS: Condition = Condition {
    text: "`plus.estimator=auto|percept`",
    holds: |all| all.settings.plus.estimator != Estimator::Map,
};
/// Without planned exploration, rules by rotation are still learned and saved, but never applied.
const COLLISION_RULES_ON_A_RING: Condition = Condition {
    text: "`plus.estimator=auto|percept` and `plus.collision_rules=true` and another percept than `position`",
    holds: |all| {
        let has_ring = all.sensor.ring(1) > 0;
        has_ring && all.settings.plus.collision_rules && (ON_PERCEPTS.holds)(all)
    },
};
const COLLISION_RULES_IN_PLANS: Condition = Condition {
    text: "`plus.estimator=auto|percept` and `plus.collision_rules=true` and `plus.planned_exploration=true`",
    holds: |all| {
        let plus = &all.settings.plus;
        plus.collision_rules && plus.planned_exploration && (ON_PERCEPTS.holds)(all)
    },
};
const ON_A_MAP: Condition = Condition {
    text: "`plus.estimator=map` (or `auto` with percept `neighbours` or `lidar`)",
    holds: |all| match all.settings.plus.estimator {
        Estimator::Map => all.sensor.begins_with_neighbours(),
        Estimator::Auto => all.sensor.shows_only_surroundings(),
        Estimator::Percept => false,
    },
};
const NOISE: Condition = Condition {
    text: "`physics.noise` above 0",
    holds: |all| all.settings.physics.noise > 0.0,
};
const LIDAR: Condition = Condition {
    text: "`physics.lidar.fitted=true`",
    holds: |all| all.settings.physics.lidar.fitted,
};
const NOISY_LIDAR: Condition = Condition {
    text: "`physics.noise` above 0 and `physics.lidar.fitted=true`",
    holds: |all| (NOISE.holds)(all) && (LIDAR.holds)(all),
};
const GYRO: Condition = Condition {
    text: "`physics.gyro.fitted=true`",
    holds: |all| all.settings.physics.gyro.fitted,
};
const NOISY_GYRO: Condition = Condition {
    text: "`physics.noise` above 0 and `physics.gyro.fitted=true`",
    holds: |all| (NOISE.holds)(all) && (GYRO.holds)(all),
};
const FAULTS: Condition = Condition {
    text: "another setting of `physics.faults` that adds a fault",
    holds: |all| {
        let faults = &all.settings.physics.faults;
        let of_a_sensor = faults.stuck_encoder || faults.dead_bumper;
        of_a_sensor || faults.dead_sector_deg > 0.0 || faults.gyro_drift_radps2 > 0.0
    },
};
/// Only a robot that estimates its pose detects wheel slip.
const CAUTIOUS: Condition = Condition {
    text: "`physics.cautious.when=always` (or `slipping` and an estimated pose)",
    holds: |all| match all.settings.physics.cautious.when {
        CautiousDriving::Never => false,
        CautiousDriving::Slipping => all.estimates(),
        CautiousDriving::Always => true,
    },
};
/// The filter of the pose takes this acceleration as the limit of a slippery floor.
const CAUTIOUS_OR_ESTIMATED: Condition = Condition {
    text: "`physics.cautious.when=always` or an estimated pose",
    holds: |all| all.estimates() || (CAUTIOUS.holds)(all),
};

/// Lists methods that read a setting, some of them only under a condition.
macro_rules! methods {
    ($($methods:ident $(if $condition:ident)?),*) => {
        Readers::Methods([$(readers(&$methods, None$(.or(Some($condition)))?)),*].concat())
    };
}

/// Names the robots that read a setting, always or only under a condition.
macro_rules! robot {
    ($robot:ident $(if $condition:ident)?) => {
        Readers::Robot(Robot::$robot, None$(.or(Some($condition)))?)
    };
}

/// The readers of each setting, by its full name. A section pattern covers all settings without their own row.
pub(super) static TABLE: LazyLock<Vec<(&str, ReadBy)>> = LazyLock::new(|| {
    let rows = [of_every_run(), of_methods(), of_robots()].concat();
    let rows = rows.into_iter();
    rows.map(|(key, readers)| (key, ReadBy(readers))).collect()
});

type Rows = Vec<(&'static str, Readers)>;

fn of_every_run() -> Rows {
    vec![
        ("arena.*", Readers::Everything),
        ("sensor.*", Readers::Everything),
        ("reward.step_threshold", Readers::Everything),
        ("reward.step_threshold_from_maze", Readers::Everything),
    ]
}

fn of_methods() -> Rows {
    vec![
        ("reward.goal", Readers::Methods(readers(Method::ALL, None))),
        (
            "reward.step",
            methods![STANDARD, XCSCR, COMPOSED, VALUE_TABLES],
        ),
        (
            "reward.collision",
            methods![STANDARD, XCSCR, COMPOSED if ON_PERCEPTS, VALUE_TABLES],
        ),
        ("reward.failure", methods![XCS]),
        ("reward.xcs_payment", methods![STANDARD]),
        ("reward.xcs_step_limit", methods![STANDARD]),
        (
            "reward.stack_evolution",
            methods![ADAPTED if GA, XCSCR if GA],
        ),
        (
            "reward.gamma",
            methods![STANDARD, ADAPTED_DISCOUNTED, XCSCR if DISCOUNTED, COMPOSED, VALUE_TABLES],
        ),
        (
            "reward.even_constant",
            methods![ADAPTED_EVEN, XCSCR if EVEN],
        ),
        ("reward.theta_rs", methods![XCSCR if FILTER]),
        ("reward.theta_x", methods![XCSCR if IMPRINTING]),
        ("reward.beta_success", methods![XCSCR if SEVERAL_RATES]),
        ("reward.beta_failure", methods![XCSCR if SEVERAL_RATES]),
        ("reward.beta_collision", methods![XCSCR if RATE_OF_FILTER]),
        (
            "reward.beta_step_threshold",
            methods![XCSCR if LEARNED_STEP_LIMIT],
        ),
        ("reward.*", methods![XCSCR]),
        (
            "episode.explore",
            methods![XCS if NOT_ALTERNATING, COMPOSED if UNPLANNED_NOT_ALTERNATING, VALUE_TABLES if NOT_ALTERNATING],
        ),
        (
            "episode.*",
            methods![XCS, COMPOSED if UNPLANNED, VALUE_TABLES],
        ),
        ("xcs.population_size", methods![XCS, XCSCR_PLUS]),
        (
            "xcs.beta",
            methods![STANDARD, ADAPTED, XCSCR_ALONE if ONE_RATE, COEVOLVED if ONE_RATE_OR_EXPERTS],
        ),
        ("xcs.ga_clock", methods![XCS if ALTERNATING]),
        ("xcs.ga_subsumption", methods![XCS if GA]),
        ("xcs.theta_ga", methods![XCS if GA]),
        ("xcs.chi", methods![XCS if GA]),
        ("xcs.mu", methods![XCS if GA]),
        ("xcs.theta_sub", methods![XCS if SUBSUMPTION]),
        ("xcs.subsumer_ties", methods![XCS if SUBSUMPTION_IN_SETS]),
        ("xcs.zeta", methods![XCSAM]),
        ("xcs.*", methods![XCS]),
        ("plus.estimator", methods![COMPOSED]),
        (
            "plus.turned_rules",
            methods![COMPOSED if COLLISION_RULES_ON_A_RING],
        ),
        (
            "plus.certainty",
            methods![COMPOSED if COLLISION_RULES_IN_PLANS],
        ),
        ("plus.*", methods![COMPOSED if ON_PERCEPTS]),
        ("map.*", methods![COMPOSED if ON_A_MAP]),
        ("tabular.alpha", methods![VALUE_TABLES]),
        ("tabular.lambda", methods![SARSA_LAMBDA]),
        ("tabular.replays", methods![DYNA_Q]),
    ]
}

fn of_robots() -> Rows {
    vec![
        ("physics.localisation", robot![WithTruePercepts]),
        ("physics.position_noise_m", robot![GroundTruth if NOISE]),
        ("physics.heading_noise_rad", robot![GroundTruth if NOISE]),
        ("physics.wheel_bias", robot![Any if NOISE]),
        ("physics.wheel_noise", robot![Any if NOISE]),
        ("physics.bumper.*", robot![Sensing]),
        ("physics.cautious.when", robot![Any]),
        (
            "physics.cautious.wheel_acceleration_mps2",
            robot![Any if CAUTIOUS_OR_ESTIMATED],
        ),
        ("physics.cautious.*", robot![Any if CAUTIOUS]),
        ("physics.encoders.scale", robot![Sensing if NOISE]),
        ("physics.encoders.*", robot![Sensing]),
        ("physics.estimator.caution", robot![Sensing if NOISE]),
        ("physics.estimator.*", robot![Sensing]),
        ("physics.faults.from_episode", robot![Sensing if FAULTS]),
        ("physics.faults.*", robot![Sensing]),
        // The filter of the pose has a state for a bias and for scales, even if the sensor is not fitted.
        ("physics.gyro.noise_radps", robot![Sensing if NOISY_GYRO]),
        ("physics.gyro.bias_radps", robot![Sensing if NOISE]),
        ("physics.gyro.scale", robot![Sensing if NOISE]),
        ("physics.gyro.fitted", robot![Sensing]),
        ("physics.gyro.*", robot![Sensing if GYRO]),
        ("physics.lidar.noise_m", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.noise_share", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.scale", robot![Sensing if NOISE]),
        ("physics.lidar.offset_m", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.jitter_rad", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.dropouts", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.outliers", robot![Sensing if NOISY_LIDAR]),
        ("physics.lidar.fitted", robot![Sensing]),
        // A robot waits for a turn of its lidar, even if none is fitted.
        ("physics.lidar.rate_hz", robot![Sensing]),
        ("physics.lidar.*", robot![Sensing if LIDAR]),
        ("physics.*", robot![Any]),
    ]
}

fn readers(methods: &[Method], condition: Option<Condition>) -> Vec<Reader> {
    let reader = |&method: &Method| Reader { method, condition };
    methods.iter().map(reader).collect()
}
