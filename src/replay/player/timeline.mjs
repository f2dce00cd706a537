// What holds at a moment of a recording. Nothing here touches the page, so that it can be tested on its own.

/** Returns the index of the last entry at or before a time, or -1. Entries are in order of `t`. */
export function lastIndex(entries, t) {
  let low = 0;
  let high = entries.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (entries[middle].t <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Returns the last entry at or before a time, or null. */
export function lastAt(entries, t) {
  return entries[lastIndex(entries, t)] ?? null;
}

/** Returns the difference of two angles in radians, from -π to π. */
export function turn(from, to) {
  const full = 2 * Math.PI;
  return ((((to - from + Math.PI) % full) + full) % full) - Math.PI;
}

/** Returns the pose {x, y, yaw} at a time, between the two recorded poses around it, or null without poses. */
export function poseAt(poses, t) {
  const at = lastIndex(poses, t);
  if (at < 0) return poses[0] ?? null;
  const [before, after] = [poses[at], poses[at + 1]];
  if (!after) return before;
  const share = after.jumps || after.t === before.t ? 0 : (t - before.t) / (after.t - before.t);
  return {
    t,
    x: before.x + share * (after.x - before.x),
    y: before.y + share * (after.y - before.y),
    yaw: before.yaw + share * turn(before.yaw, after.yaw),
  };
}

/**
 * Returns poses as objects, from lists of time, x, y and heading. The first one of an episode jumps: the robot is put
 * there, and does not glide.
 */
export function posesFrom(lists, begins) {
  const poses = lists.map(([t, x, y, yaw]) => ({ t, x, y, yaw, jumps: false }));
  for (const { t } of begins) {
    const first = poses[lastIndex(poses, t - 1e-6) + 1];
    if (first) first.jumps = true;
  }
  return poses;
}

/** Returns a pose of the map's frame in the frame of the grid, whose origin has this pose in the map. */
export function inGrid(pose, [x, y, yaw]) {
  const [dx, dy] = [pose.x - x, pose.y - y];
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
  return { ...pose, x: cos * dx + sin * dy, y: cos * dy - sin * dx, yaw: pose.yaw - yaw };
}

/** Returns the half axes of an ellipse in metres, and the direction of the long one in the grid frame. */
export function axesInGrid({ long_m, short_m, direction_rad }, [, , yaw]) {
  return [long_m, short_m, direction_rad - yaw];
}

/** Returns the time of the next decision after a time (or before it, if `by` is -1). */
export function decisionFrom(decisions, t, by) {
  const at = lastIndex(decisions, t);
  if (by > 0) return (decisions[at + 1] ?? decisions.at(-1))?.t ?? t;
  const before = decisions[at]?.t < t - 1e-6 ? at : at - 1;
  return (decisions[Math.max(before, 0)] ?? { t }).t;
}

/** Returns a time as minutes and seconds. */
export function clock(t) {
  const seconds = (t % 60).toFixed(1).padStart(4, "0");
  return `${Math.floor(t / 60)}:${seconds}`;
}

/** Returns the data in a packed text: JSON, compressed with zlib, in base64. */
export async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return JSON.parse(await new Response(stream).text());
}
