# SPDX-License-Identifier: BSD-3-Clause
"""words_test.py SOURCE_DIR: comments are sentences, with subject and verb, in the words of the field (docs/GLOSSARY.md)."""
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1))

FOLDERS = ["base", "bench", "bus", "camera_driver", "examples", "formats", "front_tracker", "fuzz", "map_server", "rumi",
           "ruminator", "slam", "synth", "tests", "viewer_offscreen"]

# How no comment begins, and why.
BEGINNINGS = {
    "Of": "name the subject first: `Of the images, those that ...` is `Images that ...`",
    "With": "it hangs on a line that may not be read: say who does what",
    "And": "it hangs on the line before: join the two, or name the subject again",
    "What": "name the thing: `What is known of X` is `X: ...` or `Holds X`",
    "Than": "it hangs on the line before",
    "For these": "say for which",
    "The same": "say the same as what, as a sentence: `As f(), but ...`",
}

# What no comment contains, and why.
PHRASES = {
    "nothing, and why": "Result: say when it is an Error",
    "what is wrong, or": "Result: say when it is an Error",
    "is none of ours": "say what it is",
    "where there is none": "say what is missing",
    "where there are none": "say what is missing",
}


def comments(text):
    """(line, comment) of each block of lines that are comments, joined."""
    found, block, first = [], [], 0
    for number, line in enumerate(text.split("\n"), 1):
        comment = re.match(r"\s*//+ ?(.*)", line)
        if comment and not comment[1].startswith(("SPDX", "NOLINT", "clang-format")):
            first = first if block else number
            block.append(comment[1])
        elif block:
            found.append((first, " ".join(block)))
            block = []
    return found


def faults(text):
    """What is against the rules in a source."""
    found = []
    for line, comment in comments(text):
        found += [(line, f"begins with '{word}': {why}") for word, why in BEGINNINGS.items()
                  if re.match(rf"{word}\b", comment)]
        found += [(line, f"'{phrase}': {why}") for phrase, why in PHRASES.items() if phrase in comment.lower()]
    return found


class WordsTest(unittest.TestCase):
    def test_comments_are_sentences(self):
        wrong = [f"{file.relative_to(SOURCE)}:{line} {fault}" for folder in FOLDERS
                 for file in sorted((SOURCE / folder).rglob("*")) if file.suffix in (".h", ".cpp")
                 for line, fault in faults(file.read_text())]
        self.assertEqual(wrong, [], "\n" + "\n".join(wrong))

    def test_finds_what_it_looks_for(self):
        source = "// SPDX-License\n// Of the images.\nint a;  // And\n\n// Draws, where\n// there is none.\nint b;\n  // Offers.\nint c;\n"
        self.assertEqual([line for line, _ in faults(source)], [2, 5])


if __name__ == "__main__":
    unittest.main()
