//! The transition generalisation of a learner, in words.

use xcscr::agent::{CollisionRule, InverseActionRule, Knowledge};
use xcscr::trial::Plan;

/// Returns a line for each rule of the transition generalisation; none without it.
pub fn lines(knowledge: &Knowledge, plan: &Plan) -> Vec<String> {
    let Some(generalisation) = knowledge.generalisation() else {
        return Vec::new();
    };
    let collisions = generalisation
        .collisions
        .iter()
        .map(|rule| collision(rule, plan));
    let returns = generalisation
        .returns
        .iter()
        .map(|rule| inverse_action(rule, plan));
    let mut lines: Vec<String> = Vec::new();
    for line in collisions.chain(returns) {
        // Rules can differ in bits that no percept has, and then have the same words.
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

fn inverse_action(rule: &InverseActionRule, plan: &Plan) -> String {
    let InverseActionRule { turn, hits, misses } = rule;
    let (turn, all) = (turn.index(), hits + misses);
    let undoing = match 360 * turn / plan.maze.action_count() {
        180 => "the opposite action".to_owned(),
        degrees => format!("the action {degrees} degrees clockwise of it"),
    };
    format!("{undoing} undoes a move ({hits} of {all})")
}

fn collision(rule: &CollisionRule, plan: &Plan) -> String {
    let Plan { maze, config } = plan;
    let (who, when) = match rule.action {
        Some(action) => (
            maze.action_name(action),
            config.sensor.words(maze, &rule.condition),
        ),
        None => (
            "any action".to_owned(),
            config.sensor.words_facing(maze, &rule.condition),
        ),
    };
    let (hits, all) = (rule.hits, rule.hits + rule.misses);
    format!("{who} collides if {when} ({hits} of {all} percepts)")
}
