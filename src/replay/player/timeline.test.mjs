// Tests of timeline.mjs: `node --test src/replay/player`.
import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateSync } from "node:zlib";

import { lastAt, turn, posesFrom, poseAt, inGrid, axesInGrid, decisionFrom, clock, inflated } from "./timeline.mjs";
const at = (...times) => times.map((t) => ({ t }));

test("the last entry holds until the next one, and none before the first", () => {
  const entries = at(1, 2, 2, 5);
  assert.equal(lastAt(entries, 0.9), null);
  assert.equal(lastAt(entries, 1), entries[0]);
  assert.equal(lastAt(entries, 2), entries[2]);
  assert.equal(lastAt(entries, 99), entries[3]);
});

test("a heading turns the short way across the half turn", () => {
  assert.ok(Math.abs(turn(3, -3) - (2 * Math.PI - 6)) < 1e-12);
  assert.ok(Math.abs(turn(-3, 3) + (2 * Math.PI - 6)) < 1e-12);
});

test("a robot glides between two poses but not to where another episode begins", () => {
  const lists = [[0, 0, 0, 3], [2, 0.5, 1, -3]];
  const half = poseAt(posesFrom(lists, []), 1);
  assert.deepEqual([half.x, half.y], [0.25, 0.5]);
  assert.ok(Math.abs(half.yaw - Math.PI) < 1e-12);
  const jumping = posesFrom(lists, at(0, 2));
  assert.equal(poseAt(jumping, 1.9).x, 0);
  assert.equal(poseAt(jumping, 2).x, 0.5);
});

test("a pose of the map is found in a grid that is moved and turned", () => {
  const pose = inGrid({ x: 1, y: 4, yaw: 2 }, [1, 2, Math.PI / 2]);
  assert.ok(Math.abs(pose.x - 2) < 1e-12 && Math.abs(pose.y) < 1e-12);
  assert.ok(Math.abs(pose.yaw - (2 - Math.PI / 2)) < 1e-12);
});

test("an ellipse turns with the grid and keeps its axes", () => {
  const [long, short, direction] = axesInGrid({ long_m: 0.2, short_m: 0.1, direction_rad: 2 }, [5, 5, 0.5]);
  assert.deepEqual([long, short, direction], [0.2, 0.1, 1.5]);
});

test("steps go from decision to decision and stop at the ends", () => {
  const decisions = at(1, 2, 3);
  assert.equal(decisionFrom(decisions, 0, 1), 1);
  assert.equal(decisionFrom(decisions, 1, 1), 2);
  assert.equal(decisionFrom(decisions, 3, 1), 3);
  assert.equal(decisionFrom(decisions, 2.5, -1), 2);
  assert.equal(decisionFrom(decisions, 2, -1), 1);
  assert.equal(decisionFrom(decisions, 1, -1), 1);
});

test("the clock counts minutes and seconds", () => {
  assert.deepEqual([0, 9.96, 61.25, 600].map(clock), ["0:00.0", "0:10.0", "1:01.3", "10:00.0"]);
});

test("packed data are unpacked", async () => {
  const data = { rule: "value ± 1", poses: [[0, 1.5, -2, 3]] };
  const text = deflateSync(JSON.stringify(data)).toString("base64");
  assert.deepEqual(await inflated(text), data);
});
