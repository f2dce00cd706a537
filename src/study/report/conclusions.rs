//! What the comparisons of a study decide, and what they leave open, in sentences.

use super::comparisons::{Comparison, p_value};
use crate::study::statistics::{detectable_difference, detectable_share};

/// Maximum number of comparisons to list one by one.
const MOST_NAMED: usize = 4;

/// Describes the number of decided comparisons in a sentence.
pub fn decided(comparisons: &[Comparison]) -> String {
    let count =
        |decides: fn(&Comparison) -> bool| comparisons.iter().filter(|one| decides(one)).count();
    let number = match comparisons.len() {
        1 => "Of 1 comparison".to_owned(),
        number => format!("Of {number} comparisons"),
    };
    format!(
        "{number}, the data decide {} by the share of optimal trials, {} by the steps to \
         the first optimum and {} by the score of the final policy, at the 5 % level.",
        count(Comparison::decides_share),
        count(Comparison::decides_steps),
        count(Comparison::decides_score)
    )
}

/// Describes the comparisons that the data cannot decide, or returns `None` if there are none.
pub fn undecided(comparisons: &[Comparison]) -> Option<String> {
    let open = comparisons
        .iter()
        .filter(|one| !one.decides_share() && !one.decides_steps() && !one.decides_score());
    let words = open.map(|one| {
        let (world, method, against) = (&one.world, &one.method, &one.against);
        let [share, steps, score] = [one.holm_p, one.steps_holm_p, one.score_holm_p].map(p_value);
        format!("{method} against {against} in {world} (p = {share}, {steps}, {score})")
            .replace("= <", "<")
    });
    let words: Vec<String> = words.collect();
    if words.len() > MOST_NAMED {
        let (some, all) = (words.len(), comparisons.len());
        let which = format!("{some} of the {all} comparisons in the table");
        return Some(format!(
            "Neither the share of optimal trials nor the steps nor the score decide {which}."
        ));
    }
    (!words.is_empty()).then(|| {
        format!(
            "Neither the share of optimal trials nor the steps nor the score decide: {}.",
            words.join("; ")
        )
    })
}

/// Describes which differences `trials` trials of each detect, and which they may miss.
pub fn power(trials: usize) -> String {
    let trials = trials as u64;
    let share = detectable_difference(trials);
    let share = share.map_or(
        "no difference of the shares of optimal trials".to_owned(),
        |found| {
            let [low, high] = [0.5 - found / 2.0, 0.5 + found / 2.0].map(|share| 100.0 * share);
            format!("a difference such as {low:.0} against {high:.0} % of optimal trials")
        },
    );
    let sooner = detectable_share(trials);
    let sooner = sooner.map_or("none in the steps".to_owned(), |found| {
        format!(
            "one in the steps if a method is sooner in {:.0} % of the pairs",
            100.0 * found
        )
    });
    format!(
        "{trials} trials of each detect {share} four times in five, and {sooner}. Smaller differences \
         are missed more often."
    )
}
