# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/kills.sh measured: python3 kills_table.py BUILD_DIR OUT PROCESS ... ("none": without kills)
OUT/PROCESS.1, OUT/PROCESS.2, ... are its runs."""
import bisect
import csv
import json
import pathlib
import sqlite3
import statistics
import sys

import bus_log
from acknowledged import KINDS, Acknowledged

JOIN_LIMIT_S = 30
SUMS = ("kills", "images", "answers", "dropped", "in_map", "submaps_in_map", "submaps_heard", "updates", "unseen", "lost", "elements",
        "unsent")


class Timeline:
    """When what was said that tells how the system is."""

    def __init__(self):
        self.statuses = []  # (time, process, pid)
        self.maps = []      # (time, submaps in the map, frames in the map, submaps)
        self.placed_s = []  # a pose in the map
        self.utimes = set() # of the images that were answered
        self.dropped = {}   # images, by front_tracker's pid

    def take(self, time_s, channel, message):
        if channel == "RUMI_STATUS":
            self.statuses.append((time_s, message.process, message.pid))
            if message.process == "front_tracker":
                self.dropped[message.pid] = sum(c.dropped for c in message.channels if c.channel == "CAMERA")
        elif channel == "RUMI_MAP_STATUS":
            self.maps.append((time_s, message.submaps_in_map, message.frames_in_map,
                              message.front_submaps + message.back_submaps))
        elif channel == "CAMERA_TO_MAP":
            self.placed_s.append(time_s)
        elif channel == "RUMI_TRACK":
            self.utimes.add(message.utime)

    def back_s(self, process, pid, killed_s):
        """Until its successor says that it is there."""
        return next((t - killed_s for t, name, other in self.statuses
                     if t > killed_s and name == process and other != pid), None)

    def joined_s(self, process, pid, killed_s):
        """Until the camera's place in the map is known again, and the map is what it was: the later of the two."""
        back_s = self.back_s(process, pid, killed_s)
        placed = bisect.bisect(self.placed_s, killed_s + 0.05)
        if back_s is None or placed == len(self.placed_s):
            return None
        told_s = killed_s + (back_s if process == "map_server" else 0)
        before = max((m for m in self.maps if m[0] <= killed_s), default=(0, 0, 0, 0))
        whole = next((t for t, submaps, frames, _ in self.maps
                      if t > told_s and submaps >= before[1] and frames >= before[2]), None)
        return None if whole is None else max(self.placed_s[placed], whole) - killed_s


def frames_in_map(database, begin_us, end_us):
    db = sqlite3.connect(f"file:{database}?mode=ro", uri=True)
    return db.execute("SELECT count(DISTINCT utime) FROM frame_poses JOIN submaps USING (submap) "
                      "WHERE in_map AND utime BETWEEN ? AND ?", (begin_us, end_us)).fetchone()[0]


def measure(folder, process):
    timeline, acknowledged = Timeline(), Acknowledged()
    for event in bus_log.events(folder / "bus.log"):
        timeline.take(*event)
        acknowledged.take(*event)
    kills = [(float(t), int(pid)) for t, pid, _ in csv.reader(open(folder / "kills.csv"))]
    alive = [(t, pid) for t, pid in kills if pid]  # the others found nobody
    utimes = sorted(timeline.utimes)
    steps = [b - a for a, b in zip(utimes, utimes[1:])]
    median = statistics.median(steps)
    usual = statistics.mean(s for s in steps if s < 1.5 * median)
    code, end_s = (folder / "end.txt").read_text().split()
    stored = acknowledged.compare(folder / "map.db")
    return {
        "kills": len(alive), "back_s": [timeline.back_s(process, pid, t) for t, pid in alive],
        "joined_s": [timeline.joined_s(process, pid, t) for t, pid in alive],
        "images": round((utimes[-1] - utimes[0]) / usual) + 1, "answers": len(utimes), "dropped": sum(timeline.dropped.values()),
        "in_map": frames_in_map(folder / "map.db", utimes[0], utimes[-1]),
        "submaps_in_map": timeline.maps[-1][1], "submaps_heard": timeline.maps[-1][3],
        "updates": acknowledged.updates, "unseen": acknowledged.unseen, "stored": stored, "unsent": stored["unsent"],
        "elements": sum(stored[kind] for kind in KINDS),
        "lost": sum(stored[f"lost_{kind}"] for kind in KINDS) + stored["lost_submaps"] + stored["older"],
        "exit_code": int(code), "end_s": int(end_s),
    }


def together(process, runs):
    row = {key: sum(r[key] for r in runs) for key in SUMS}
    return {"process": process, **row, "back_s": sum((r["back_s"] for r in runs), []),
            "joined_s": sum((r["joined_s"] for r in runs), []), "exit_code": max(r["exit_code"] for r in runs),
            "end_s": max(r["end_s"] for r in runs), "runs": runs}


def spread(seconds):
    known = [s for s in seconds if s is not None]
    if not seconds:
        return "–"
    text = f"{statistics.median(known):.1f} / {max(known):.1f}" if known else "never"
    late = len(seconds) - sum(s <= JOIN_LIMIT_S for s in known)
    return text + (f", {late} not in {JOIN_LIMIT_S} s" if late else "")


def main():
    build, out, processes = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    bus_log.use_types(build)
    rows = []
    for process in processes:
        folders = sorted(out.glob(f"{process}.*/end.txt"))
        if folders:
            rows.append(together(process, [measure(end.parent, process) for end in folders]))
    (out / "kills.json").write_text(json.dumps(rows, indent=1) + "\n")

    def share(r):  # of the images that the machine had time for
        return r["in_map"] / (r["images"] - r["dropped"])

    base = next((share(r) for r in rows if r["process"] == "none"), None)
    print("| killed | kills | back s | joined again s | acknowledged updates, elements | of them lost | images | dropped | "
          "in the map | of those without kills | images that a kill costs | submaps in the map | end |")
    print("|---" * 13 + "|")
    failed = len(rows) < len(processes)
    for r in rows:
        failed |= r["lost"] > 0 or r["exit_code"] != 0 or r["unsent"] > 0
        part = f"{share(r) / base:.4f}" if base else "–"
        cost = f"{(base - share(r)) * r['images'] / r['kills']:.1f}" if base and r["kills"] else "–"
        print(f"| {r['process']} | {r['kills']} | {spread(r['back_s'])} | {spread(r['joined_s'])} | {r['updates']}, {r['elements']} | "
              f"{r['lost']} | {r['images']} | {r['dropped']} | {r['in_map']} | {part} | {cost} | "
              f"{r['submaps_in_map']} of {r['submaps_heard']} | code {r['exit_code']}, {r['end_s']} s |")
    print("\nMedian / worst. Dropped: images that front_tracker had no time for; the shares are of the others.")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
