#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The shape of the sources, counted from the sources alone: files, functions, classes, circles of folders, ways to say
that something failed, tests, comments. Functions and classes need Universal Ctags (Debian: universal-ctags).
    python3 scripts/house.py [--folder FOLDER] [--json]
FOLDER, such as map_server or rumi/web, counts that folder alone."""
import argparse
import collections
import json
import pathlib
import re
import shutil
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPONENTS = ["slam", "base", "bus", "formats", "synth", "camera_driver", "front_tracker", "ruminator", "map_server",
              "viewer_offscreen", "rumi"]
LONG_FUNCTION = 40  # lines
MANY_PARAMETERS = 7
SMALL_FILE = 30  # lines
LARGEST_CLASSES = 10

INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)
TEST = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\(", re.M)
COMMENT_LINE = re.compile(r"^\s*//|\S\s+// ")
# How the headers say that something may fail. A string or an optional is often no failure: look at each.
WAYS_TO_FAIL = {
    "returns std::string": re.compile(r"^\s*(?:static |virtual )*std::string \w+\(", re.M),
    "member error, failure or problem": re.compile(r"^\s*std::string (?:[^;(]*, )?(?:error|failure|problem)\b[^;(]*;", re.M),
    "std::string* error": re.compile(r"std::string\* ?(?:error|failure|problem|why)\b"),
    "returns optional": re.compile(r"^\s*(?:static |virtual )*std::optional<[^;]*> \w+\(", re.M),
    "Throws in a comment": re.compile(r"//.*\bthrows?\b", re.I),
    "returns Result": re.compile(r"^\s*(?:\[\[nodiscard\]\] |static |virtual )*Result<.*> \w+\(", re.M),
    "[[nodiscard]]": re.compile(r"\[\[nodiscard\]\]"),
}


class File:
    def __init__(self, path):
        self.path = path
        self.text = path.read_text()
        self.lines = self.text.count("\n")
        self.name = str(path.relative_to(ROOT))
        self.folder = str(path.parent.relative_to(ROOT))


def read_files(folders):
    return [File(p) for folder in folders for p in sorted((ROOT / folder).rglob("*")) if p.suffix in (".h", ".cpp")]


def circles(files):
    """Sets of folders of which each includes from all others, by way of others or not."""
    folders = {file.name: file.folder for file in files}
    uses = collections.defaultdict(set)
    for file in files:
        uses[file.folder] |= {folders[i] for i in INCLUDE.findall(file.text) if i in folders} - {file.folder}
    return components(uses)


def components(uses):
    """Strongly connected components of more than one node (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(uses[node]):
            if other not in index:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            cut = stack.index(node)
            if len(stack) - cut > 1:
                found.append(sorted(stack[cut:]))
            del stack[cut:]

    for node in sorted(uses):
        if node not in index:
            visit(node)
    return found


def read_tags(files):
    """What Universal Ctags finds, or None without it."""
    if not shutil.which("ctags") or "json" not in subprocess.run(["ctags", "--list-features"], capture_output=True,
                                                                 text=True).stdout:
        return None
    done = subprocess.run(["ctags", "--languages=C++", "--langmap=C++:+.h", "--kinds-C++=cfmps", "--fields=+neSK",
                           "--output-format=json", "-o", "-", "-L", "-"], cwd=ROOT, text=True, capture_output=True,
                          input="\n".join(file.name for file in files))
    return [json.loads(line) for line in done.stdout.splitlines()]


def parameters(signature):
    """How many a signature such as "(int a, std::map<int, int> b = {})" has."""
    inside = signature[1:signature.rindex(")")]
    depth, count = 0, 1 if inside.strip() not in ("", "void") else 0
    for letter in inside:
        depth += (letter in "(<[{") - (letter in ")>]}")
        count += letter == "," and depth == 0
    return count


def function_rows(tags):
    functions = [t for t in tags if t["kind"] == "function" and "end" in t and not t["name"].startswith("__anon")]
    length = {id(t): t["end"] - t["line"] + 1 for t in functions}
    long = sorted((t for t in functions if length[id(t)] > LONG_FUNCTION), key=lambda t: -length[id(t)])
    wide = {f"{t['path']} {t['name']} {parameters(t['signature'])}": True for t in functions
            if parameters(t.get("signature", "()")) >= MANY_PARAMETERS}
    return {
        "functions": len(functions),
        f"functions of more than {LONG_FUNCTION} lines": len(long),
        "longest function, lines": max(length.values(), default=0),
        "long functions": [f"{t['path']} {t['name']} {length[id(t)]}" for t in long],
        f"functions with {MANY_PARAMETERS} parameters or more": sorted(wide),
    }


def class_rows(tags):
    """Methods are counted where they are declared: in the class."""
    members, methods, where = collections.Counter(), collections.Counter(), {}
    for tag in tags:
        if tag["kind"] in ("class", "struct"):
            where[f"{tag.get('scope', '')}::{tag['name']}".removeprefix("::")] = tag["path"]
        elif tag.get("scopeKind") in ("class", "struct"):
            scope, declared = tag["scope"], tag["kind"] == "prototype" or tag["path"].endswith(".h")
            members[scope] += tag["kind"] == "member"
            methods[scope] += tag["kind"] in ("function", "prototype") and declared
    largest = sorted(where, key=lambda c: -(members[c] + methods[c]))[:LARGEST_CLASSES]
    return {"largest classes, members + methods": [f"{c.removeprefix('rumi::')} {members[c]} + {methods[c]}" for c in largest]}


def file_rows(files):
    sizes = [file.lines for file in files]
    longest = max(files, key=lambda file: file.lines)
    per_folder = collections.Counter(file.folder for file in files)
    fullest = per_folder.most_common(1)[0]
    return {
        "source files": len(files),
        "source lines": sum(sizes),
        "folders": len(per_folder),
        "files of a folder, median": statistics.median(per_folder.values()),
        "files of a folder, most": f"{fullest[1]} ({fullest[0]})",
        "lines of a file, median": statistics.median(sizes),
        "lines of a file, most": f"{longest.lines} ({longest.name})",
        f"files of {SMALL_FILE} lines or fewer": sum(size <= SMALL_FILE for size in sizes),
        "circles of folders": [" - ".join(circle) for circle in circles(files)],
    }


def measure(folders):
    files = read_files(folders)
    rows = file_rows(files)
    tags = read_tags(files)
    rows.update({**function_rows(tags), **class_rows(tags)} if tags is not None else
                {"functions": "not counted: there is no Universal Ctags (apt install universal-ctags)"})
    headers = "".join(file.text for file in files if file.path.suffix == ".h")
    rows["ways to fail, in headers"] = [f"{way} {len(find.findall(headers))}" for way, find in WAYS_TO_FAIL.items()]
    per_component = collections.Counter()
    for file in files:
        per_component[file.folder.split("/")[0]] += file.lines
    rows["lines of a component"] = [f"{name} {lines}" for name, lines in per_component.most_common()]
    tests = read_files([f"tests/{folder}" for folder in folders]) + (
        [File(p) for p in sorted((ROOT / "tests").glob("*.cpp"))] if folders == COMPONENTS else [])
    rows["TEST macros"] = sum(len(TEST.findall(file.text)) for file in tests)
    rows["lines of tests"] = sum(file.lines for file in tests)
    rows["lines of tests a line of source"] = round(rows["lines of tests"] / rows["source lines"], 2)
    rows["lines with a comment"] = sum(bool(COMMENT_LINE.search(line)) for file in files for line in file.text.split("\n"))
    return rows


def main():
    flags = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    flags.add_argument("--folder", help="count this folder alone")
    flags.add_argument("--json", action="store_true", help="as JSON, for programs")
    given = flags.parse_args()
    if given.folder and not (ROOT / given.folder).is_dir():
        flags.error(f"--folder {given.folder}: there is no such folder in {ROOT}")
    rows = measure([given.folder.rstrip("/")] if given.folder else COMPONENTS)
    if given.json:
        print(json.dumps(rows, indent=1))
        return
    for name, value in rows.items():
        print(f"{name}: {len(value) if isinstance(value, list) else value}")
        for line in value if isinstance(value, list) else []:
            print(f"    {line}")


if __name__ == "__main__":
    main()
