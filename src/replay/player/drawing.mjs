// Draws a recording from above, and its learning curve.
//
// A view is what is drawn: the data of an episode (`data`), a time in seconds (`t`), the names of the
// layers that are shown (`shown`), when the episode began (`begun`), and its number (`episode`).
import { arrowColour, floorColour, valueLength } from "./colours.mjs";
import { axesInGrid, inGrid, lastAt, lastIndex, poseAt } from "./timeline.mjs";

export const COLOURS = { wall: "#57657f", floor: "#eef1f5", line: "#c3cad6", start: "#f4b740", goal: "#35c46a", robot: "#f58220", trail: "#1d2430", outline: "#1d2430", estimate: "#2f9ce0", hit: "#e0322f" };

/** Prepares a canvas for the sharpness of the screen, and returns its context and size. */
function prepared(canvas, aspect) {
  const room = canvas.parentElement.clientWidth;
  const wide = aspect ? Math.min(room, aspect * Math.max(0.62 * innerHeight, 220)) : canvas.clientWidth;
  const high = aspect ? wide / aspect : canvas.clientHeight;
  const sharp = devicePixelRatio || 1;
  if (aspect) [canvas.style.width, canvas.style.height] = [`${wide}px`, `${high}px`];
  [canvas.width, canvas.height] = [Math.round(wide * sharp), Math.round(high * sharp)];
  const context = canvas.getContext("2d");
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  return [context, wide, high];
}

/** Calls `draw` with each cell of the maze, its number, and its middle in metres of the grid's frame. */
function forEachCell({ width, height, cell_size_m }, draw) {
  for (let cell = 0; cell < width * height; cell++) {
    const [col, row] = [cell % width, Math.floor(cell / width)];
    draw(cell, (col + 0.5) * cell_size_m, (height - row - 0.5) * cell_size_m);
  }
}

/** Draws the ranks of the cells as the colour of the floor. */
function drawRanks(context, { world }, { rank }) {
  const unit = world.cell_size_m;
  forEachCell(world, (cell, x, y) => {
    if (!rank[cell]) return;
    context.fillStyle = floorColour(COLOURS.floor, rank[cell]);
    context.fillRect(x - unit / 2, y - unit / 2, unit, unit);
  });
}

/** Draws an arrow for each best action of each cell, with an outline, which is visible on any ground. */
function drawPolicy(context, data, { best, nearness }, pixel) {
  const { world } = data;
  const unit = world.cell_size_m / 32;
  context.strokeStyle = COLOURS.outline;
  context.lineWidth = 2 * pixel;
  forEachCell(world, (cell, x, y) => {
    context.fillStyle = arrowColour(data, nearness[cell]);
    world.moves.forEach(([east, north], action) => {
      if (!((best[cell] >> action) & 1)) return;
      const length = Math.hypot(east, north);
      const [dx, dy] = [(east / length) * unit, (north / length) * unit];
      context.beginPath();
      for (const [ahead, left] of [[15, 0], [4, 6], [7, 0], [4, -6]]) {
        context.lineTo(x + ahead * dx - left * dy, y + ahead * dy + left * dx);
      }
      context.closePath();
      context.stroke();
      context.fill();
    });
  });
}

/** Draws a triangle for each action of each cell: the longer, the greater its value is, above or below 0. */
function drawActionValues(context, { world, value_colours }, { shares }) {
  const unit = world.cell_size_m;
  const [below, above] = value_colours;
  forEachCell(world, (cell, x, y) => {
    world.moves.forEach(([east, north], action) => {
      const share = shares[cell * world.moves.length + action];
      if (!share) return;
      const ahead = 0.48 * unit * valueLength(share);
      const [dx, dy] = [east, north].map((part) => part / Math.hypot(east, north));
      context.fillStyle = share < 0 ? below : above;
      context.beginPath();
      context.moveTo(x + ahead * dx, y + ahead * dy);
      for (const side of [-0.1 * unit, 0.1 * unit]) context.lineTo(x - side * dy, y + side * dx);
      context.closePath();
      context.fill();
    });
  });
}

