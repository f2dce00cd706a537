// The sentences of the page. Nothing here touches the page, so that it can be tested on its own.

/** Returns what the whole recording shows, from its learning curve and the result of its last episode. */
export function summary({ episode, steps }, result) {
  const first = episode.length > 1 ? `Episode ${episode[0]} took ${steps[0]} steps. ` : "";
  return `A simulated robot learns the way to the green goal. ${first}${result}`;
}

const SOURCES = { rules: "a rule", table: "the table or plan", planner: "planned exploration", chance: "chance" };

/** Returns the name of what chose an action. */
export function source(chosenBy) {
  return SOURCES[chosenBy] ?? chosenBy;
}

/** Returns why the robot chose the action of a decision, as an introduction to the deciding rule. */
export function because({ action, chosen_by }) {
  const reasons = {
    rules: "because this rule matches what it perceives:",
    table: "because its table or plan gives this action the highest value:",
    planner: "to explore. It plans the shortest way to what it has not tried yet, or to the goal if nothing is left to try:",
    chance: "by chance, to explore or because it knows nothing better:",
  };
  return `The robot chooses ${action} ${reasons[chosen_by] ?? `(${source(chosen_by)}):`}`;
}

/** Explains the terms in the text of a rule. */
export function terms(rule) {
  const found = [];
  if (/(^|[ ,])[xy] (>|<=) /.test(rule)) found.push("x, y: cells to the east and to the north of the goal.");
  if (rule.includes("±")) found.push("value ±: the expected value and its mean error.");
  return found.join(" ");
}

/** Returns how sure the robot is of its position, and how far off its estimate is. */
export function sureness(estimate) {
  if (!estimate) return "";
  const cm = (metres) => (100 * metres).toFixed(1);
  const sure = `It estimates its position to ± ${cm(Math.hypot(estimate.sd_x_m, estimate.sd_y_m))} cm and its heading to ± ${estimate.sd_heading_deg.toFixed(1)}° (one standard deviation).`;
  const off = `In fact the estimate is off by ${cm(estimate.error_m)} cm and ${Math.abs(estimate.heading_error_deg).toFixed(1)}°.`;
  return `${sure} ${off}${estimate.mislocalised ? " It is mislocalised: the estimate lies in another cell than the robot." : ""}`;
}
