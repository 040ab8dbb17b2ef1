# SPDX-License-Identifier: BSD-3-Clause
"""house_test.py SOURCE_DIR: what scripts/house.py counts, and what must not grow again."""
import json
import pathlib
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(SOURCE / "scripts"))
import house  # noqa: E402

LONGEST_FUNCTION = 52  # lines; make it smaller when the longest has become shorter
LONG_FUNCTIONS = 16
MOST_LINES_OF_A_FILE = 440


def run(*flags):
    return subprocess.run([sys.executable, "-B", SOURCE / "scripts/house.py", *flags], capture_output=True, text=True)


class HouseTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = json.loads(run("--json").stdout)

    def test_no_circles(self):
        self.assertEqual(self.rows["circles of folders"], [])

    def test_functions_stay_short(self):
        if "long functions" not in self.rows:
            self.skipTest(self.rows["functions"])
        self.assertGreater(self.rows["functions"], 1000)
        self.assertLessEqual(self.rows["longest function, lines"], LONGEST_FUNCTION, self.rows["long functions"])
        self.assertLessEqual(len(self.rows["long functions"]), LONG_FUNCTIONS, self.rows["long functions"])

    def test_files_stay_short(self):
        most = self.rows["lines of a file, most"]
        self.assertLessEqual(int(most.split()[0]), MOST_LINES_OF_A_FILE, most)

    def test_prints_its_rows(self):
        said = run().stdout
        for row in ("source files", "lines of a file, median", "functions", "ways to fail, in headers", "TEST macros"):
            self.assertIn(f"\n{row}: ", "\n" + said)

    def test_one_folder(self):
        rows = json.loads(run("--folder", "rumi/web", "--json").stdout)
        self.assertEqual(rows["folders"], 1)
        self.assertLess(rows["source lines"], self.rows["source lines"])
        self.assertIn("no such folder", run("--folder", "rumi/nowhere").stderr)


class Counting(unittest.TestCase):
    def test_components(self):
        uses = {"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set()}
        self.assertEqual(house.components(uses), [["b", "c"]])
        self.assertEqual(house.components({"a": {"b"}, "b": set()}), [])

    def test_parameters(self):
        for signature, count in (("()", 0), ("(int a)", 1), ("(std::map<int, int> a, F<void(int, int)> b) const", 2),
                                 ("(int a = f(1, 2), int b = {})", 2), ("(void)", 0)):
            self.assertEqual(house.parameters(signature), count, signature)

    def test_ways_to_fail(self):
        header = ("std::string check();\n  static std::string f(int);\nstd::optional<int> g();\nResult<Camera> read();\n"
                  "[[nodiscard]] Result<> write();\n  std::string name, error;\nbool h(std::string* error);  // throws\n")
        count = {way: len(find.findall(header)) for way, find in house.WAYS_TO_FAIL.items()}
        self.assertEqual(list(count.values()), [2, 1, 1, 1, 1, 2, 1])


if __name__ == "__main__":
    unittest.main()
