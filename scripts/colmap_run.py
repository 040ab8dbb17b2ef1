# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP's own run on a recording, as an output folder that `rumi evaluate` reads.

python3 colmap_run.py RECORDING OUT sequential|exhaustive [--names EXTRACTION MATCHING] [--limit-s S] [--features DIR]

Writes frames.csv, trajectory.txt (of the largest model) and colmap.json (CPU seconds of all programs, and what went
wrong). RECORDING: a folder with rgb.txt and calibration.yaml, whose camera is held fixed. One thread and one seed, so
that it can be repeated. --names: of COLMAP's options, by colmap_names.sh. --features: where the features are kept, which
other runs on the same images need not extract again; their CPU time counts in each."""
import argparse
import json
import pathlib
import re
import resource
import shutil
import struct
import subprocess
import sys

KEYPOINTS = 8192
OVERLAP = 10
PIXEL_SHIFT = .5  # COLMAP's upper-left pixel has its centre at (0.5, 0.5)


class OverLimit(Exception):
    pass


class Colmap:
    """Runs COLMAP's programs, one after the other, within one limit of CPU time."""

    def __init__(self, limit_s):
        self.limit_s, self.cpu_s = limit_s, 0.0
        self.before_s = 0.0  # CPU time of earlier processes that counts as ours

    def run(self, *arguments):
        def limit():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            left = max(1, int(self.limit_s - self.cpu_s))
            resource.setrlimit(resource.RLIMIT_CPU, (left, left + 5))

        print(" ".join(map(str, ("colmap", *arguments))), flush=True)
        code = subprocess.run(["colmap", *map(str, arguments)], preexec_fn=limit).returncode
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.cpu_s = self.before_s + usage.ru_utime + usage.ru_stime
        if self.cpu_s >= self.limit_s - 1:
            raise OverLimit
        return code == 0


def camera_of(text):
    """The calibration as COLMAP's model and its parameters."""
    values = {key: value for key, value in re.findall(r"^(\w+):\s*(\S+)", text, re.M)}
    if values.get("model") != "pinhole":
        sys.exit(f"calibration.yaml: model is {values.get('model')}: only pinhole is known here")
    fx, fy, cx, cy, *distortion = (float(values.get(key, 0)) for key in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"))
    pinhole = [fx, fy, cx + PIXEL_SHIFT, cy + PIXEL_SHIFT]
    if not any(distortion):
        return "PINHOLE", pinhole
    if distortion[4] == 0:
        return "OPENCV", pinhole + distortion[:4]
    return "FULL_OPENCV", pinhole + distortion + [0.0, 0.0, 0.0]


def images_of(recording):
    """(time, name) of each."""
    lines = (recording / "rgb.txt").read_text().splitlines()
    return [tuple(line.split()[:2]) for line in lines if line.strip() and not line.startswith("#")]


def cameras_centre(q, t):
    """q: w x y z. -R(q)^T t."""
    w, x, y, z = q[0], -q[1], -q[2], -q[3]
    # v' = v + 2 w (u x v) + 2 u x (u x v)
    a = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]]
    b = [y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0]]
    return [-(v + 2 * w * d + 2 * e) for v, d, e in zip(t, a, b)]


def trajectory(images_txt, times):
    """TUM's lines of a model's images.txt. times: by name."""
    # After the comments each image has two lines, of which the second may be empty.
    lines = [line for line in images_txt.splitlines() if not line.startswith("#")][::2]
    poses = []
    for line in lines:
        fields = line.split(maxsplit=9)
        q, t = [float(v) for v in fields[1:5]], [float(v) for v in fields[5:8]]
        numbers = [*cameras_centre(q, t), -q[1], -q[2], -q[3], q[0]]
        poses.append(f"{times[fields[9]]} " + " ".join(f"{v:.9f}" for v in numbers))
    return "".join(pose + "\n" for pose in sorted(poses, key=lambda pose: float(pose.split()[0])))


