#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""web_load.py BUILD [SECONDS]: CPU time of `rumi web` and what it sends to a page, with a map of 100,000 landmarks, 1,000
keyframes and 10,000 frames in 50 submaps, beside a system that is played: images of 640 x 480 and tracking at 30 Hz.

Run it as: tests/run_in_netns.sh scripts/web_load.py build"""
import http.client
import json
import os
import re
import subprocess
import sys
import threading
import time

BUILD, SECONDS = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 60
MAP = ("50", "2000", "20")


class Page(threading.Thread):
    """Asks for what the page's scripts ask for."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.port, self.versions, self.landmarks = port, {}, {}
        self.bytes = {"events": 0, "images": 0, "submaps": 0}
        self.counts = dict(self.bytes)
        self.rest = http.client.HTTPConnection("127.0.0.1", port)

    def get(self, kind, path):
        self.rest.request("GET", path)
        answer = self.rest.getresponse().read()
        self.note(kind, len(answer))
        return answer

    def note(self, kind, size):
        self.bytes[kind] += size
        self.counts[kind] += 1

    def run(self):
        try:
            self.listen()
        except (OSError, http.client.HTTPException):
            pass  # `rumi web` was ended

    def listen(self):
        events = http.client.HTTPConnection("127.0.0.1", self.port)
        events.request("GET", "/events")
        name = ""
        for line in events.getresponse():
            if line.startswith(b"event: "):
                name = line[7:].strip().decode()
            elif line.startswith(b"data: "):
                self.note("events", len(line))
                if name == "image":
                    self.get("images", "/camera.jpg")
                elif name == "map":
                    self.fetch(json.loads(line[6:]).get("submaps", []))

    def fetch(self, submaps):
        for submap in submaps:
            if self.versions.get(submap["name"]) != submap["version"]:
                self.versions[submap["name"]] = submap["version"]
                blob = self.get("submaps", f"/submap/{submap['name']}")
                self.landmarks[submap["name"]] = int.from_bytes(blob[12:16], "little")


def cpu_s(pid):
    with open(f"/proc/{pid}/stat") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(pid):
    with open(f"/proc/{pid}/status") as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1]) / 1000


def measure(what, pid, page=None):
    before, start = cpu_s(pid), time.monotonic()
    sent = (dict(page.bytes), dict(page.counts)) if page else None
    time.sleep(SECONDS)
    line = f"{what}: {100 * (cpu_s(pid) - before) / (time.monotonic() - start):.1f} % of a core, {memory_mb(pid):.0f} MB"
    if page:
        line += "; a second: " + ", ".join(
            f"{(page.counts[k] - sent[1][k]) / SECONDS:.1f} {k} ({(page.bytes[k] - sent[0][k]) / SECONDS / 1000:.1f} kB)" for k in page.bytes)
    print(line, flush=True)


def run(what, *flags):
    system = subprocess.Popen([f"{BUILD}/tests/false_lcm", *MAP, *flags])
    web = subprocess.Popen([f"{BUILD}/bin/rumi", "web", "--port", "0"], stdout=subprocess.PIPE, text=True)
    try:
        port = int(re.search(r":(\d+) ", web.stdout.readline())[1])
        if not flags:
            time.sleep(3)
            measure("nobody looks", web.pid)
        page, before, start = Page(port), cpu_s(web.pid), time.monotonic()
        page.start()
        while sum(page.landmarks.values()) < int(MAP[0]) * int(MAP[1]):
            time.sleep(0.1)
        if not flags:
            print(f"until the page has all of it: {time.monotonic() - start:.1f} s, {cpu_s(web.pid) - before:.2f} s of CPU, "
                  f"{page.bytes['submaps'] / 1e6:.1f} MB")
        time.sleep(3)
        measure(what, web.pid, page)
    finally:
        for process in (web, system):
            process.terminate()
            process.wait()


run("a page, the map at rest")
run("a page, a submap grows each second", "--grow")
