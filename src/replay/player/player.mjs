// Plays a recording, and shows what the robot decides and why. All text is set as text, never as HTML.
import { COLOURS, drawCurve, drawMaze, shareOfCurve } from "./drawing.mjs";
import { clock, decisionFrom, inflated, lastAt, lastIndex, posesFrom } from "./timeline.mjs";
import { because, source, summary, sureness, terms } from "./words.mjs";

const byId = (id) => document.getElementById(id);
const LAYERS = [
  ["values", "rank of cells"],
  ["actions", "values of actions"],
  ["policy", "policy"],
  ["trail", "path"],
  ["percept", "percept"],
  ["estimate", "estimate"],
];
const FINAL_DRIVE = "The learned policy, exploration off";
const still = matchMedia("(prefers-reduced-motion: reduce)");
const state = { t: 0, playing: false, speed: 1, shown: new Set(["policy", "trail", "percept", "estimate"]) };

/** The recording of the page, and what is shown: the same, or one of the episodes that the page holds. */
const recording = withPoses(JSON.parse(byId("data").textContent));
let data = recording;
[COLOURS.far, , COLOURS.near] = data.arrow_colours;
COLOURS.never = data.no_goal_colour;
[COLOURS.free, COLOURS.blocked] = [data.percept_colours.free, data.percept_colours.wall];
[COLOURS.below, COLOURS.above] = data.value_colours;

function withPoses(data) {
  return { ...data, poses: posesFrom(data.poses, data.begins), estimated: posesFrom(data.estimated, data.begins) };
}

// ---- words

/** Returns when the episode that is shown began. */
function episodeBegin() {
  return lastAt(data.begins, state.t)?.t ?? 0;
}

/** Returns whether the page shows the drive of a run's learned policy. */
function isFinalDrive() {
  return data === recording && recording.packed_episodes.length > 0;
}

/** Returns the number of the episode that is shown, or null before the first and in the final drive. */
function currentEpisode() {
  if (isFinalDrive()) return null;
  return lastAt(data.begins, state.t)?.episode ?? null;
}

/** Returns what is shown. */
function caption() {
  if (isFinalDrive()) return FINAL_DRIVE;
  const episode = currentEpisode();
  const chapter = recording.chapters.find((one) => one.episode === episode);
  return chapter?.title ?? (episode === null ? "" : `${data.noun} ${episode}`);
}

/** Returns the place in the list that is shown, if it is a time of the recording. */
function place() {
  const begun = recording.begins.length > 1 ? episodeBegin() : 0;
  return `t${begun}`;
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
  const estimate = lastAt(data.localisations, state.t);
  const [begun, ended] = [lastAt(data.begins, state.t), lastAt(data.ends, state.t)];
  const episode = ended && ended.t >= begun?.t ? ended : begun;
  byId("caption").textContent = caption();
  byId("because").textContent = current ? because(current) : "";
  byId("why").textContent = current ? current.rule || `chosen by ${source(current.chosen_by)}` : "";
  byId("terms").textContent = terms(current?.rule ?? "");
  byId("sure").textContent = sureness(estimate);
  setFacts([
    ["episode", episode?.episode],
    ["step", current?.step],
    ["action", current?.action],
    ["chosen by", current && source(current.chosen_by)],
    ["perceived", current?.seen],
    ["next best", current?.runner_up],
    ["steps left", current && `${current.left} %`],
    ["policy", episode && (episode.optimal ? "optimal" : "not optimal yet")],
  ]);
  setValues(current);
  byId("place").value = data === recording ? place() : `e${data.episode}`;
  byId("seek").max = data.end;
  byId("clock").textContent = `${clock(state.t)} / ${clock(data.end)}`;
  byId("seek").value = state.t;
  byId("seek").setAttribute("aria-valuetext", `${clock(state.t)}, ${caption()}`);
}

// ---- playing

/** Returns what is drawn now. */
function view() {
  return { data, t: state.t, shown: state.shown, begun: episodeBegin(), episode: currentEpisode() };
}

function show() {
  drawMaze(byId("maze"), view());
  drawCurve(byId("curve"), view());
  describe();
  byId("maze").dataset.t = state.t;
}

function seek(t) {
  state.t = Math.min(Math.max(t, 0), data.end);
  show();
}