/** Draws a frame around each cell that the robot perceived when it decided. */
function drawPercept(context, { world, percept_colours }, { cell_m: [x, y], perceived }, pixel) {
  const unit = world.cell_size_m;
  context.lineWidth = Math.max(0.045 * unit, 1.2 * pixel);
  perceived.forEach((kind, at) => {
    const [east, north] = world.around[at];
    context.strokeStyle = percept_colours[kind];
    context.strokeRect(x + (east - 0.42) * unit, y + (north - 0.42) * unit, 0.84 * unit, 0.84 * unit);
  });
}

/** Draws the floor, and the walls of a map in their true shape. */
function drawTrueWalls(context, { walls }, [width_m, height_m]) {
  context.save();
  context.beginPath();
  context.rect(0, 0, width_m, height_m);
  context.clip();
  context.fillStyle = COLOURS.wall;
  context.fillRect(0, 0, width_m, height_m);
  context.translate(walls.corner[0], walls.corner[1]);
  context.rotate(walls.corner[2]);
  context.fillStyle = COLOURS.floor;
  context.fillRect(0, 0, ...walls.size_m);
  context.fillStyle = COLOURS.wall;
  for (const block of walls.blocks) context.fillRect(...block.map((pixels) => pixels * walls.pixel_m));
  context.restore();
}

function drawWorld(context, world, pixel) {
  const unit = world.cell_size_m;
  const [width_m, height_m] = size_m(world);
  context.fillStyle = COLOURS.floor;
  context.fillRect(0, 0, width_m, height_m);
  if (world.walls) drawTrueWalls(context, world, [width_m, height_m]);
  const wall = world.walls ? null : COLOURS.wall;
  world.rows.forEach((row, number) => {
    const y = height_m - (number + 1) * unit;
    [...row].forEach((cell, column) => {
      const fill = { "#": wall, S: COLOURS.start, G: COLOURS.goal }[cell];
      if (!fill) return;
      context.fillStyle = fill;
      const inset = cell === "#" ? 0 : 0.08 * unit;
      context.fillRect(column * unit + inset, y + inset, unit - 2 * inset, unit - 2 * inset);
    });
  });
  if (unit / pixel < 8) return;
  context.strokeStyle = COLOURS.line;
  context.lineWidth = pixel / 2;
  context.beginPath();
  for (let column = 1; column < world.width; column++) {
    context.moveTo(column * unit, 0);
    context.lineTo(column * unit, height_m);
  }
  for (let row = 1; row < world.height; row++) {
    context.moveTo(0, row * unit);
    context.lineTo(width_m, row * unit);
  }
  context.stroke();
}

/** Draws the path since the episode began, and where the robot hit a wall. */
function drawTrail(context, { data, t, begun }, pixel) {
  const { world } = data;
  context.strokeStyle = COLOURS.trail;
  context.lineWidth = Math.max(0.05 * world.cell_size_m, 1.5 * pixel);
  context.beginPath();
  let pen = false;
  for (let at = Math.max(lastIndex(data.poses, begun), 0); at < data.poses.length && data.poses[at].t <= t; at++) {
    const pose = inGrid(data.poses[at], world.origin);
    if (pen && !pose.jumps) context.lineTo(pose.x, pose.y);
    else context.moveTo(pose.x, pose.y);
    pen = data.poses[at].t >= begun;
  }
  context.stroke();
  context.fillStyle = COLOURS.hit;
  for (const hit of data.contacts) {
    if (hit.t < begun || hit.t > t) continue;
    const at = inGrid({ x: hit.x_m, y: hit.y_m, yaw: 0 }, world.origin);
    context.beginPath();
    context.arc(at.x, at.y, 0.12 * world.cell_size_m, 0, 7);
    context.fill();
  }
}

/** Draws the estimated pose with its uncertainty, ten times as large as it is. */
function drawEstimate(context, { data, t }, pixel) {
  const { world } = data;
  const pose = poseAt(data.estimated, t);
  if (!pose) return;
  const at = inGrid(pose, world.origin);
  context.strokeStyle = COLOURS.estimate;
  context.lineWidth = 2 * pixel;
  context.beginPath();
  context.arc(at.x, at.y, 1.2 * data.robot_radius_m, 0, 7);
  context.stroke();
  const estimate = lastAt(data.localisations, t);
  if (!estimate) return;
  const [long, short, direction] = axesInGrid(estimate.ellipse, world.origin);
  context.setLineDash([4 * pixel, 3 * pixel]);
  context.beginPath();
  context.ellipse(at.x, at.y, 30 * long, 30 * short, direction, 0, 7);
  context.stroke();
  context.setLineDash([]);
}

