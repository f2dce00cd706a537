#!/usr/bin/env python3
"""Opens the HTML report of a study in Chromium, without network, light and dark.

    xcscr study run paper --trials 6 --out study
    tests/report_in_browser.py study/report.html [PICTURE]

Checks that the page loads nothing, takes the colours that are preferred, shows its figures, tells
the methods apart by colour, and sorts its tables. With PICTURE, `PICTURE-light.png` and
`PICTURE-dark.png` show it. CHROMIUM names the browser, if it is not `chromium`.
"""

import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Runs in the page, and leaves what it found in the page's title.
PROBE = """
const numbers = (table, column) => [...table.tBodies[0].rows]
  .map(row => parseFloat(row.cells[column].textContent)).filter(x => !isNaN(x));
const table = [...document.querySelectorAll("table")]
  .find(table => [...table.tHead.rows[0].cells].some(cell => cell.textContent === "rules"));
const column = [...table.tHead.rows[0].cells].findIndex(cell => cell.textContent === "rules");
const found = {orders: []};
for (let clicks = 0; clicks < 2; clicks++) {
  table.tHead.rows[0].cells[column].querySelector("button").click();
  found.orders.push(numbers(table, column));
}
found.loaded = performance.getEntriesByType("resource").map(entry => entry.name);
found.paper = getComputedStyle(document.body).backgroundColor;
found.ink = getComputedStyle(document.body).color;
found.figures = [...document.querySelectorAll("figure svg")]
  .map(svg => svg.getBoundingClientRect().width);
found.curves = [...new Set([...document.querySelectorAll("figure svg polyline")]
  .map(line => getComputedStyle(line).stroke))];
document.title = JSON.stringify(found);
"""


def chromium(scheme, *arguments):
    dark = "0" if scheme == "dark" else "1"
    command = [os.environ.get("CHROMIUM", "chromium"), "--headless", "--no-sandbox",
               "--disable-gpu", "--hide-scrollbars", "--host-resolver-rules=MAP * ~NOTFOUND",
               f"--blink-settings=preferredColorScheme={dark}", "--window-size=1200,5200",
               *arguments]  # fmt: skip
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def channels(colour):
    return [int(number) for number in re.findall(r"\d+", colour)[:3]]


def brightness(colour):
    return sum(channels(colour)) / 3


def distance(a, b):
    return sum(abs(x - y) for x, y in zip(channels(a), channels(b)))


def main(page, picture=None):
    text = Path(page).read_text()
    with tempfile.TemporaryDirectory() as folder:
        probed = Path(folder, "report.html")
        probed.write_text(text.replace("</body>", f"<script>{PROBE}</script></body>"))
        papers = {}
        for scheme in ("light", "dark"):
            dom = chromium(scheme, "--dump-dom", probed.as_uri())
            title = re.search(r"<title>(.*?)</title>", dom, re.DOTALL)[1]
            found = json.loads(title.replace("&quot;", '"').replace("&amp;", "&"))
            ascending, descending = sorted(found["orders"])
            assert ascending == sorted(ascending) and len(ascending) > 1, found["orders"]
            assert descending == sorted(descending, reverse=True), found["orders"]
            assert found["loaded"] == [], found["loaded"]
            assert found["figures"] and min(found["figures"]) > 300, found["figures"]
            alike = [pair for pair in itertools.combinations(found["curves"], 2) if distance(*pair) < 60]
            assert not alike, f"{scheme}: {alike}"
            papers[scheme] = brightness(found["paper"])
            assert abs(papers[scheme] - brightness(found["ink"])) > 150, found
            print(f"{scheme}: paper {found['paper']}, ink {found['ink']}, "
                  f"{len(found['figures'])} figures, colours of curves {found['curves']}")  # fmt: skip
            if picture:
                shot = f"--screenshot={picture}-{scheme}.png"
                chromium(scheme, shot, Path(page).absolute().as_uri())
        assert papers["light"] > 200 and papers["dark"] < 50, papers
    print("the page is what it should be")


if __name__ == "__main__":
    main(*sys.argv[1:])
