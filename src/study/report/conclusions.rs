//! What the comparisons of a study decide, and what they leave open, in sentences.

use super::comparisons::{Comparison, p_value};
use crate::study::statistics::SignTest;

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

/// Describes which differences `trials` pairs of trials detect, and which they may miss, at the strictest level of the
/// correction that the comparisons need.
pub fn power(trials: usize, comparisons: &[Comparison]) -> Option<String> {
    let most = comparisons.iter().map(|one| one.corrected_for).max()?;
    let (pairs, test) = (trials as u64, SignTest::of(most));
    let correction = if most > 1 {
        format!(", corrected for {most} comparisons,")
    } else {
        String::new()
    };
    let share = test.detectable_difference(pairs).map_or(
        "no difference of the shares of optimal trials".to_owned(),
        |by| {
            let [low, high] = [-0.5, 0.5].map(|side| 100.0 * (0.5 + side * by));
            format!(
                "a difference such as {low:.0} against {high:.0} % of optimal trials, if the trials of a pair are \
                 independent"
            )
        },
    );
    let better = test.detectable_share(pairs).map_or(
        "no difference in the steps or the score".to_owned(),
        |share| {
            let percent = 100.0 * share;
            format!(
                "one in the steps or the score if a method is better in {percent:.0} % of the pairs"
            )
        },
    );
    Some(format!(
        "The tests of {trials} pairs{correction} detect {share}, and {better}, four times in five. Smaller differences \
         are missed more often."
    ))
}
