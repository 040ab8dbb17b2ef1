# SPDX-License-Identifier: BSD-3-Clause
"""sources_test.py SOURCE_DIR: what packaging says again of the project agrees with the project."""
import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1])
UNITS = {file.name.removesuffix(".in") for file in (SOURCE / "config/systemd").iterdir()}


def read(name):
    return (SOURCE / name).read_text()


class SourcesTest(unittest.TestCase):
    def test_the_version_is_the_newest_of_the_changelog(self):
        version = re.search(r"^project\(rumi VERSION (\S+)", read("CMakeLists.txt"), re.M)[1]
        self.assertEqual(re.search(r"^## (\S+)", read("CHANGELOG.md"), re.M)[1], version)

    def test_what_the_build_needs_is_set_up(self):
        set_up = set(re.findall(r"[a-z0-9][a-z0-9.+-]+", read("scripts/install_dependencies.sh")))
        needed = re.search(r"^Build-Depends: (.*?)\n\S", read("packaging/debian/control"), re.M | re.S)[1]
        names = {re.match(r"[a-z0-9.+-]+", entry.strip())[0] for entry in needed.split(",")} - {"debhelper-compat"}
        self.assertGreater(len(names), 20)
        self.assertEqual(names - set_up, set())

    def test_every_unit_is_stopped_before_the_package_is_removed(self):
        self.assertEqual(set(re.findall(r"rumi[\w-]*\.(?:service|target)", read("packaging/debian/rumi.prerm"))), UNITS)

    def test_the_copyright_is_the_licence(self):
        def words(text):
            return text.replace("\n .\n", "\n").split()

        licence = read("LICENSE").split("\n\n", 2)[2]
        self.assertEqual(words(read("packaging/debian/copyright").split("License: BSD-3-Clause\n")[-1]), words(licence))

    def test_scripts_can_be_run(self):
        for script in [*SOURCE.glob("packaging/*.sh"), *SOURCE.glob("packaging/*.py"), SOURCE / "packaging/debian/rules"]:
            self.assertTrue(script.stat().st_mode & 0o100, script)
            if script.suffix == ".sh":
                subprocess.run(["sh", "-n", script], check=True)


unittest.main(argv=[sys.argv[0]])
