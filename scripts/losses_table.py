# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/losses.sh measured: python3 losses_table.py BUILD_DIR OUT PERCENT ..."""
import json
import pathlib
import re
import sqlite3
import statistics
import sys

import bus_log
from acknowledged import KINDS, Acknowledged


def measure(folder, percent):
    acknowledged, last_track_s, transfers = Acknowledged(), 0, {}
    for time_s, channel, message in bus_log.events(folder / "bus.log"):
        acknowledged.take(time_s, channel, message)
        if channel == "RUMI_TRACK":
            last_track_s = time_s
        elif channel == "RUMI_SUBMAP":
            transfers.setdefault((message.sender, message.transfer_id), [time_s, None])
        elif channel == "RUMI_SUBMAP_ACK" and message.status == message.COMPLETE:
            times = transfers.get((message.sender, message.transfer_id))
            if times and times[1] is None:
                times[1] = time_s
    took = [end - begin for begin, end in transfers.values() if end is not None]
    db = sqlite3.connect(f"file:{folder / 'map.db'}?mode=ro", uri=True)
    in_map, = db.execute("SELECT count(DISTINCT utime) FROM frame_poses JOIN submaps USING (submap) WHERE in_map").fetchone()
    posed, = db.execute("SELECT count(DISTINCT utime) FROM frame_poses").fetchone()
    code, end_s = (folder / "end.txt").read_text().split()
    log = (folder / "up.log").read_text(errors="replace")
    published = re.search(r"camera_driver\| .* (\d+) of \d+ images.*: the end", log)
    received = json.loads((folder / "run/run.json").read_text())["images"] if (folder / "run/run.json").exists() else 0
    return {"loss": percent, "by": (folder / "by.txt").read_text().strip(),
            "published": int(published.group(1)) if published else 0, "received": received,
            "posed": posed, "in_map": in_map, "took_s": took, "stored_after_s": (acknowledged.last_ack_s or 0) - last_track_s,
            "updates": acknowledged.updates, **acknowledged.compare(folder / "map.db"),
            "exit_code": int(code), "end_s": int(end_s)}


def main():
    build, out = sys.argv[1], pathlib.Path(sys.argv[2])
    bus_log.use_types(build)
    runs = [measure(out / percent, percent) for percent in sys.argv[3:] if (out / percent / "end.txt").exists()]
    (out / "losses.json").write_text(json.dumps(runs, indent=1) + "\n")
    print("| lost % | images published, received | with a pose, of them in the map | acknowledged updates, elements | of them not in "
          "map.db | submaps that lack what was sent last | update to acknowledged s | end s after the last image | exit code |")
    print("|---" * 9 + "|")
    failed = len(runs) < len(sys.argv) - 3
    for r in runs:
        lost = sum(r[f"lost_{kind}"] for kind in KINDS) + r["lost_submaps"] + r["older"]
        failed |= lost > 0 or r["unsent"] > 0 or r["open"] > 0 or r["exit_code"] != 0
        print(f"| {r['loss']} | {r['published']}, {r['received']} | {r['posed']}, {r['in_map']} | {r['updates']}, "
              f"{sum(r[kind] for kind in KINDS)} | {lost} | {r['unsent']} of {r['submaps']} | "
              f"{statistics.median(r['took_s']):.2f} / {max(r['took_s']):.1f} | {r['end_s']} | {r['exit_code']} |")
    print(f"\nMedian / worst. Lost by {', '.join(sorted({r['by'] for r in runs}))}.")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
