#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""web_command_test.py RUMI: `rumi web` as a user starts and ends it. In a network namespace of its own."""
import http.client
import re
import signal
import subprocess
import sys


def start(*flags):
    process = subprocess.Popen([sys.argv[1], "web", *flags], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    said = process.stdout.readline()
    assert re.match(r"http://127\.0\.0\.1:\d+ shows the system on this bus; Ctrl-C ends it$", said), said
    return process, int(re.search(r":(\d+) ", said)[1])


def ask(port, method, path, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    return answer, answer.read()


def fails(code, words, *flags):
    done = subprocess.run([sys.argv[1], "web", *flags], capture_output=True, text=True, timeout=60)
    assert done.returncode == code and words in done.stderr, (done.returncode, done.stderr)


def first_event(port):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("GET", "/events")
    answer = connection.getresponse()
    assert answer.getheader("Content-Type") == "text/event-stream"
    lines = [answer.readline() for _ in range(2)]
    connection.close()
    return lines


process, port = start("--port", "0", "--channel-prefix", "kitchen.", "-c", "LEFT")
for path in ("/", "/main.js", "/style.css"):
    answer, body = ask(port, "GET", path)
    assert answer.status == 200 and len(body) > 100, path
assert ask(port, "POST", "/")[0].status == 405
assert ask(port, "GET", "/nothing")[0].status == 404
assert ask(port, "GET", "/", Host="evil.example")[0].status == 403
assert first_event(port)[0].startswith(b"event: "), first_event(port)
fails(1, f"rumi web: port {port} is in use: another `rumi web` perhaps; choose another one with --port", "--port", str(port))
fails(2, "--port is 70000: must be 1 to 65535", "--port", "70000")
fails(2, "--no-such", "--no-such")
for how in (signal.SIGINT, signal.SIGTERM):
    process.send_signal(how)
    assert process.wait(timeout=60) == 0, "it does not end cleanly"
    assert process.stderr.read() == ""
    process, _ = start("--port", str(port))  # free again at once
process.kill()
