# SPDX-License-Identifier: BSD-3-Clause
# What scripts/unexpected_skips.sh takes for a skipped test.
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(sys.argv.pop(1)) / "scripts/unexpected_skips.sh"

GTEST = """[ RUN      ] Log.FullDisk
log_file_test.cpp:155: Skipped
SKIPPED: no /dev/full here
[  SKIPPED ] Log.FullDisk (0 ms)
[       OK ] Log.Whole (3 ms)
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Log.FullDisk
"""
CTEST = """      Start 6: lcm_bus_test
 1/3 Test  #6: lcm_bus_test .....................***Skipped   0.02 sec
 2/3 Test #10: base_test ........................   Passed    1.00 sec
The following tests did not run:
\t  6 - lcm_bus_test (Skipped)
"""


class UnexpectedSkips(unittest.TestCase):
    def run_script(self, expected, *logs):
        with tempfile.TemporaryDirectory() as folder:
            files = []
            for number, text in enumerate((expected,) + logs):
                files.append(pathlib.Path(folder) / str(number))
                files[-1].write_text(text)
            done = subprocess.run([SCRIPT] + files, capture_output=True, text=True)
            return done.returncode, done.stdout

    def test_names_what_should_have_run(self):
        code, said = self.run_script("# none\n", GTEST, CTEST)
        self.assertEqual(code, 1)
        self.assertEqual(said, "skipped, and should have run: Log.FullDisk\n"
                               "skipped, and should have run: lcm_bus_test\n")

    def test_what_is_expected_is_not_named(self):
        code, said = self.run_script("Log.FullDisk needs /dev/full\n", GTEST, CTEST)
        self.assertEqual((code, said), (1, "skipped, and should have run: lcm_bus_test\n"))
        code, said = self.run_script("Log.FullDisk needs /dev/full\nlcm_bus_test needs namespaces\n", GTEST, CTEST)
        self.assertEqual((code, said), (0, ""))

    def test_a_part_of_a_name_is_another_test(self):
        self.assertEqual(self.run_script("Log.Full\n", GTEST)[0], 1)

    def test_nothing_skipped(self):
        self.assertEqual(self.run_script("", "[       OK ] Log.Whole (3 ms)\n"), (0, ""))


if __name__ == "__main__":
    unittest.main()
