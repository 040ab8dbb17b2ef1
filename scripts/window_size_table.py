# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/window_size_table.sh measured: python3 window_size_table.py OUT GROUNDTRUTH COLMAP_LIMIT_S"""
import csv
import json
import math
import pathlib
import sys

MAX_TIME_DIFFERENCE_S = 0.02


def read_truth(path):
    rows = [line.split() for line in pathlib.Path(path).read_text().splitlines() if line and line[0] != "#"]
    return [(float(r[0]), [float(x) for x in r[1:4]]) for r in rows]


def camera_centre(qw, qx, qy, qz, *t):
    """-R^T t of COLMAP's cam_from_world."""
    rotation = [
        [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)],
        [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)],
        [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)],
    ]
    return [-sum(rotation[k][i] * t[k] for k in range(3)) for i in range(3)]


def read_model(folder):
    """Time and camera centre of each image; the images are called by their time."""
    lines = [line for line in (folder / "images.txt").read_text().split("\n") if not line.startswith("#")]
    poses = [line.split() for line in lines[0::2] if line]
    return [(float(p[9].rsplit(".", 1)[0]), camera_centre(*map(float, p[1:8]))) for p in poses]


def largest_eigenvalue(matrix):
    """Of a symmetric 4 x 4 matrix, by Jacobi's rotations."""
    a = [row[:] for row in matrix]
    for _ in range(100):
        size, p, q = max((abs(a[i][j]), i, j) for i in range(4) for j in range(i + 1, 4))
        if size < 1e-14 * max(abs(a[i][i]) for i in range(4)):
            break
        angle = 0.5 * math.atan2(2 * a[p][q], a[q][q] - a[p][p])
        c, s = math.cos(angle), math.sin(angle)
        for k in range(4):
            a[k][p], a[k][q] = c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]
        for k in range(4):
            a[p][k], a[q][k] = c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]
    return max(a[i][i] for i in range(4))


def centred(points):
    mean = [sum(p[i] for p in points) / len(points) for i in range(3)]
    return [[p[i] - mean[i] for i in range(3)] for p in points]


def ate(source, target):
    """RMS distance after the best Sim(3) alignment (Horn 1987), without computing the alignment itself."""
    a, b = centred(source), centred(target)
    m = [[sum(p[i] * q[j] for p, q in zip(a, b)) for j in range(3)] for i in range(3)]
    n = [
        [m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]],
        [m[1][2] - m[2][1], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]],
        [m[2][0] - m[0][2], m[0][1] + m[1][0], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]],
        [m[0][1] - m[1][0], m[2][0] + m[0][2], m[1][2] + m[2][1], m[2][2] - m[0][0] - m[1][1]],
    ]
    spread_a = sum(x * x for p in a for x in p)
    spread_b = sum(x * x for p in b for x in p)
    residual = spread_b - max(largest_eigenvalue(n), 0.0) ** 2 / spread_a
    return math.sqrt(max(residual, 0.0) / len(a))


def model_error(model, truth):
    pairs = []
    for time, centre in model:
        nearest = min(truth, key=lambda t: abs(t[0] - time))
        if abs(nearest[0] - time) <= MAX_TIME_DIFFERENCE_S:
            pairs.append((centre, nearest[1]))
    return ate([p[0] for p in pairs], [p[1] for p in pairs]) if len(pairs) >= 3 else None


def resources(path):
    rows = [[float(x) for x in line.split()] for line in path.read_text().splitlines() if line[:1].isdigit()]
    return {"wall_s": sum(r[0] for r in rows), "cpu_s": sum(r[1] + r[2] for r in rows),
            "peak_mb": max((r[3] for r in rows), default=0) * 1024 / 1e6}


def ours(folder):
    row = json.loads((folder / "ours.json").read_text())
    return {"registered": row["registered_gap"] if row["built"] else 0, "ate_m": row["ate_m"], "path_m": row["path_m"],
            "note": row["failure"] or row["warning"], **resources(folder / "ours.time")}


def colmap(folder, truth):
    if not (folder / "colmap.done").exists():
        return None
    models = [read_model(f.parent) for f in folder.glob("models/*/images.txt")]
    best = max(models, key=len, default=[])
    stopped = (folder / "stopped").exists()
    notes = ["stopped"] if stopped else []
    if len(models) > 1:
        notes.append(f"{len(models)} models")
    return {"registered": len(best), "ate_m": model_error(best, truth) if best else None, "note": ", ".join(notes),
            "stopped": stopped, **resources(folder / "colmap.time")}


def cells(r, limit):
    if r is None:
        return ["-"] * 5
    error = "-" if r["ate_m"] is None else f"{100 * r['ate_m']:.2f}"
    time = f"> {limit}" if r.get("stopped") else f"{r['cpu_s']:.1f}"
    return ["-" if r.get("stopped") and not r["registered"] else str(r["registered"]), error, time,
            f"{r['wall_s']:.1f}", f"{r['peak_mb']:.0f}"]


def main():
    out, truth, limit = pathlib.Path(sys.argv[1]), read_truth(sys.argv[2]), sys.argv[3]
    names = ["registered", "ATE cm", "CPU s", "wall s", "peak MB"]
    header = ["frames", "path m"] + names + ["COLMAP: " + n for n in names] + ["notes"]
    rows = []
    for folder in sorted((f.parent for f in out.glob("*/ours.json")), key=lambda f: int(f.name)):
        mine, theirs = ours(folder), colmap(folder, truth)
        notes = [n for n in (mine["note"], theirs and theirs["note"] and "COLMAP: " + theirs["note"]) if n]
        rows.append([folder.name, f"{mine['path_m']:.2f}"] + cells(mine, limit) + cells(theirs, limit) +
                    ["; ".join(notes)])
    with open(out / "table.csv", "w", newline="") as file:
        csv.writer(file).writerows([header] + rows)
    print("| " + " | ".join(header) + " |\n|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
