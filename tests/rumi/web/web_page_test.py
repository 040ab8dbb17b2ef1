#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""web_page_test.py FALSE_WEB: the page of `rumi web` in Chromium, with a system that is played."""
import subprocess
import sys

from browser import Browser, count, eventually, missing, pixels

FRONT, SECOND_FRONT, BACK = (0, 114, 178), (0, 158, 115), (213, 94, 0)


class FalseWeb:
    def __init__(self):
        self.process = subprocess.Popen([sys.argv[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.url = f"http://127.0.0.1:{int(self.process.stdout.readline())}/"

    def say(self, words):
        self.process.stdin.write(words + "\n")
        self.process.stdin.flush()

    def end(self):
        self.process.stdin.close()
        assert self.process.wait() == 0


def check(condition, what):
    assert condition, what
    print(f"  {what}")


def shown(browser, name):
    return browser.run("return document.getElementById('view').dataset[arguments[0]]", name)


def until_text(browser, css, words):
    eventually(lambda: words in browser.text(css), f"{css} says: {words}")
    print(f"  {css}: {words}")


def check_layout(browser, width):
    browser.resize(width, 800)
    overlaps = browser.run("""
        const boxes = [...document.querySelectorAll('.panel, header')].map(e => [e.id || e.tagName, e.getBoundingClientRect()]);
        return boxes.flatMap(([a, p], i) => boxes.slice(i + 1).filter(([, q]) => p.left < q.right - 1 && q.left < p.right - 1 &&
          p.top < q.bottom - 1 && q.top < p.bottom - 1).map(([b]) => a + ' and ' + b));""")
    too_wide = browser.run("return document.documentElement.scrollWidth - innerWidth")
    check(not overlaps and too_wide <= 0, f"{width} pixels wide nothing overlaps or sticks out {overlaps} {too_wide}")


def test_a_run(browser, web):
    browser.resize(1280, 800)
    browser.open(web.url)
    until_text(browser, "#notice", "No process is heard on the bus (a bus in memory)")
    web.say("live")
    until_text(browser, "#processes", "front_tracker")
    eventually(lambda: browser.run("return document.getElementById('notice').hidden"), "the notice goes")
    browser.click("#show-more")
    check("<b>front_tracker</b>" in browser.text("#processes"), "what a process says is text, not HTML")
    browser.click("#show-more")
    until_text(browser, "#windows", "Tracking was not lost yet")
    until_text(browser, "#empty", "No map yet")
    web.say("track map window")
    until_text(browser, "#state", "tracking")
    until_text(browser, "#windows", "published")
    until_text(browser, "#bars-text", "360 of 360 images have a pose in the map, 60 of them by what was rebuilt alone")
    eventually(lambda: shown(browser, "landmarks") == "6500", "6500 landmarks are drawn")
    check(shown(browser, "submaps") == "3" and shown(browser, "camera") == "placed", "3 submaps, and the camera")
    eventually(lambda: browser.run("return document.getElementById('camera').naturalWidth") == 480, "the camera's image")


def test_the_drawing(browser):
    before = pixels(browser.screenshot("#view"))
    for name, colour in (("front 1", FRONT), ("front 2", SECOND_FRONT), ("back", BACK)):
        check(count(before, colour) > 100, f"{name} is drawn in its colour: {count(before, colour)} pixels")
    bars = pixels(browser.screenshot("#bars"))
    check(min(count(bars, FRONT), count(bars, SECOND_FRONT)) > 2000 and count(bars, BACK) > 1000, "the bars have these colours")
    browser.press("#view", "left")
    eventually(lambda: pixels(browser.screenshot("#view")) != before, "an arrow turns the map")
    browser.press("#view", "h")
    browser.click("#show-landmarks")
    white = count(before, (255, 255, 255))
    eventually(lambda: count(pixels(browser.screenshot("#view")), (255, 255, 255)) > white, "landmarks can be left out")
    browser.click("#show-landmarks")


def test_changes(browser, web):
    fetched = "return performance.getEntriesByType('resource').map(e => e.name).filter(n => n.includes('/submap/')).length"
    before = browser.run(fetched)
    web.say("grow map")
    eventually(lambda: shown(browser, "landmarks") == "6501", "one more landmark")
    check(browser.run(fetched) == before + 1, "only the submap that changed was fetched")
    web.say("lose")
    until_text(browser, "#state", "lost")
    eventually(lambda: shown(browser, "camera") == "none", "the camera is nowhere")
    web.say("silence")
    until_text(browser, "#notice", "No process is on the bus any more")
    complaints = browser.complaints()
    check(not [c for c in complaints if "camera.jpg" not in c], f"Chromium has nothing to complain of {complaints}")
    web.end()
    until_text(browser, "#notice", "The connection to `rumi web` is lost")


def test_without_webgl(web):
    with Browser("--disable-3d-apis") as browser:
        web.say("live track map")
        browser.open(web.url)
        until_text(browser, "#no-webgl", "This browser has no WebGL 2")
        until_text(browser, "#submaps", "front 2")
        until_text(browser, "#state", "tracking")
    web.end()


def main():
    if missing():
        print(f"SKIPPED: {missing()} is missing, so the page of `rumi web` was NOT tested", file=sys.stderr)
        sys.exit(77)
    with Browser() as browser:
        web = FalseWeb()
        test_a_run(browser, web)
        test_the_drawing(browser)
        for width in (1280, 900, 500):
            check_layout(browser, width)
        test_changes(browser, web)
    test_without_webgl(FalseWeb())


main()
