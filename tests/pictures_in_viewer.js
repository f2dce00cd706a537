#!/usr/bin/env node
// Makes the viewer's pictures in assets/ from fresh runs, in a viewer that you serve yourself.
//
//     npm install --prefix /tmp/browser playwright-core
//     NODE_PATH=/tmp/browser/node_modules node tests/pictures_in_viewer.js http://127.0.0.1:8081/ [FOLDER]
//
// The viewer is Lichtblick, built from its own sources (its README says how) and served on this
// machine. XCSCR names the program, if it is not target/release/xcscr; CHROMIUM the browser, if it
// is not /usr/bin/chromium. The trainings take a minute, a picture half of one.
"use strict";

const { execFileSync, spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const readline = require("node:readline");
const { chromium } = require("playwright-core");

const XCSCR = process.env.XCSCR ?? "target/release/xcscr";
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
const [viewer, into = "assets"] = process.argv.slice(2);
if (viewer == undefined) {
  console.error("usage: node tests/pictures_in_viewer.js VIEWER [FOLDER]");
  process.exit(2);
}

// Where the panels begin: beside the viewer's own settings, above its bar for playing.
const PANELS = { x: 320, y: 44 };
const BAR = 78;
// A browser without a graphics card needs so long.
const LOADED_MS = 25000;

const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "pictures-"));
const run = (name) => path.join(scratch, name);
const xcscr = (...args) => execFileSync(XCSCR, args, { encoding: "utf8" });
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

/** A picture of what a link shows after so many seconds; `change` may alter the layout. */
async function picture(browser, name, link, seconds, change = () => {}, size = [1600, 900]) {
  const page = await browser.newPage({
    viewport: { width: size[0], height: size[1] },
    colorScheme: "dark",
  });
  await page.route("**/foxglove-layout.json", async (route) => {
    const response = await route.fetch({ headers: { origin: new URL(viewer).origin } });
    const layout = await response.json();
    change(layout);
    await route.fulfill({ response, json: layout });
  });
  const url = new URL(viewer);
  url.search = new URL(link).search;
  url.searchParams.set("time", new Date(seconds * 1000).toISOString());
  await page.goto(url.href);
  await page.waitForTimeout(LOADED_MS);
  // Beams are shown for a moment only, and only while time goes on.
  await page.keyboard.press("Space");
  await page.waitForTimeout(1500);
  await page.keyboard.press("Space");
  await page.waitForTimeout(3000);
  const file = path.join(into, `${name}.png`);
  const clip = { ...PANELS, width: size[0] - PANELS.x, height: size[1] - PANELS.y - BAR };
  await page.screenshot({ path: file, clip, timeout: 180000 });
  await page.close();
  console.log(`${file}: ${fs.statSync(file).size} bytes`);
}

/** Shows the 3D panel alone, as close to the robot as asked. */
const closeUp = (cells) => (layout) => {
  const panel = layout.configById["3D!main"];
  panel.followMode = "follow-position";
  panel.followTf = "robot";
  panel.cameraState.distance = cells;
  panel.cameraState.targetOffset = [0, 0, 0];
  layout.layout = "3D!main";
};

const landscape = (layout) => {
  const panel = layout.configById["3D!main"];
  panel.topics["/scene/worth"].visible = true;
  panel.cameraState.phi = 50;
  panel.cameraState.distance *= 0.9;
  panel.topics["/scene/rule"].visible = false;
  layout.layout = "3D!main";
};

async function main() {
  train("worlds/maze4.json", "run", "--method", "xcscr", "--record", "beams");
  train("worlds/maze4.json", "other", "--method", "q-learning", "--seed", "2");
  fs.writeFileSync(run("rooms.json"), xcscr("world", "generate", "--kind", "rooms", "--size", "20", "--seed", "3"));
  const rooms = ["--arena", "grid", "--method", "r-max", "--sensor", "neighbours-position", "--episodes", "60"];
  train(run("rooms.json"), "large", ...rooms);

  const browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  const shown = await serve(run("run"), "--serve");
  const [story, whole] = shown.links;
  await picture(browser, "story", story, 80);
  await picture(browser, "run", whole, 1400);
  await picture(browser, "landscape", story, 80, landscape, [1120, 680]);
  shown.child.kill();
  const felt = await serve(path.join(run("run"), "ep-0001.mcap"), "--serve");
  await picture(browser, "felt", felt.links[0], 31, closeUp(5), [1120, 680]);
  felt.child.kill();
  const both = await serve(run("run"), run("other"), "--compare");
  await picture(browser, "compare", both.links[0], 100);
  both.child.kill();
  const large = await serve(run("large"), "--serve");
  await picture(browser, "large", large.links[0], 105);
  large.child.kill();
  await browser.close();
  fs.rmSync(scratch, { recursive: true });
}

main();
