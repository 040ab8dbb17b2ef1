# SPDX-License-Identifier: BSD-3-Clause
"""Chromium without a display, by the WebDriver protocol and Python's standard library alone."""
import base64
import json
import shutil
import struct
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
import zlib

PATIENCE_S = 60
CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
KEYS = {"left": "\ue012", "up": "\ue013"}


def missing():
    """What is not installed, or an empty string."""
    if not shutil.which("chromedriver"):
        return "chromedriver (Debian: chromium-driver)"
    return "" if any(map(shutil.which, CHROMIUM)) else "chromium"


def eventually(condition, what):
    """Waits until it returns something true, and returns that."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"this never happened: {what}")


class Browser:
    def __init__(self, *more_flags):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, text=True)
        for line in self.driver.stdout:
            if "on port" in line and "started" in line:
                self.url = "http://127.0.0.1:" + line.strip(". \n").split()[-1]
                break
        flags = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--use-angle=swiftshader",
                 "--enable-unsafe-swiftshader", "--force-device-scale-factor=1", f"--user-data-dir={self.profile.name}"]
        options = {"binary": next(filter(None, map(shutil.which, CHROMIUM))), "args": flags + list(more_flags)}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        self.session = ""
        made = self.call("POST", "", {"capabilities": {"alwaysMatch": wanted}})
        self.session = f"/{made['sessionId']}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.profile.cleanup()

    def call(self, method, path, body=None):
        data = json.dumps(body or {}).encode() if method == "POST" else None
        request = urllib.request.Request(f"{self.url}/session{self.session}{path}", data, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()) from error

    def open(self, url):
        self.call("POST", "/url", {"url": url})

    def resize(self, width, height):
        """What the page has of the window."""
        frame = self.run("return [outerWidth - innerWidth, outerHeight - innerHeight]")
        self.call("POST", "/window/rect", {"width": width + frame[0], "height": height + frame[1]})
        eventually(lambda: self.run("return innerWidth") == width, f"the window is {width} pixels wide")

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def element(self, css):
        return next(iter(self.call("POST", "/element", {"using": "css selector", "value": css}).values()))

    def text(self, css):
        return self.run("return document.querySelector(arguments[0]).innerText", css)

    def press(self, css, key):
        self.call("POST", f"/element/{self.element(css)}/value", {"text": KEYS.get(key, key)})

    def click(self, css):
        self.call("POST", f"/element/{self.element(css)}/click")

    def complaints(self):
        return [entry["message"] for entry in self.call("POST", "/se/log", {"type": "browser"})]

    def screenshot(self, css=None):
        """PNG of the page, or of an element."""
        return base64.b64decode(self.call("GET", f"/element/{self.element(css)}/screenshot" if css else "/screenshot"))


def pixels(png):
    """A list of rows of (r, g, b) of an 8-bit PNG."""
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at : at + 8])
        chunk = png[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, _, depth, colour = struct.unpack(">IIBB", chunk[:10])
            step = {2: 3, 6: 4}[colour]
            assert depth == 8
        data += chunk if kind == b"IDAT" else b""
        at += size + 12
    raw, rows, above = zlib.decompress(data), [], bytearray(width * step)
    for start in range(0, len(raw), width * step + 1):
        row = unfiltered(raw[start], bytearray(raw[start + 1 : start + 1 + width * step]), above, step)
        rows.append([tuple(row[i : i + 3]) for i in range(0, len(row), step)])
        above = row
    return rows


def unfiltered(kind, row, above, step):
    for i, value in enumerate(row):
        left, up = (row[i - step] if i >= step else 0), above[i]
        corner = above[i - step] if i >= step else 0
        if kind == 4:
            ahead = left + up - corner
            guess = min((abs(ahead - left), 0, left), (abs(ahead - up), 1, up), (abs(ahead - corner), 2, corner))[2]
        else:
            guess = (0, left, up, (left + up) // 2)[kind]
        row[i] = (value + guess) & 255
    return row


def count(rows, colour, tolerance=12):
    return sum(all(abs(a - b) <= tolerance for a, b in zip(pixel, colour)) for row in rows for pixel in row)
