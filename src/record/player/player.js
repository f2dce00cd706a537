"use strict";
// Draws a recording from above, and shows what the robot decides and why. All text is set as text, never as HTML.

const data = JSON.parse(document.getElementById("data").textContent);
data.poses = posesFrom(data.poses, data.begins);
data.mistakes = posesFrom(data.mistakes, []);
const byId = (id) => document.getElementById(id);
const COLOURS = { wall: "#57657f", floor: "#eef1f5", line: "#c3cad6", start: "#f4b740", goal: "#35c46a", robot: "#f58220", trail: "#a82bd0", estimate: "#2f9ce0", hit: "#e0322f" };
[COLOURS.far, COLOURS.near, COLOURS.never] = data.arrow_colours;
[COLOURS.free, COLOURS.blocked, COLOURS.beam] = data.percept_colours;
const LAYERS = [
  ["values", "values"],
  ["policy", "policy"],
  ["trail", "path"],
  ["percept", "percept and lidar"],
  ["estimate", "estimate"],
];
const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
const state = { t: 0, playing: false, speed: 1, shown: new Set(["policy", "trail", "percept", "estimate"]) };

const { world } = data;
const [width_m, height_m] = [world.width * world.cell_size_m, world.height * world.cell_size_m];

// ---- drawing

/** Prepares a canvas for the sharpness of the screen, and returns its context and size. */
function prepared(canvas, aspect) {
  const room = canvas.parentElement.clientWidth;
  const wide = aspect ? Math.min(room, aspect * Math.max(0.62 * innerHeight, 260)) : canvas.clientWidth;
  const high = aspect ? wide / aspect : canvas.clientHeight;
  const sharp = devicePixelRatio || 1;
  if (aspect) [canvas.style.width, canvas.style.height] = [`${wide}px`, `${high}px`];
  [canvas.width, canvas.height] = [Math.round(wide * sharp), Math.round(high * sharp)];
  const context = canvas.getContext("2d");
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  return [context, wide, high];
}

