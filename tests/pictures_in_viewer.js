#!/usr/bin/env node
// Makes the viewer's pictures in assets/ from fresh runs, in a viewer that you serve yourself.
//
//     npm install --prefix /tmp/browser playwright-core
//     NODE_PATH=/tmp/browser/node_modules node tests/pictures_in_viewer.js http://127.0.0.1:8081/ [FOLDER [NAME ...]]
//
// The viewer is Lichtblick, built from its own sources (its README says how) and served on this
// machine. XCSCR names the program, if it is not target/release/xcscr; CHROMIUM the browser, if it
// is not /usr/bin/chromium. The trainings take a minute,
// a picture another one.
"use strict";

const { execFileSync, spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const readline = require("node:readline");
const { chromium } = require("playwright-core");

const XCSCR = process.env.XCSCR ?? "target/release/xcscr";
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
const [viewer, into = "assets", ...names] = process.argv.slice(2);
if (viewer == undefined) {
  console.error("usage: node tests/pictures_in_viewer.js VIEWER [FOLDER [NAME ...]]");
  process.exit(2);
}

// Where the panels begin: beside the viewer's own settings, above its bar for playing.
const PANELS = { x: 320, y: 44 };
const BAR = 78;
// A browser without a graphics card needs so long.
const LOADED_MS = 40000;

const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "pictures-"));
const run = (name) => path.join(scratch, name);
const xcscr = (...args) => execFileSync(XCSCR, args, { encoding: "utf8" });
const isWanted = (name) => names.length === 0 || names.includes(name);
const train = (world, name, ...more) =>
  xcscr("train", world, "--quiet", "--out", run(name), ...more);

/** Serves recordings, and resolves to the links that are printed for each of them. */
function serve(...args) {
  const origin = new URL(viewer).origin;
  const stdio = ["ignore", "pipe", "inherit"];
  const child = spawn(XCSCR, ["replay", ...args, "--allow-origin", origin], { stdio });
  return new Promise((resolve, reject) => {
    child.on("exit", (code) => reject(new Error(`xcscr replay ended with code ${code}`)));
    const links = [];
    readline.createInterface({ input: child.stdout }).on("line", (line) => {
      const link = /^ {2}Lichtblick +(\S+)/.exec(line);
      if (link) links.push(link[1]);
      if (line.startsWith("Serving on")) resolve({ child, links });
    });
  });
}

/** A page that shows a link at so many seconds; `change` may alter the layout. */
async function opened(browser, link, seconds, change, [width, height]) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: "dark" });
  const url = new URL(viewer);
  url.search = new URL(link).search;
  // Recordings begin at this date.
  url.searchParams.set("time", new Date(Date.UTC(2000, 0, 1) + seconds * 1000).toISOString());
  const origin = { origin: url.origin };
  const asked = await page.request.get(url.searchParams.get("layoutUrl"), { headers: origin });
  const layout = await asked.json();
  change(layout);
  await page.route("**/foxglove-layout.json", (route) =>
    route.fulfill({ json: layout, headers: { "access-control-allow-origin": url.origin } }),
  );
  // Viewers of early 2025 take no layout from an address, but one to begin with from their page.
  await page.route(url.href, async (route) => {
    const response = await route.fetch();
    const place = "/*LICHTBLICK_SUITE_DEFAULT_LAYOUT_PLACEHOLDER*/";
    const body = (await response.text()).replace(place, () => JSON.stringify(layout));
    await route.fulfill({ response, body });
  });
  await page.goto(url.href);
  await page.waitForTimeout(LOADED_MS);
  return page;
}

/** Takes the panels of a page as a picture. */
async function take(page, file) {
  const size = page.viewportSize();
  const clip = { ...PANELS, width: size.width - PANELS.x, height: size.height - PANELS.y - BAR };
  await page.screenshot({ path: file, clip, timeout: 180000 });
}

/** A picture of what a link shows after so many seconds. */
async function picture(browser, name, link, seconds, change = () => {}, size = [1600, 900]) {
  if (!isWanted(name)) return;
  const page = await opened(browser, link, seconds, change, size);
  // Beams are shown for a moment only, and only while time goes on.
  await page.keyboard.press("Space");
  await page.waitForTimeout(1500);
  await page.keyboard.press("Space");
  await page.waitForTimeout(3000);
  const file = path.join(into, `${name}.png`);
  await take(page, file);
  await page.close();
  console.log(`${file}: ${fs.statSync(file).size} bytes`);
}

/** Shows the 3D panel alone, as close to the robot as asked. */
const closeUp = (cells) => (layout) => {
  const panel = layout.configById["3D!main"];
  panel.followMode = "follow-position";
  panel.followTf = "base_link_true";
  panel.cameraState.distance = cells;
  panel.cameraState.targetOffset = [0, 0, 0];
  layout.layout = "3D!main";
};

async function main() {
  train("worlds/maze4.json", "run", "--record", "beams");
  fs.writeFileSync(run("rooms.json"), xcscr("world", "generate", "--kind", "rooms", "--size", "20", "--seed", "3"));
  const rooms = ["--arena", "grid", "--method", "r-max", "--sensor", "neighbours-position", "--episodes", "60"];
  train(run("rooms.json"), "large", ...rooms);

  fs.writeFileSync(run("halls.json"), xcscr("world", "generate", "--kind", "rooms", "--size", "40", "--seed", "3"));
  train(run("halls.json"), "huge", ...rooms.slice(0, -1), "80");

  const browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  const shown = await serve(run("run"));
  const [whole] = shown.links;
  await picture(browser, "run", whole, 1396);
  shown.child.kill();
  const felt = await serve(path.join(run("run"), "ep-0001.mcap"));
  await picture(browser, "felt", felt.links[0], 30, closeUp(5), [1120, 680]);
  felt.child.kill();
  const large = await serve(run("large"));
  await picture(browser, "large", large.links[0], 3000);
  large.child.kill();
  const huge = await serve(run("huge"));
  await picture(browser, "huge", huge.links[0], 10700);
  huge.child.kill();
  await browser.close();
  fs.rmSync(scratch, { recursive: true });
}

main();
