#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""completions.py RUMI FOLDER: what bash (FOLDER/rumi) and zsh (FOLDER/_rumi) complete, from --help of every command."""
import pathlib
import re
import subprocess
import sys

PATHS = {"FILE", "FOLDER", "RECORDING"}


COLUMN = 30  # where the help of a flag begins, or in the next line


class Flag:
    """One of "  -o,--output FILE REQUIRED" and its help."""

    def __init__(self, left, summary):
        self.names = re.findall(r"(?<!\S)-\w(?=,)|--[\w-]+", left)
        value = re.sub(r"^.*?--[\w-]+| REQUIRED| \(Env:.*\)", "", left).strip()
        words = re.search(r":([\w-]+(?:\|[\w-]+)+)", value)
        self.choices = words[1].split("|") if words else []
        self.repeated = value.endswith("...")
        self.value = re.split(r"[:= [(]", value)[0]
        self.summary = summary


def help_of(rumi, command):
    return subprocess.run([rumi, *command, "--help"], capture_output=True, text=True, check=True).stdout


def flags_of(text):
    flags = []
    for line in re.sub(rf"\n {{{COLUMN}}}(?=\S)", "\n\t", text).split("\n"):
        if line.startswith("\t") and flags:
            flags[-1].summary = f"{flags[-1].summary} {line.strip()}".strip()
        elif re.match(r" +-", line):
            has_help = line[COLUMN - 1 :].startswith(" ")
            flags.append(Flag(line[:COLUMN], line[COLUMN:]) if has_help else Flag(line, ""))
    return flags


def commands_of(text):
    """Name and summary, of commands and of processes."""
    listed = re.search(r"^subcommands:\n((?:  .*\n)+)", text, re.M | re.I)[1]
    commands = re.findall(r"^  (\S+) +(\S.*)$", listed, re.M)
    processes = re.search(r"^`rumi (\S+) \.\.\.`", text, re.M)[1].split("|")
    return commands + [(name, "one of the processes that `rumi up` starts") for name in processes]


def bash(top, commands, flags):
    def words(names):
        return "mapfile -t COMPREPLY < <(compgen -W '" + " ".join(names) + "' -- \"$current\")"

    def names(some):
        return [name for flag in some for name in flag.names]

    yield "# Completion of rumi for bash, by packaging/completions.py. Files are completed where nothing else fits."
    yield "_rumi() {"
    yield '  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}'
    yield "  COMPREPLY=()"
    yield "  if ((COMP_CWORD == 1)); then"
    yield "    " + words([name for name, _ in commands] + names(top))
    yield "    return"
    yield "  fi"
    yield '  case "$command $previous" in'
    for command, _ in commands:
        for flag in flags[command]:
            if flag.choices:
                yield f"    {'|'.join(f'{chr(34)}{command} {name}{chr(34)}' for name in flag.names)})"
                yield "      " + words(flag.choices)
                yield "      return ;;"
    yield "  esac"
    yield "  [[ $current == -* ]] || return"
    yield "  case $command in"
    for command, _ in commands:
        yield f"    {command}) {words(names(flags[command]))} ;;"
    yield "  esac"
    yield "}"
    yield "complete -o default -F _rumi rumi"


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_flag(flag):
    summary = re.sub(r"([][:\\])", r"\\\1", flag.summary)
    value = ""
    if flag.choices:
        value = f":{flag.value}:({' '.join(flag.choices)})"
    elif flag.value:
        value = f":{flag.value}:" + ("_files" if flag.value in PATHS else "")
    for name in flag.names:
        others = "*" if flag.repeated else f"({' '.join(flag.names)})"
        yield quoted(f"{others}{name}[{summary}]{value}")


def zsh(top, commands, flags):
    yield "#compdef rumi"
    yield "# Completion of rumi for zsh, by packaging/completions.py."
    yield "_rumi() {"
    yield "  if ((CURRENT == 2)); then"
    yield "    local -a commands=("
    for command, summary in commands:
        yield "      " + quoted(f"{command}:{summary}")
    yield "    )"
    yield "    _describe command commands"
    yield "    _arguments " + " ".join(spec for flag in top for spec in zsh_flag(flag))
    yield "    return"
    yield "  fi"
    yield "  local command=$words[2]"
    yield "  shift words"
    yield "  ((CURRENT--))"
    yield "  case $command in"
    for command, _ in commands:
        yield f"    {command})"
        yield "      _arguments \\"
        for flag in flags[command]:
            yield "        " + " ".join(zsh_flag(flag)) + " \\"
        yield "        '*:file:_files'"
        yield "      ;;"
    yield "  esac"
    yield "}"
    yield '_rumi "$@"'


def main():
    rumi, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    text = help_of(rumi, [])
    commands = commands_of(text)
    flags = {command: flags_of(help_of(rumi, [command])) for command, _ in commands}
    folder.mkdir(parents=True, exist_ok=True)
    for name, lines in (("rumi", bash), ("_rumi", zsh)):
        (folder / name).write_text("\n".join(lines(flags_of(text), commands, flags)) + "\n")


main()
