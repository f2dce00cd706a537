// Colours and lengths of marks of what was learned. Nothing here touches the page, so that it can be tested on its own.

/** The greatest level of rank and nearness, and the least of a cell that has them. */
const LEVELS = 20;
const LEAST = 2;

/** Returns the colour at a share, from 0 to 1, of the way between two colours of the form #rrggbb. */
export function mixed(from, to, share) {
  const part = (colour, at) => parseInt(colour.slice(at, at + 2), 16);
  const mix = (at) => Math.round(part(from, at) + share * (part(to, at) - part(from, at)));
  return `#${[1, 3, 5].map((at) => mix(at).toString(16).padStart(2, "0")).join("")}`;
}

/** Returns the share, from 0 to 1, of a level. */
function share(level) {
  return (level - LEAST) / (LEVELS - LEAST);
}

/** Returns the colour of the best actions of a cell; level 0 leads to no goal. */
export function arrowColour({ arrow_colours: [far, middle, near], no_goal_colour }, level) {
  if (!level) return no_goal_colour;
  const twice = 2 * share(level);
  return twice < 1 ? mixed(far, middle, twice) : mixed(middle, near, twice - 1);
}

/** Returns the colour of the floor of a cell: stronger for a better rank. */
export function floorColour(floor, level) {
  return mixed(floor, "#5aa9ff", 0.08 + 0.7 * share(level));
}

/** Returns the length of the mark of an action value, from 0 to 1: the square root of its share in percent. */
export function valueLength(percent) {
  return Math.max(Math.sqrt(Math.abs(percent) / 100), 0.2);
}
