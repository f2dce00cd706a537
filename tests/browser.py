#!/usr/bin/env python3
"""Plays the page of a recording in a real browser, and compares what it shows with the recording.

Usage: browser.py PAGE RECORDING [RUN [CHROMIUM]]     needs Chromium and the Python package mcap

The browser is driven through its debugging pipe. The page must show the decisions of the recording, play, pause, seek,
obey the keys, switch its layers, fit into 360 pixels, load nothing, and write nothing to the console. With reduced motion, nothing may move
between two decisions. The page of the folder RUN must show the
decisions of all episodes. Ends with code 1 at the first fault.
"""

import bisect
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mcap.reader import make_reader

SIZES = [(360, 780), (1280, 900), (3840, 2160)]


class Browser:
    """A headless browser with one page, driven through the Chrome DevTools Protocol."""

    def __init__(self, program):
        self.profile = tempfile.TemporaryDirectory()
        (theirs_in, self.out), (self.inp, theirs_out) = os.pipe(), os.pipe()
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"]
        command = [program, *arguments, f"--user-data-dir={self.profile.name}", "about:blank"]
        # The browser reads from descriptor 3 and writes to descriptor 4.
        shell = ["bash", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "browser", *command]
        self.process = subprocess.Popen(shell, pass_fds=(theirs_in, theirs_out), stderr=subprocess.DEVNULL)
        os.close(theirs_in)
        os.close(theirs_out)
        self.number, self.rest, self.events, self.session = 0, b"", [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")

    def call(self, method, **params):
        """Calls a method of the protocol and returns its result. Keeps the events that come meanwhile."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") != self.number:
                self.events.append(answer)
            elif "error" in answer:
                raise SystemExit(f"{method}: {answer['error']}")
            else:
                return answer["result"]

    def receive(self):
        while b"\0" not in self.rest:
            piece = os.read(self.inp, 1 << 16)
            if not piece:
                raise SystemExit("the browser has ended")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def evaluate(self, script):
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True)
        if "exceptionDetails" in result:
            raise SystemExit(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def key(self, name, text=""):
        for kind in ["keyDown", "keyUp"]:
            self.call("Input.dispatchKeyEvent", type=kind, key=name, text=text if kind == "keyDown" else "")

    def close(self):
        self.call("Browser.close")
        self.process.wait(30)


def expect(condition, what):
    if not condition:
        raise SystemExit(f"fault: {what}")


def decisions(recording):
    """Returns the time in seconds, the step, the rule and the action of each decision."""
    with open(recording, "rb") as file:
        messages = [(m.log_time, c.topic, m.data) for _, c, m in make_reader(file).iter_messages()]
    first = min(time_ns for time_ns, _, _ in messages)
    reasons = [((t - first) / 1e9, json.loads(data)) for t, topic, data in messages if topic == "/rule"]
    return [(t, one["step"], one["rule"], one["action"]) for t, one in reasons]


def seek(browser, t):
    browser.evaluate(f"var s = document.getElementById('seek'); s.value = {t}; s.dispatchEvent(new Event('input'))")


T = "Number(document.getElementById('maze').dataset.t)"
END = "Number(document.getElementById('seek').max)"


def shown(browser):
    facts = "Object.fromEntries([...document.querySelectorAll('dt')].map((t) => [t.textContent, t.nextSibling.textContent]))"
    return browser.evaluate(f"({{why: document.getElementById('why').textContent, t: {T}, playing: document.getElementById('play').textContent === 'Pause', ...{facts}}})")


def check_numbers(browser, recording):
    expected = decisions(recording)
    times = [t for t, *_ in expected]
    for t, step, rule, action in expected[:: max(len(expected) // 20, 1)]:
        seek(browser, t + 0.03)
        last = expected[bisect.bisect_right(times, browser.evaluate(T) + 1e-9) - 1]
        seen = shown(browser)
        expect(seen["why"] == last[2], f"at {t} s the page says {seen['why']!r}, the recording {last[2]!r}")
        expect((seen["step"], seen["action"]) == (str(last[1]), last[3]), f"at {t} s: {seen}, {last}")
    return len(expected)


def check_playing(browser):
    seek(browser, 0)
    browser.evaluate("document.getElementById('play').click()")
    time.sleep(1.0)
    playing = shown(browser)
    expect(playing["playing"] and playing["t"] > 0.2, f"it does not play: {playing}")
    browser.evaluate("document.activeElement.blur()")
    browser.key(" ", " ")
    paused = shown(browser)
    expect(not paused["playing"], "space does not pause")
    browser.key("ArrowRight")
    after = shown(browser)
    expect(after["t"] > paused["t"], "the right arrow does not go to the next decision")
    browser.evaluate("document.getElementById('play').focus()")
    browser.key("ArrowRight")
    expect(shown(browser)["t"] > after["t"], "the right arrow does nothing on a button")
    browser.evaluate("document.activeElement.blur()")
    browser.key("ArrowLeft")
    browser.key("ArrowLeft")
    expect(shown(browser)["t"] < after["t"], "the left arrow does not go back")
    browser.key("End")
    expect(abs(shown(browser)["t"] - browser.evaluate(END)) < 1e-6, "End does not go to the end")


def check_layers(browser):
    """Switches each layer over: the picture of the end of the recording must change, and change back."""
    seek(browser, browser.evaluate(END))
    picture = "document.getElementById('maze').toDataURL()"
    count = browser.evaluate("document.querySelectorAll('#layers input').length")
    expect(count >= 4, f"the page has {count} layers")
    for at in range(count):
        pictures = [browser.evaluate(picture)]
        for _ in range(2):
            browser.evaluate(f"document.querySelectorAll('#layers input')[{at}].click()")
            pictures.append(browser.evaluate(picture))
        expect(pictures[0] == pictures[2] != pictures[1], f"layer {at} does not change the picture, or not back")


def check_reduced_motion(browser):
    """Plays with reduced motion: the picture may only change when the robot decides."""
    pictures = "new Set(seen).size"
    watch = """(() => {
        window.seen = [];
        const maze = document.getElementById('maze');
        new MutationObserver(() => seen.push(maze.dataset.t)).observe(maze, { attributeFilter: ['data-t'] });
    })()"""
    decided_until = f"JSON.parse(document.getElementById('data').textContent).decisions.filter(({{ t }}) => t > 0 && t <= {T}).length"
    browser.evaluate(watch)
    for value, is_still in [("no-preference", False), ("reduce", True)]:
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": value}])
        seek(browser, 0)
        browser.evaluate("seen.length = 0; document.getElementById('play').click()")
        time.sleep(1.5)
        browser.evaluate("document.getElementById('play').click()")
        drawn, decided = browser.evaluate(pictures), browser.evaluate(decided_until)
        expect(decided > 0 and (drawn <= decided + 1) == is_still, f"{value}: {drawn} pictures of {decided} decisions")
    browser.call("Emulation.setEmulatedMedia", features=[])


def check_targets(browser):
    """Fingers need targets of 44 pixels, and mice need targets of 24 (WCAG 2.5.5 and 2.5.8)."""
    small = """[...document.querySelectorAll('button, select, #seek, #layers label')].filter((one) => one.offsetParent
        && Math.min(one.getBoundingClientRect().height, one.getBoundingClientRect().width) < LEAST).map((one) => one.id || one.textContent)"""
    expect(not browser.evaluate(small.replace("LEAST", "24")), "a target is too small for a mouse")
    browser.call("Emulation.setDeviceMetricsOverride", width=360, height=780, deviceScaleFactor=2, mobile=True)
    browser.call("Emulation.setTouchEmulationEnabled", enabled=True)
    time.sleep(0.3)
    expect(not browser.evaluate(small.replace("LEAST", "44")), "a target is too small for a finger")
    browser.call("Emulation.setTouchEmulationEnabled", enabled=False)
    browser.call("Emulation.clearDeviceMetricsOverride")


def check_episodes(browser, run):
    """Goes to episodes inside the page of a run, and expects the decisions of their recordings."""
    go(browser, run / "replay.html")
    recordings = sorted(run.glob("ep-*.mcap"))
    places = browser.evaluate("[...document.getElementById('place').options].map((one) => one.value).filter((one) => one[0] === 'e')")
    expect(len(places) == len(recordings), f"the page has {len(places)} of {len(recordings)} episodes")
    for at in [0, len(places) // 2, len(places) - 1]:
        browser.evaluate(f"var p = document.getElementById('place'); p.value = '{places[at]}'; p.dispatchEvent(new Event('change'))")
        time.sleep(0.3)
        expect(browser.evaluate("document.getElementById('place').value") == places[at], f"the page does not show {places[at]}")
        check_numbers(browser, recordings[at])
    browser.evaluate("var p = document.getElementById('place'); p.value = 't0'; p.dispatchEvent(new Event('change'))")
    time.sleep(0.1)
    expect(browser.evaluate("document.getElementById('place').value") == "t0", "the page does not go back to the drive")
    return len(places)


def check_sizes(browser):
    for width, height in SIZES:
        browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        time.sleep(0.3)
        wide = browser.evaluate("document.documentElement.scrollWidth")
        expect(wide <= width, f"at {width} pixels the page is {wide} wide")
        painted = "(() => { const c = document.getElementById('maze'); const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; return new Set(p.filter((_, i) => i % 4 === 0)).size; })()"
        expect(browser.evaluate(painted) > 5, f"at {width} pixels the maze is not drawn")


def go(browser, page):
    browser.call("Page.navigate", url=Path(page).resolve().as_uri())
    time.sleep(1.5)


def main():
    page, recording, *more = sys.argv[1:]
    browser = Browser(more[1] if len(more) > 1 else "chromium")
    go(browser, page)
    count = check_numbers(browser, recording)
    check_playing(browser)
    check_layers(browser)
    check_sizes(browser)
    check_targets(browser)
    check_reduced_motion(browser)
    if more:
        check_episodes(browser, Path(more[0]))
    said = [e for e in browser.events if e.get("method") in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown")]
    logged = [e["params"]["entry"] for e in browser.events if e.get("method") == "Log.entryAdded"]
    # A warning about reading pixels back is this script's own.
    said += [entry for entry in logged if entry["source"] != "rendering"]
    expect(not said, f"the console has {said[:3]}")
    asked = [e["params"]["request"]["url"] for e in browser.events if e.get("method") == "Network.requestWillBeSent"]
    expect(all(url.startswith("file:") and url.endswith(".html") for url in asked), f"it loads {asked}")
    browser.close()
    print(f"the page shows {count} decisions as the recording has them; it plays, seeks and fits")


if __name__ == "__main__":
    main()