/** Draws shapes of a scene, in metres of the grid's frame. */
function drawShapes(context, shapes, pixel) {
  for (const { kind, colour, width, points } of shapes) {
    context.fillStyle = context.strokeStyle = colour;
    context.beginPath();
    if (kind === "triangles") {
      for (let at = 0; at + 5 < points.length; at += 6) {
        context.moveTo(points[at], points[at + 1]);
        context.lineTo(points[at + 2], points[at + 3]);
        context.lineTo(points[at + 4], points[at + 5]);
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
  const [robot, mistake] = [poseAt(data.poses, state.t), lastAt(data.mistakes, state.t)];
  if (!robot || !mistake) return;
  const at = inGrid(moved(robot, mistake), world.origin);
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
  const layer = (name) => state.shown.has(name) && drawShapes(context, lastAt(data.scenes[name], state.t)?.shapes ?? [], pixel);
  drawWorld(context, pixel);
  layer("values");
  layer("policy");
  if (state.shown.has("trail")) drawTrail(context, episodeBegin(), pixel);
  layer("percept");
  drawRobot(context);
  if (state.shown.has("estimate")) drawEstimate(context, pixel);
}

function drawCurve() {
  const { episode, steps } = data.curve;
  const canvas = byId("curve");
  canvas.hidden = !episode.length;
  if (!episode.length) return;
  const [context, wide, high] = prepared(canvas);
  const style = getComputedStyle(document.body);
  const [ink, accent] = [style.color, style.getPropertyValue("--accent")];
  const [left, bottom] = [38, 20];
  const last = Math.max(episode.at(-1), 1);
  const most = Math.max(...steps, 1);
  const x = (number) => left + ((wide - left - 8) * number) / last;
  const y = (count) => high - bottom - ((high - bottom - 12) * count) / most;
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = context.strokeStyle = ink;
  context.strokeRect(left, 6, wide - left - 8, high - bottom - 6);
  context.fillText(String(most), 4, 14);
  context.fillText("0", 24, high - bottom);
  context.fillText(`episode ${last}`, Math.max(wide - 80, left), high - 5);
  context.fillText("steps", 4, 28);
  context.strokeStyle = accent;
  context.lineWidth = 1.5;
  context.beginPath();
  episode.forEach((number, at) => context.lineTo(x(number), y(steps[at])));
  context.stroke();
  const now = currentEpisode();
  if (now === null) return;
  context.strokeStyle = COLOURS.hit;
  context.beginPath();
  context.moveTo(x(Math.min(now, last)), 6);
  context.lineTo(x(Math.min(now, last)), high - bottom);
  context.stroke();
}

// ---- words

/** Returns when the episode that is shown began. */
function episodeBegin() {
  return lastAt(data.begins, state.t)?.t ?? 0;
}

/** Returns the number of the episode that is shown, or null before the first. */
function currentEpisode() {
  return lastAt(data.episodes, state.t)?.episode ?? null;
}

function setFacts(list) {
  const rows = list.filter(([, value]) => value !== null && value !== undefined && value !== "");
  byId("facts").replaceChildren(
    ...rows.flatMap(([name, value]) => {
      const [term, text] = [document.createElement("dt"), document.createElement("dd")];
      [term.textContent, text.textContent] = [name, value];
      return [term, text];
    }),
  );
}

function setValues(decision) {
  const values = decision?.values ?? [];
  const known = values.filter((value) => value !== null);
  const [least, greatest] = [Math.min(...known), Math.max(...known)];
  const rows = values.map((value, at) => {
    const row = document.createElement("tr");
    row.className = data.actions[at] === decision.action ? "chosen" : "";
    const [name, number, bar] = [0, 1, 2].map(() => row.insertCell());
    name.textContent = data.actions[at] ?? `action ${at + 1}`;
    number.className = "number";
    number.textContent = value === null ? "unknown" : value.toFixed(1);
    bar.className = "bar";
    const fill = document.createElement("div");
    // The worst known action has a short bar, and unknown ones have none.
    const share = value === null ? 0 : greatest === least ? 1 : 0.1 + (0.9 * (value - least)) / (greatest - least);
    fill.style.width = `${100 * share}%`;
    bar.append(fill);
    return row;
  });
  byId("values").replaceChildren(...rows);
}

function describe() {
  const decision = lastAt(data.decisions, state.t);
  const current = decision && decision.t >= episodeBegin() ? decision : null;
  const estimate = lastAt(data.estimates, state.t);
  const episode = lastAt(data.episodes, state.t);
  const caption = lastAt(data.captions, state.t);
  byId("caption").textContent = caption?.title ?? "";
  byId("remark").textContent = caption?.remark ?? "";
  const who = { rules: "a rule", table: "the table or plan", planner: "planned exploration", chance: "chance" };
  byId("why").textContent = current ? current.rule || `chosen by ${who[current.chosen_by] ?? current.chosen_by}` : "";
  setFacts([
    ["episode", episode?.episode],
    ["step", current?.step],
    ["action", current?.action],
    ["chosen by", current && (who[current.chosen_by] ?? current.chosen_by)],
    ["perceived", current?.seen],
    ["next best", current?.runner_up],
    ["steps left", current && `${current.left} %`],
    ["estimate off by", estimate && `${(100 * estimate.error_m).toFixed(1)} cm, ${Math.abs(estimate.heading_error_deg).toFixed(1)}°${estimate.mislocalised ? ", mislocalised" : ""}`],
    ["standard deviation", estimate && `${(100 * Math.hypot(estimate.sd_x_m, estimate.sd_y_m)).toFixed(1)} cm, ${estimate.sd_heading_deg.toFixed(1)}°`],
    ["policy", episode && (episode.optimal ? "optimal" : "not optimal yet")],
  ]);
  setValues(current);
  byId("segment").selectedIndex = Math.max(lastIndex(data.segments, state.t), 0);
  byId("clock").textContent = `${clock(state.t)} / ${clock(data.end)}`;
  byId("seek").value = state.t;
  byId("seek").setAttribute("aria-valuetext", `${clock(state.t)}, ${caption?.title ?? ""}`);
}

// ---- playing

function show() {
  drawMaze();
  drawCurve();
  describe();
}

function seek(t) {
  state.t = Math.min(Math.max(t, 0), data.end);
  show();
}

/** Does something when the user touches an element, here and on the other side of a comparison. */
function on(id, event, act) {
  byId(id).addEventListener(event, (happened) => {
    act(happened);
    share();
  });
}

/** Tells the other side of a comparison what is played. */
function share() {
  if (parent !== window) parent.postMessage({ t: state.t, playing: state.playing, speed: state.speed }, "*");
}

/** Plays what the other side of a comparison plays. */
function follow({ t, playing, speed }) {
  byId("speed").value = state.speed = speed;
  seek(t);
  if (playing !== state.playing) setPlaying(playing);
}

function setPlaying(playing) {
  state.playing = playing && data.end > 0;
  if (state.playing && state.t >= data.end) state.t = 0;
  byId("play").textContent = state.playing ? "Pause" : "Play";
  byId("why").setAttribute("aria-live", state.playing ? "off" : "polite");
  if (state.playing) requestAnimationFrame(frame);
}

let before = null;
function frame(now) {
  if (!state.playing) {
    before = null;
    return;
  }
  const passed = before === null ? 0 : Math.min((now - before) / 1000, 0.25);
  before = now;
  const t = state.t + passed * state.speed;
  if (still) {
    // Without motion, the picture changes from decision to decision.
    if (lastIndex(data.decisions, t) !== lastIndex(data.decisions, state.t) || before === now) seek(t);
    else state.t = t;
  } else seek(t);
  if (state.t >= data.end) setPlaying(false);
  requestAnimationFrame(frame);
}

function step(by) {
  setPlaying(false);
  seek(decisionFrom(data.decisions, state.t, by));
}

function setSpeed(by) {
  const select = byId("speed");
  select.selectedIndex = Math.min(Math.max(select.selectedIndex + by, 0), select.options.length - 1);
  state.speed = Number(select.value);
}

function begin() {
  byId("result").textContent = data.result;
  byId("curve-note").textContent = data.curve.episode.length ? "The red line marks the episode that is shown. Click to go to an episode." : "This recording has no learning curve.";
  byId("seek").max = data.end;
  const legend = [["far", "best action, far from the goal"], ["near", "near it (between: green)"], ["never", "not on a way to the goal"], ["start", "start"], ["goal", "goal"], ["robot", "robot; its arrow is its front, it also drives backward"], ["trail", "path of this episode"], ["hit", "collision"]];
  if (data.scenes.percept.length) legend.push(["free", "perceived as free when it decided"], ["blocked", "perceived as a wall"]);
  if (data.estimates.length) legend.push(["beam", "lidar beam, where recorded (in highlights: the last drive)"], ["estimate", "estimated pose; dashed: 3 standard deviations, 10 times as large"]);
  byId("legend").replaceChildren(
    ...legend.map(([colour, text]) => {
      const [item, mark] = [document.createElement("li"), document.createElement("i")];
      mark.style.background = COLOURS[colour];
      item.append(mark, text);
      return item;
    }),
  );
  for (const [name, text] of LAYERS) {
    if (name in data.scenes ? !data.scenes[name].length : name === "estimate" && !data.estimates.length) continue;
    const [label, box] = [document.createElement("label"), document.createElement("input")];
    box.type = "checkbox";
    box.checked = state.shown.has(name);
    box.addEventListener("change", () => {
      state.shown[box.checked ? "add" : "delete"](name);
      drawMaze();
    });
    label.append(box, ` ${text}`);
    byId("layers").append(label);
  }
  const segments = data.segments.map(({ t, title }) => new Option(title, t));
  byId("segment").replaceChildren(...segments);
  byId("segment").parentElement.hidden = segments.length < 2;
  on("segment", "change", (event) => seek(Number(event.target.value)));
  on("play", "click", () => setPlaying(!state.playing));
  on("maze", "click", () => setPlaying(!state.playing));
  on("back", "click", () => step(-1));
  on("next", "click", () => step(1));
  on("speed", "change", () => setSpeed(0));
  on("seek", "input", (event) => {
    setPlaying(false);
    seek(Number(event.target.value));
  });
  on("curve", "click", (event) => {
    const [left, wide] = [38, event.target.clientWidth - 46];
    const episode = ((event.offsetX - left) / wide) * data.curve.episode.at(-1);
    const found = data.episodes.reduce((best, one) => (Math.abs(one.episode - episode) < Math.abs(best.episode - episode) ? one : best));
    seek(found.t);
  });
  const keys = {
    " ": () => setPlaying(!state.playing),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => seek(0),
    End: () => seek(data.end),
    "+": () => setSpeed(1),
    "-": () => setSpeed(-1),
  };
  addEventListener("keydown", (event) => {
    const inControl = event.target.closest?.("select, input, button");
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key] || inControl) return;
    event.preventDefault();
    keys[event.key]();
    share();
  });
  addEventListener("message", ({ source, data }) => source === parent && follow(data));
  addEventListener("resize", show);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
  const wanted = /^#t=([\d.]+)$/.exec(location.hash);
  seek(wanted ? Number(wanted[1]) : 0);
}

begin();
