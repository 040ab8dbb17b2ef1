# SPDX-License-Identifier: BSD-3-Clause
"""Another recording out of one: backwards, with every Nth image alone, or to and fro so many times, its truth with it.

python3 derived_recording.py RECORDING OUT [--backwards] [--every N] [--passes N]

What was set on recordings that go one way and are dense is tried on those that nothing was set on. RECORDING: a folder
with rgb.txt; the images are linked, not copied."""
import argparse
import pathlib
import sys


def read_rows(path):
    lines = path.read_text().splitlines()
    return [line.split() for line in lines if line.strip() and not line.startswith("#")]


def derive(source, out, backwards, every, passes):
    images = read_rows(source / "rgb.txt")
    if not images:
        sys.exit(f"{source / 'rgb.txt'}: no images")
    begin, end = float(images[0][0]), float(images[-1][0])

    # As long as a frame between two passes, lest the last image of one and the first of the next have one time.
    length = (end - begin) * len(images) / max(1, len(images) - 1)

    def write(name, rows):
        timed = []
        for i in range(passes):
            turned = backwards != (i % 2 == 1)
            timed += [((begin + end - float(t) if turned else float(t)) + i * length, rest) for t, *rest in rows]
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
    parser.add_argument("--passes", type=int, default=1, help="every second one is turned round")
    a = parser.parse_args()
    if a.every < 1:
        sys.exit(f"--every is {a.every}: 1 or more")
    if a.passes < 1:
        sys.exit(f"--passes is {a.passes}: 1 or more")
    derive(a.recording, a.out, a.backwards, a.every, a.passes)


if __name__ == "__main__":
    main()
