// Tests of colours.mjs: `node --test src/replay/player`.
import assert from "node:assert/strict";
import { test } from "node:test";
import { arrowColour, floorColour, mixed, valueLength } from "./colours.mjs";

const data = { arrow_colours: ["#000000", "#808080", "#ffffff"], no_goal_colour: "#123456" };

test("a colour between two others has its share of both", () => {
  assert.equal(mixed("#000000", "#ff8000", 0.5), "#804000");
  assert.equal(mixed("#010203", "#ffffff", 0), "#010203");
});

test("best actions go from far to near, and those without a goal have a colour of their own", () => {
  assert.deepEqual([2, 11, 20].map((level) => arrowColour(data, level)), ["#000000", "#808080", "#ffffff"]);
  assert.equal(arrowColour(data, 0), "#123456");
});

test("the floor is stronger where the rank is better", () => {
  const [worst, best] = [2, 20].map((level) => parseInt(floorColour("#eef1f5", level).slice(1, 3), 16));
  assert.ok(best < worst);
});

test("the mark of a value is as long below 0 as above, and never too short to see", () => {
  assert.deepEqual([100, -25, 1].map(valueLength), [1, 0.5, 0.2]);
});
