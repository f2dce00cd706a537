// Tests of words.mjs: `node --test src/replay/player`.
import assert from "node:assert/strict";
import { test } from "node:test";

import { summary, because, terms, sureness } from "./words.mjs";

test("the summary compares the first episode with the last one, if there are several", () => {
  const curve = { episode: [1, 2], steps: [40, 10] };
  assert.match(summary(curve, "The last one took 10."), /Episode 1 took 40 steps\. The last one took 10\.$/);
  assert.doesNotMatch(summary({ episode: [1], steps: [40] }, ""), /Episode/);
});

test("every source of decisions has its reason, and an unknown one is named", () => {
  for (const chosen_by of ["rules", "table", "planner", "chance"]) {
    const text = because({ action: "east", chosen_by });
    assert.match(text, /^The robot chooses east [a-z].*:$/);
    assert.doesNotMatch(text, /\(/);
  }
  assert.equal(because({ action: "east", chosen_by: "dice" }), "The robot chooses east (dice):");
});

test("the terms that a rule uses are explained, and no others", () => {
  assert.match(terms("east free, y <= 3 -> east, value -4 ± 1"), /^x, y: .* value ±: /);
  assert.match(terms("x > -2 -> east"), /^x, y: [^±]*$/);
  assert.equal(terms("explores by plan -> east"), "");
});

test("the sureness has standard deviations, errors and a warning if mislocalised", () => {
  const estimate = { sd_x_m: 0.03, sd_y_m: 0.04, sd_heading_deg: 0.25, error_m: 0.012, heading_error_deg: -1.26, mislocalised: false };
  const text = sureness(estimate);
  for (const part of ["± 5.0 cm", "± 0.3°", "off by 1.2 cm and 1.3°"]) assert.ok(text.includes(part), text);
  assert.doesNotMatch(text, /mislocalised/);
  assert.match(sureness({ ...estimate, mislocalised: true }), /mislocalised/);
  assert.equal(sureness(null), "");
});
