# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/kills.sh measured: python3 kills_table.py BUILD_DIR OUT PROCESS ... ("none": without kills)"""
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


class Timeline:
    """When what was said that tells how the system is."""

    def __init__(self):
        self.statuses = []  # (time, process, pid)
        self.maps = []      # (time, submaps in the map, frames in the map)
        self.placed_s = []  # a pose in the map
        self.tracks = []    # (time, session, has a pose)

    def take(self, time_s, channel, message):
        if channel == "RUMI_STATUS":
            self.statuses.append((time_s, message.process, message.pid))
        elif channel == "RUMI_MAP_STATUS":
            self.maps.append((time_s, message.submaps_in_map, message.frames_in_map,
                              message.front_submaps + message.back_submaps))
        elif channel == "CAMERA_TO_MAP":
            self.placed_s.append(time_s)
        elif channel == "RUMI_TRACK":
            self.tracks.append((message.utime, message.session, message.submap_id != 0))

    def back_s(self, process, pid, killed_s):
        """Until its successor says that it is there."""
        return next((t - killed_s for t, name, other in self.statuses
                     if t > killed_s and name == process and other != pid), None)

    def joined_s(self, process, killed_s):
        """Until the camera's place in the map is known again, and the map is what it was: the later of the two."""
        started_s = killed_s + (self.back_s(process, 0, killed_s + 0.1) or 0) if process == "map_server" else killed_s
        placed = bisect.bisect(self.placed_s, killed_s + 0.05)
        before = max((m for m in self.maps if m[0] <= killed_s), default=(0, 0, 0, 0))
        whole = next((t for t, submaps, frames, _ in self.maps
                      if t > started_s and submaps >= before[1] and frames >= before[2]), None)
        if placed == len(self.placed_s) or whole is None:
            return None
        return max(self.placed_s[placed], whole) - killed_s


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
    alive = [(t, pid) for t, pid in kills if pid]
    utimes = sorted({t for t, _, _ in timeline.tracks})
    first, last = utimes[0], utimes[-1]
    steps = [b - a for a, b in zip(utimes, utimes[1:])]
    code, end_s = (folder / "end.txt").read_text().split()
    joined = [timeline.joined_s(process, t) for t, _ in alive]
    back = [timeline.back_s(process, pid, t) for t, pid in alive]
    last_map = timeline.maps[-1]
    return {
        "process": process, "kills": len(alive), "absent": len(kills) - len(alive),
        "back_s": back, "joined_s": joined,
        "images": round((last - first) / statistics.median(steps)) + 1, "answers": len(utimes),
        "in_map": frames_in_map(folder / "map.db", first, last),
        "submaps_in_map": last_map[1], "submaps": last_map[3],
        "updates": acknowledged.updates, "unseen": acknowledged.unseen,
        **acknowledged.compare(folder / "map.db"),
        "exit_code": int(code), "end_s": int(end_s), "run_s": (last - first) * 1e-6,
    }


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
    runs = [measure(out / process, process) for process in processes if (out / process / "end.txt").exists()]
    (out / "kills.json").write_text(json.dumps(runs, indent=1) + "\n")
    base = next((r["in_map"] / r["images"] for r in runs if r["process"] == "none"), None)
    print("| killed | kills | back s | joined again s | acknowledged updates, elements | of them lost | images | "
          "in the map | of those without kills | images lost by a kill | submaps in the map | end |")
    print("|---" * 12 + "|")
    failed = False
    for r in runs:
        elements = sum(r[kind] for kind in KINDS)
        lost = sum(r[f"lost_{kind}"] for kind in KINDS) + r["lost_submaps"] + r["older"]
        ratio = r["in_map"] / r["images"]
        part = f"{ratio / base:.4f}" if base else "–"
        cost = f"{(base * r['images'] - r['in_map']) / r['kills']:.1f}" if base and r["kills"] else "–"
        print(f"| {r['process']} | {r['kills']} | {spread(r['back_s'])} | {spread(r['joined_s'])} | {r['updates']}, {elements} | "
              f"{lost} | {r['images']} | {ratio:.4f} | {part} | {cost} | {r['submaps_in_map']} of {r['submaps']} | "
              f"code {r['exit_code']}, {r['end_s']} s |")
        failed |= lost > 0 or r["exit_code"] != 0 or r["unsent"] > 0
    return 1 if failed or len(runs) < len(processes) else 0


if __name__ == "__main__":
    sys.exit(main())
