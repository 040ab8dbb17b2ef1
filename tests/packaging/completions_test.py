# SPDX-License-Identifier: BSD-3-Clause
"""completions_test.py RUMI SOURCE_DIR: the shells complete every command and every flag that --help names, and no others."""
import functools
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

RUMI, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])

# What a shell would do for `rumi WORDS...` with the cursor on the last word.
BASH = """
source "$1"
shift
COMP_WORDS=(rumi "$@")
COMP_CWORD=$#
_rumi
printf '%s\\n' "${COMPREPLY[@]}"
"""
# What _rumi hands to zsh's own functions is printed instead of shown.
ZSH = """
_arguments() { print -rl -- "$@" }
_describe() { print -rl -- "${(@P)2}" }
file=$1
shift
words=(rumi "$@")
CURRENT=$#words
functions[_rumi_file]=$(<$file)
_rumi_file
"""

# A zsh of its own at a terminal: Ctrl-O hands over the line, as it is, and empties it.
ZSHRC = """
fpath=({folder} $fpath)
autoload -Uz compinit && compinit -u -D
hand_over() {{ print -r -- "$BUFFER|" >handed_over; BUFFER= }}
zle -N hand_over
bindkey '^O' hand_over
PS1='ready> '
"""


class Zsh:
    """What a user sees of zsh, in FOLDER."""

    def __init__(self, folder):
        self.folder = folder
        (folder / ".zshrc").write_text(ZSHRC.format(folder=folder))
        os.mkfifo(folder / "handed_over")
        self.terminal, inside = pty.openpty()
        settings = {**os.environ, "ZDOTDIR": str(folder), "TERM": "dumb"}
        self.process = subprocess.Popen(
            ["zsh", "-d", "-i"], cwd=folder, env=settings, stdin=inside, stdout=inside, stderr=inside, start_new_session=True
        )
        os.close(inside)
        shown = b""
        while b"ready> " not in shown:
            shown += os.read(self.terminal, 1024)

    def typed(self, keys):
        """The line after KEYS."""
        os.write(self.terminal, keys.encode() + b"\x0f")
        return (self.folder / "handed_over").read_text().removesuffix("|\n")

    def end(self):
        self.process.kill()
        self.process.wait()
        os.close(self.terminal)


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@functools.cache
def flags_in_help(*command):
    """The words with dashes at the beginning of a line."""
    heads = re.findall(r"^  +(-\S.*)$", run(RUMI, *command, "--help"), re.M)
    return {name for head in heads for name in re.split(", *", re.match(r"(?:-\w, *)?[\w,-]+", head)[0])}


class CompletionsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        run(SOURCE / "packaging/completions.py", RUMI, cls.folder.name)
        text = run(RUMI, "--help")
        listed = re.search(r"^subcommands:\n(.*?)\n\n", text, re.M | re.S | re.I)[1]
        cls.commands = re.findall(r"^  ([\w-]+)", listed, re.M)
        cls.commands += ["camera_driver", "front_tracker", "ruminator", "map_server", "viewer_offscreen"]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def bash(self, *words):
        return set(run("bash", "-c", BASH, "bash", f"{self.folder.name}/rumi", *words).split())

    def zsh(self, *words):
        return run("zsh", "-f", "-c", ZSH, "zsh", f"{self.folder.name}/_rumi", *words)

    def test_bash_knows_every_command(self):
        self.assertGreater(len(self.commands), 20)
        self.assertEqual(self.bash(""), set(self.commands) | flags_in_help())

    def test_bash_knows_every_flag_of_a_command(self):
        for command in self.commands:
            self.assertGreaterEqual(flags_in_help(command), {"-h", "--help"})
            self.assertEqual(self.bash(command, "-"), flags_in_help(command), command)

    def test_bash_completes_what_is_begun(self):
        self.assertEqual(self.bash("draw-"), {"draw-board", "draw-window"})
        self.assertEqual(self.bash("export-map", "map.db", "--for"), {"--format"})

    def test_bash_knows_the_words_that_a_flag_takes(self):
        self.assertEqual(self.bash("draw-board", "--paper", ""), {"a4", "a3", "letter"})

    def test_bash_leaves_files_to_the_shell(self):
        self.assertEqual(self.bash("replay", ""), set())
        self.assertEqual(self.bash("replay", "--config", ""), set())

    @unittest.skipUnless(shutil.which("zsh"), "zsh is missing")
    def test_zsh_knows_every_command_and_flag(self):
        listed = self.zsh("")
        self.assertEqual(set(re.findall(r"^([a-z][\w-]+):", listed, re.M)), set(self.commands))
        for command in self.commands:
            known = set(re.findall(r"^(?:\([^)]*\)|\*)(-[\w-]+)\[", self.zsh(command, "-"), re.M))
            self.assertEqual(known, flags_in_help(command), command)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is missing")
    def test_zsh_completes_files_where_one_is_wanted(self):
        self.assertIn("(--config)--config[YAML file with options, see config/rumi.yaml]:FILE:_files", self.zsh("demo", "-"))
        self.assertIn(":(a4 a3 letter)", self.zsh("draw-board", "-"))

    @unittest.skipUnless(shutil.which("zsh"), "zsh is missing")
    def test_zsh_itself_completes_what_a_user_types(self):
        (pathlib.Path(self.folder.name) / "walk.yaml").touch()
        zsh = Zsh(pathlib.Path(self.folder.name))
        self.addCleanup(zsh.end)
        for keys, line in {
            "rumi draw-b\t": "rumi draw-board ",
            "rumi map_s\t": "rumi map_server ",
            "rumi draw-board --pap\t": "rumi draw-board --paper ",
            "rumi draw-board --paper let\t": "rumi draw-board --paper letter ",
            "rumi demo --config wa\t": "rumi demo --config walk.yaml ",
            "rumi replay wa\t": "rumi replay walk.yaml ",
        }.items():
            self.assertEqual(zsh.typed(keys), line, keys)


unittest.main(argv=[sys.argv[0]])
