# SPDX-License-Identifier: BSD-3-Clause
"""Settings and table of scripts/ablation.sh: ablation.py settings RUMI [OPTION...] | ablation.py table OUT SETTING..."""
import pathlib
import re
import subprocess
import sys

from recordings_table import cell, read_runs
from rendered_runs import write_table

# The guards of beginning, tracking, rumination and merging.
OPTIONS = """
front_tracker.init_min_matches front_tracker.uncertain_px front_tracker.max_scale_drift
front_tracker.reloc_min_inliers front_tracker.max_log_baseline front_tracker.max_log_distance
ruminator.resection_min_inliers ruminator.max_error_px ruminator.min_parallax_deg ruminator.scale_max_change
ruminator.tear_max_severed ruminator.min_parallax_px ruminator.max_rmse_px ruminator.max_pair_rotation_deg
ruminator.max_rival_position_ratio
map_server.max_joint_chi2 map_server.min_landmarks map_server.max_reprojection_px map_server.min_inlier_ratio
map_server.max_sigma_log_scale
""".split()

COLUMNS = ["option", "value", "recordings", "changed", "failed", "in the map", "when they came", "ATE ratio", "CPU ratio"]


def read_options(yaml):
    """What `rumi config` prints: key -> (default, least, greatest, help). Numbers only."""
    options, section = {}, None
    for line in yaml.splitlines():
        if head := re.match(r"(\w+):$", line):
            section = head[1]
        elif entry := re.match(r"  (\w+): (-?[\d.]+(?:e[+-]?\d+)?) +# (.*?)\(([^ ()]+) \.\. ([^ ()]+)\)$", line):
            name, default, text, least, greatest = entry.groups()
            options[f"{section}.{name}"] = (float(default), float(least), float(greatest), text)
    return options


def off_value(key, option):
    """The value that makes the guard say nothing, if there is one."""
    _, least, greatest, text = option
    if re.search(r"\b0: (never|none|no\b)", text):
        return 0.0
    words = key.split(".")[1].split("_")
    if "max" in words or key == "front_tracker.uncertain_px":
        return greatest
    return least if "min" in words else None


def values_of(key, option, accepts):
    """Halved, doubled, off: those that are in the range and not the default. accepts(setting): does rumi take it?"""
    default, least, greatest, _ = option
    may_be_whole = default.is_integer() and least.is_integer() and greatest.is_integer()
    texts = []
    for value in (default / 2, default * 2, off_value(key, option)):
        if value is None:
            continue
        value = min(max(value, least), greatest)
        text = f"{value:.6g}"
        if not value.is_integer() and may_be_whole and not accepts(f"{key}={text}"):
            text = f"{int(value + 0.5)}"
        if float(text) != default and text not in texts:
            texts.append(text)
    return texts


def settings(rumi, keys):
    options = {}
    for flags in ([], ["--expert"]):
        options |= read_options(subprocess.run([rumi, "config", *flags], check=True, capture_output=True, text=True).stdout)

    def accepts(setting):
        return subprocess.run([rumi, "config", "--set", setting], capture_output=True).returncode == 0

    for key in keys or OPTIONS:
        if key not in options:
            sys.exit(f"{key}: no option that is a number; `{rumi} config` and `{rumi} config --expert` list them")
        for text in values_of(key, options[key], accepts):
            print(f"{key}={text}")


def poses(folder, run):
    files = [folder / run["recording"] / str(run["seed"]) / "run" / name for name in ("trajectory.txt", "frames.csv")]
    return [f.read_bytes() if f.exists() else b"" for f in files]


def table_row(setting, before, after):
    """before, after: (folder, runs) of the defaults and of the setting."""
    of_default = {(r["recording"], r["seed"]): r for r in before[1]}
    pairs = [(of_default[key], r) for r in after[1] if (key := (r["recording"], r["seed"])) in of_default]
    measured = {f.parts[-3:-1] for f in after[0].glob("*/*/log")}
    failed = len(measured & {(name, str(seed)) for name, seed in of_default}) - len(pairs)
    changed = {b["recording"] for b, a in pairs if poses(before[0], b) != poses(after[0], a)}

    def change(key):
        return cell([a[key] - b[key] for b, a in pairs], min, 3)

    def ratio(key):
        return cell([a[key] / b[key] for b, a in pairs if a[key] is not None and b[key]], max, 2)

    option, value = setting.split("=")
    return [option, value, str(len({b["recording"] for b, _ in pairs})), str(len(changed)), str(failed), change("in_map"),
            change("live"), ratio("ate_percent"), ratio("cpu_ms")]


def table(out, names):
    before = (out / "defaults", read_runs(out / "defaults"))
    if not before[1]:
        sys.exit(f"{out}: nothing measured with the defaults")
    rows = [table_row(name, before, (out / name, read_runs(out / name))) for name in names]
    write_table(out / "ablation.csv", COLUMNS, rows)


if __name__ == "__main__":
    if sys.argv[1] == "settings":
        settings(sys.argv[2], sys.argv[3:])
    else:
        table(pathlib.Path(sys.argv[2]), sys.argv[3:])
