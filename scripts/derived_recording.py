# SPDX-License-Identifier: BSD-3-Clause
"""Another recording out of one: backwards, or with every Nth image alone, its truth with it.

python3 derived_recording.py RECORDING OUT [--backwards] [--every N]

What was set on recordings that go one way and are dense is tried on those that nothing was set on. RECORDING: a folder
with rgb.txt; the images are linked, not copied."""
import argparse
import pathlib
import sys


def read_rows(path):
    lines = path.read_text().splitlines()
    return [line.split() for line in lines if line.strip() and not line.startswith("#")]


def derive(source, out, backwards, every):
    images = read_rows(source / "rgb.txt")
    if not images:
        sys.exit(f"{source / 'rgb.txt'}: no images")
    begin, end = float(images[0][0]), float(images[-1][0])

    def write(name, rows):
        timed = [(begin + end - float(t) if backwards else float(t), rest) for t, *rest in rows]
        text = "".join(f"{t:.6f} {' '.join(rest)}\n" for t, rest in sorted(timed))
        (out / name).write_text(text)

    out.mkdir(parents=True, exist_ok=True)
    write("rgb.txt", images[::every])
    for path in source.iterdir():
        if path.name in ("groundtruth.txt", "colmap.txt"):
            write(path.name, read_rows(path))
        elif path.name != "rgb.txt" and not (out / path.name).exists():
            (out / path.name).symlink_to(path.resolve())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--backwards", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    a = parser.parse_args()
    if a.every < 1:
        sys.exit(f"--every is {a.every}: 1 or more")
    derive(a.recording, a.out, a.backwards, a.every)


if __name__ == "__main__":
    main()
