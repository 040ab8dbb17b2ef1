# SPDX-License-Identifier: BSD-3-Clause
"""pages_test.py SOURCE_DIR: what README, CONTRIBUTING, CHANGELOG and docs/ name exists, and no page is too long."""
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1])
WIDTH = 120
LINES = {"README.md": 200, "CHANGELOG.md": 180}  # others: 120
RECORDS = "docs/experiments"  # the options and files of their day

TOP = [SOURCE / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
PAGES = sorted(SOURCE.glob("docs/*.md"))
EXPERIMENTS = sorted(SOURCE.glob(f"{RECORDS}/*.md"))


def name(page):
    return str(page.relative_to(SOURCE))


def prose(page):
    """Its lines, empty where they are code."""
    lines, fenced = [], False
    for line in page.read_text().split("\n"):
        fence = line.lstrip().startswith("```")
        fenced = fenced != fence
        lines.append("" if fenced or fence else line)
    return lines


def anchors(page):
    """Of its headings, as GitHub makes them."""
    headings = [line.lstrip("#") for line in prose(page) if line.startswith("#")]
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def code(page):
    return re.findall(r"`([^`\n]+)`", "\n".join(prose(page)))


def options():
    """section.key of both configuration files."""
    found = set()
    for file in ("rumi.yaml", "expert.yaml"):
        section = ""
        for line in (SOURCE / "config" / file).read_text().split("\n"):
            if key := re.match(r"( *)(\w+):", line):
                section = section if key[1] else key[2]
                found.add(f"{section}.{key[2]}" if key[1] else section)
    return found


class PagesTest(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in TOP + PAGES + EXPERIMENTS:
            for link in re.findall(r"\]\(([^)]+)\)", "\n".join(prose(page))):
                if re.match(r"https?:", link):
                    continue
                file, _, anchor = link.partition("#")
                target = (page.parent / file).resolve() if file else page
                with self.subTest(page=name(page), link=link):
                    self.assertTrue(target.exists(), "no such file")
                    self.assertTrue(not anchor or anchor in anchors(target), "no such heading")

    def test_pages_are_linked_from_the_readme(self):
        readme = (SOURCE / "README.md").read_text()
        for page in PAGES:
            self.assertIn(f"({name(page)}", readme)

    def test_experiments_are_in_their_index(self):
        index = (SOURCE / RECORDS / "README.md").read_text()
        for page in EXPERIMENTS:
            if page.name != "README.md":
                self.assertIn(f"({page.name})", index)

    def test_pictures_are_shown(self):
        shown = "".join(page.read_text() for page in TOP + PAGES)
        for picture in (SOURCE / "docs/images").iterdir():
            self.assertIn(f"images/{picture.name})", shown)

    def test_options_exist(self):
        known = options()
        sections = {option.split(".")[0] for option in known}
        for page in [SOURCE / "README.md"] + PAGES:
            for span in code(page):
                for section, key in re.findall(r"\b([a-z_]+)\.([a-z_]+)\b", span):
                    if section in sections and key not in ("h", "cpp"):
                        self.assertIn(f"{section}.{key}", known, name(page))

    def test_files_exist(self):
        files = [str(f.relative_to(SOURCE)) for folder in SOURCE.iterdir()
                 if folder.is_dir() and not folder.name.startswith(("build", ".", "out")) for f in folder.rglob("*.*")]
        for page in TOP[:1] + TOP[2:] + PAGES:
            for span in code(page):
                for path in re.findall(r"\b[a-z_0-9]+(?:/[a-z_0-9]+)*/[a-z_0-9]+\.(?:h|cpp|sh|py|lcm|supp|c)\b", span):
                    self.assertTrue(any(f == path or f.endswith("/" + path) for f in files), f"{name(page)}: {path}")

    def test_pages_are_short(self):
        for page in TOP + PAGES:
            self.assertLessEqual(len(prose(page)) - 1, LINES.get(name(page), 120), name(page))

    def test_prose_is_not_too_wide(self):
        for page in TOP + PAGES + EXPERIMENTS:
            wide = [i + 1 for i, line in enumerate(prose(page)) if len(line) > WIDTH and not line.startswith("|")]
            self.assertEqual(wide, [], name(page))


unittest.main(argv=[sys.argv[0]])
