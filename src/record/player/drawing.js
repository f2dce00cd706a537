"use strict";
// Draws a recording from above, and its learning curve.

const COLOURS = { wall: "#57657f", floor: "#eef1f5", line: "#c3cad6", start: "#f4b740", goal: "#35c46a", robot: "#f58220", trail: "#1d2430", outline: "#1d2430", estimate: "#2f9ce0", hit: "#e0322f" };

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

/** Draws shapes of a scene, in metres of the grid's frame. Triangles can have an outline, which is visible on any ground. */
function drawShapes(context, shapes, pixel, isOutlined) {
  for (const { kind, colour, width, points } of shapes) {
    context.fillStyle = context.strokeStyle = colour;
    context.beginPath();
    if (kind === "triangles") {
      for (let at = 0; at + 5 < points.length; at += 6) {
        context.moveTo(points[at], points[at + 1]);
        context.lineTo(points[at + 2], points[at + 3]);
        context.lineTo(points[at + 4], points[at + 5]);
      }
      if (isOutlined) {
        context.strokeStyle = COLOURS.outline;
        context.lineWidth = 2 * pixel;
        context.stroke();
      }
      context.fill();
    } else {
      for (let at = 0; at + 3 < points.length; at += 4) {
        context.moveTo(points[at], points[at + 1]);
        context.lineTo(points[at + 2], points[at + 3]);
      }
      context.lineWidth = Math.max(width, 1.2 * pixel);
      context.stroke();
    }
  }
}

function drawWorld(context, pixel) {
  const unit = world.cell_size_m;
  context.fillStyle = COLOURS.floor;
  context.fillRect(0, 0, width_m, height_m);
  world.rows.forEach((row, number) => {
    const y = height_m - (number + 1) * unit;
    [...row].forEach((cell, column) => {
      const fill = { "#": COLOURS.wall, S: COLOURS.start, G: COLOURS.goal }[cell];
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
function drawTrail(context, begun, pixel) {
  context.strokeStyle = COLOURS.trail;
  context.lineWidth = Math.max(0.05 * world.cell_size_m, 1.5 * pixel);
  context.beginPath();
  let pen = false;
  for (let at = Math.max(lastIndex(data.poses, begun), 0); at < data.poses.length && data.poses[at].t <= state.t; at++) {
    const pose = inGrid(data.poses[at], world.origin);
    if (pen && !pose.jumps) context.lineTo(pose.x, pose.y);
    else context.moveTo(pose.x, pose.y);
    pen = data.poses[at].t >= begun;
  }
  context.stroke();
  context.fillStyle = COLOURS.hit;
  for (const hit of data.contacts) {
    if (hit.t < begun || hit.t > state.t) continue;
    const at = inGrid({ x: hit.x_m, y: hit.y_m, yaw: 0 }, world.origin);
    context.beginPath();
    context.arc(at.x, at.y, 0.12 * world.cell_size_m, 0, 7);
    context.fill();
  }
}

/** Draws the estimated pose with its uncertainty, ten times as large as it is. */
function drawEstimate(context, pixel) {
  const pose = poseAt(data.estimated, state.t);
  if (!pose) return;
  const at = inGrid(pose, world.origin);
  context.strokeStyle = COLOURS.estimate;
  context.lineWidth = 2 * pixel;
  context.beginPath();
  context.arc(at.x, at.y, 1.2 * data.robot_radius_m, 0, 7);
  context.stroke();
  const estimate = lastAt(data.estimates, state.t);
  if (!estimate) return;
  context.setLineDash([4 * pixel, 3 * pixel]);
  context.beginPath();
  context.ellipse(at.x, at.y, 30 * estimate.sd_x_m, 30 * estimate.sd_y_m, -world.origin[2], 0, 7);
  context.stroke();
  context.setLineDash([]);
}

function drawRobot(context) {
  const pose = poseAt(data.poses, state.t);
  if (!pose) return;
  const { x, y, yaw } = inGrid(pose, world.origin);
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

function drawMaze() {
  const [context, wide, high] = prepared(byId("maze"), width_m / height_m);
  const scale = wide / width_m;
  const pixel = 1 / scale;
  context.transform(scale, 0, 0, -scale, 0, high);
  const layer = (name) => state.shown.has(name) && drawShapes(context, lastAt(data.scenes[name], state.t)?.shapes ?? [], pixel, name === "policy");
  drawWorld(context, pixel);
  layer("values");
  layer("policy");
  if (state.shown.has("trail")) drawTrail(context, episodeBegin(), pixel);
  layer("percept");
  drawRobot(context);
  if (state.shown.has("estimate")) drawEstimate(context, pixel);
}

/** Returns the text size of the learning curve, and the frame around the curve, in pixels. */
function curveFrame(canvas) {
  const size = 0.72 * parseFloat(getComputedStyle(canvas).fontSize);
  return { size, left: 3.4 * size, right: canvas.clientWidth - 8, top: 6, bottom: canvas.clientHeight - 1.8 * size };
}

/** Returns which share of the learning curve is left of a point, from 0 to 1. */
function shareOfCurve(canvas, x) {
  const { left, right } = curveFrame(canvas);
  return Math.min(Math.max((x - left) / (right - left), 0), 1);
}

function drawCurve() {
  const { episode, steps } = data.curve;
  const canvas = byId("curve");
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
  const now = currentEpisode();
  if (now === null) return;
  context.strokeStyle = COLOURS.hit;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x(Math.min(now, last)), top);
  context.lineTo(x(Math.min(now, last)), bottom);
  context.stroke();
}