function drawRobot(context, { data, t }) {
  const pose = poseAt(data.poses, t);
  if (!pose) return;
  const { x, y, yaw } = inGrid(pose, data.world.origin);
  const radius = data.robot_radius_m;
  context.fillStyle = COLOURS.robot;
  context.beginPath();
  context.arc(x, y, radius, 0, 7);
  context.fill();
  context.fillStyle = "#ffffff";
  context.beginPath();
  for (const [ahead, left] of [[0.9, 0], [-0.1, 0.5], [0.15, 0], [-0.1, -0.5]]) {
    const [dx, dy] = [ahead * radius, left * radius];
    context.lineTo(x + dx * Math.cos(yaw) - dy * Math.sin(yaw), y + dx * Math.sin(yaw) + dy * Math.cos(yaw));
  }
  context.fill();
}

/** Returns width and height of a maze in metres. */
function size_m({ width, height, cell_size_m }) {
  return [width * cell_size_m, height * cell_size_m];
}

/** Draws a view from above. */
export function drawMaze(canvas, view) {
  const { data, t, shown } = view;
  const [width_m, height_m] = size_m(data.world);
  const [context, wide, high] = prepared(canvas, width_m / height_m);
  const scale = wide / width_m;
  const pixel = 1 / scale;
  context.transform(scale, 0, 0, -scale, 0, high);
  drawWorld(context, data.world, pixel);
  const [learned, decision] = [lastAt(data.learned, t), lastAt(data.decisions, t)];
  if (learned && shown.has("values")) drawRanks(context, data, learned);
  if (learned && shown.has("actions")) drawActionValues(context, data, learned);
  if (learned && shown.has("policy")) drawPolicy(context, data, learned, pixel);
  if (shown.has("trail")) drawTrail(context, view, pixel);
  if (decision && shown.has("percept")) drawPercept(context, data, decision, pixel);
  drawRobot(context, view);
  if (shown.has("estimate")) drawEstimate(context, view, pixel);
}

/** Returns the text size of the learning curve, and the frame around the curve, in pixels. */
function curveFrame(canvas) {
  const size = 0.72 * parseFloat(getComputedStyle(canvas).fontSize);
  return { size, left: 3.4 * size, right: canvas.clientWidth - 8, top: 6, bottom: canvas.clientHeight - 1.8 * size };
}

/** Returns which share of the learning curve is left of a point, from 0 to 1. */
export function shareOfCurve(canvas, x) {
  const { left, right } = curveFrame(canvas);
  return Math.min(Math.max((x - left) / (right - left), 0), 1);
}

/** Draws the steps of each episode, and a mark at the episode of a view. */
export function drawCurve(canvas, view) {
  const { episode, steps } = view.data.curve;
  canvas.hidden = !episode.length;
  if (!episode.length) return;
  const [context] = prepared(canvas);
  const { size, left, right, top, bottom } = curveFrame(canvas);
  const style = getComputedStyle(document.body);
  const [ink, accent] = [style.color, style.getPropertyValue("--accent")];
  const last = Math.max(episode.at(-1), 1);
  const most = Math.max(...steps, 1);
  const x = (number) => left + ((right - left) * number) / last;
  const y = (count) => bottom - ((bottom - top - 6) * count) / most;
  context.font = `${size}px system-ui, sans-serif`;
  context.fillStyle = context.strokeStyle = ink;
  context.strokeRect(left, top, right - left, bottom - top);
  context.textAlign = "right";
  context.fillText(String(most), left - 4, top + size);
  context.fillText("steps", left - 4, top + 2.3 * size);
  context.fillText("0", left - 4, bottom);
  context.fillText(`episode ${last}`, right, bottom + 1.4 * size);
  context.strokeStyle = accent;
  context.lineWidth = 1.5;
  context.beginPath();
  episode.forEach((number, at) => context.lineTo(x(number), y(steps[at])));
  context.stroke();
  const now = view.episode;
  if (now === null) return;
  context.strokeStyle = COLOURS.hit;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x(Math.min(now, last)), top);
  context.lineTo(x(Math.min(now, last)), bottom);
  context.stroke();
}