/** Does something when the user touches an element. */
function on(id, event, act) {
  byId(id).addEventListener(event, act);
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
  const t = Math.min(state.t + passed * state.speed, data.end);
  // Without motion, the picture changes from decision to decision.
  const waits = still.matches && t < data.end && lastIndex(data.decisions, t) === lastIndex(data.decisions, state.t);
  if (waits) state.t = t;
  else seek(t);
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

// ---- episodes

let opening = 0;

/** Shows an episode that the page holds, or the whole recording if there is no such episode. */
async function openEpisode(number) {
  const own = ++opening;
  const episode = recording.packed_episodes.find((one) => one.episode === number);
  const opened = episode ? { ...withPoses(await inflated(episode.data)), episode: number, curve: recording.curve } : recording;
  // A later choice may have been unpacked earlier.
  if (own !== opening) return;
  setPlaying(false);
  data = opened;
  seek(0);
}

/** Goes to a place of the list: a time of the recording, or an episode. */
async function goTo(place) {
  const number = Number(place.slice(1));
  if (place.startsWith("e")) return openEpisode(number);
  if (data !== recording) await openEpisode(null);
  seek(number);
}

/** Fills the list of places: the episodes of the recording, or the chapters and the episodes that the page holds. */
function listPlaces() {
  const begins = recording.begins.map(({ t, episode }) => new Option(`${recording.noun} ${episode}`, `t${t}`));
  const chapters = recording.chapters.map(({ title, episode }) => new Option(title, `e${episode}`));
  chapters.push(new Option(FINAL_DRIVE, "t0"));
  const others = recording.packed_episodes.filter((one) => !recording.chapters.some(({ episode }) => episode === one.episode));
  const episodes = others.map(({ episode }) => {
    const steps = recording.curve.steps[recording.curve.episode.indexOf(episode)];
    return new Option(`Episode ${episode}${steps === undefined ? "" : `: ${steps} steps`}`, `e${episode}`);
  });
  const groups = [["Highlights", chapters], ["Other episodes", episodes]];
  const titled = groups.map(([label, options]) => {
    const group = document.createElement("optgroup");
    group.label = label;
    group.append(...options);
    return group;
  });
  byId("place").replaceChildren(...(recording.packed_episodes.length ? titled : begins));
  byId("place").parentElement.hidden = byId("place").options.length < 2;
}

/** Goes to the episode nearest to a point of the learning curve. */
function goToCurve(share) {
  const wanted = share * recording.curve.episode.at(-1);
  const nearest = (list) => list.reduce((best, one) => (Math.abs(one.episode - wanted) < Math.abs(best.episode - wanted) ? one : best));
  if (recording.packed_episodes.length) openEpisode(nearest(recording.packed_episodes).episode);
  else seek(nearest(recording.begins).t);
}

// ---- controls

function begin() {
  // Old browsers cannot unpack the episodes.
  if (typeof DecompressionStream === "undefined") recording.packed_episodes = [];
  byId("result").textContent = summary(data.curve, data.result);
  byId("curve-note").textContent = data.curve.episode.length ? "The red line marks the shown episode. The learned policy has none. Click to go to an episode." : "This recording has no learning curve.";
  byId("sure-title").hidden = byId("sure").hidden = !data.localisations.length;
  listLegend();
  listLayers();
  listPlaces();
  listen();
  const wanted = /^#t=([\d.]+)$/.exec(location.hash);
  seek(wanted ? Number(wanted[1]) : 0);
}

/** Returns whether the robot perceives the cells around it. */
function perceives() {
  return data.decisions.some((decision) => decision.perceived.length);
}

function listLegend() {
  const legend = [["far", "best action, far from the goal"], ["near", "near it (between: green)"], ["never", "not on a way to the goal"], ["start", "start"], ["goal", "goal"], ["robot", "robot; its arrow is its front, it also drives backward"], ["trail", "path of this episode"], ["hit", "collision"]];
  if (data.learned.length) legend.push(["below", "value of an action below 0 (its length: the square root)"], ["above", "value above 0"]);
  if (perceives()) legend.push(["free", "perceived as free when it decided"], ["blocked", "perceived as a wall"]);
  if (data.localisations.length) legend.push(["estimate", "estimated pose; dashed: 3 standard deviations, 10 times as large"]);
  byId("legend").replaceChildren(
    ...legend.map(([colour, text]) => {
      const [item, mark] = [document.createElement("li"), document.createElement("i")];
      mark.style.background = COLOURS[colour];
      item.append(mark, text);
      return item;
    }),
  );
}

function listLayers() {
  for (const [name, text] of LAYERS) {
    const has = { values: data.learned.length, actions: data.learned.length, policy: data.learned.length, percept: perceives(), estimate: data.localisations.length };
    if (name in has && !has[name]) continue;
    const [label, box] = [document.createElement("label"), document.createElement("input")];
    box.type = "checkbox";
    box.checked = state.shown.has(name);
    box.addEventListener("change", () => {
      state.shown[box.checked ? "add" : "delete"](name);
      drawMaze(byId("maze"), view());
    });
    label.append(box, ` ${text}`);
    byId("layers").append(label);
  }
}

function listen() {
  on("place", "change", (event) => goTo(event.target.value));
  on("play", "click", () => setPlaying(!state.playing));
  on("maze", "click", () => setPlaying(!state.playing));
  on("back", "click", () => step(-1));
  on("next", "click", () => step(1));
  on("speed", "change", () => setSpeed(0));
  on("seek", "input", (event) => {
    setPlaying(false);
    seek(Number(event.target.value));
  });
  on("curve", "click", ({ offsetX, target }) => goToCurve(shareOfCurve(target, offsetX)));
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
    // Lists and sliders need the keys themselves, and buttons and boxes the space bar.
    const own = event.key === " " ? "select, input, button" : 'select, input[type="range"]';
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key] || event.target.closest?.(own)) return;
    event.preventDefault();
    keys[event.key]();
  });
  addEventListener("resize", show);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
}

begin();