def images_in(model):
    with open(model / "images.bin", "rb") as file:
        return struct.unpack("<Q", file.read(8))[0]


def extract(colmap, recording, features, extraction):
    if (features / "cpu_s").exists():
        colmap.before_s = colmap.cpu_s = float((features / "cpu_s").read_text())
        return
    shutil.rmtree(features, ignore_errors=True)
    features.mkdir(parents=True)
    (features / "images.txt").write_text("".join(f"{name}\n" for _, name in images_of(recording)))
    model, parameters = camera_of((recording / "calibration.yaml").read_text())
    done = colmap.run("feature_extractor", "--database_path", features / "features.db", "--image_path", recording,
                      "--image_list_path", features / "images.txt", "--ImageReader.single_camera", 1,
                      "--ImageReader.camera_model", model, "--ImageReader.camera_params", ",".join(map(repr, parameters)),
                      f"--{extraction}.use_gpu", 0, f"--{extraction}.num_threads", 1,
                      "--SiftExtraction.max_num_features", KEYPOINTS)
    if not done:
        sys.exit("colmap feature_extractor failed")
    (features / "cpu_s").write_text(f"{colmap.cpu_s}\n")


def match(colmap, database, matcher, matching):
    options = ["--database_path", database, f"--{matching}.use_gpu", 0, f"--{matching}.num_threads", 1]
    if matcher == "sequential":
        options += ["--SequentialMatching.overlap", OVERLAP, "--SequentialMatching.quadratic_overlap", 1]
    if not colmap.run(f"{matcher}_matcher", *options):
        sys.exit(f"colmap {matcher}_matcher failed")


def map_images(colmap, recording, database, work):
    """The folder of the largest model as text. None if there is none."""
    models = work / "models"
    models.mkdir()
    colmap.run("mapper", "--database_path", database, "--image_path", recording, "--output_path", models,
               "--Mapper.ba_refine_focal_length", 0, "--Mapper.ba_refine_principal_point", 0,
               "--Mapper.ba_refine_extra_params", 0, "--Mapper.num_threads", 1)
    found = sorted(models.iterdir(), key=images_in)
    if not found:
        return None
    text = work / "largest"
    text.mkdir()
    colmap.run("model_converter", "--input_path", found[-1], "--output_path", text, "--output_type", "TXT")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("matcher", choices=["sequential", "exhaustive"])
    parser.add_argument("--names", nargs=2, default=["SiftExtraction", "SiftMatching"])
    parser.add_argument("--limit-s", type=float, default=900, help="CPU seconds of all programs")
    parser.add_argument("--features", type=pathlib.Path)
    a = parser.parse_args()
    a.out.mkdir(parents=True)
    features = a.features or a.out / "features"
    colmap = Colmap(a.limit_s)
    said = poses = ""
    try:
        extract(colmap, a.recording, features, a.names[0])
        database = a.out / "database.db"
        shutil.copy(features / "features.db", database)
        match(colmap, database, a.matcher, a.names[1])
        model = map_images(colmap, a.recording, database, a.out)
        images = images_of(a.recording)
        if model:
            poses = trajectory((model / "images.txt").read_text(), {name: time for time, name in images})
        else:
            said = "no model"
    except OverLimit:
        said = f"more than {a.limit_s:g} CPU s"
    in_map = {line.split()[0] for line in poses.splitlines()}
    rows = [f"{round(float(time) * 1e6)},{'TRACKING' if time in in_map else 'LOST'},{int(time in in_map)},{int(time in in_map)}\n"
            for time, _ in images_of(a.recording)]
    (a.out / "frames.csv").write_text("utime,state,submap,in_map\n" + "".join(rows))
    (a.out / "trajectory.txt").write_text(poses)
    (a.out / "colmap.json").write_text(json.dumps({"cpu_s": colmap.cpu_s, "said": said}) + "\n")


if __name__ == "__main__":
    main()
