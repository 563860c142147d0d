#!/usr/bin/env python3
"""Completes command lines in bash, zsh and fish, and compares the candidates with the help of the program.

    completion_test.py PROGRAM SCRIPT [SHELL...]

PROGRAM: the program octopair. SCRIPT: the folder of the completions. SHELL: bash, zsh and fish by default.

Each option that the help shows must be a candidate, and nothing else. Each value that a shell offers must be in the help, too.
"""
import fcntl
import os
import pathlib
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import time

# Values of options by their argument in the help. An argument that is in none of these tables fails the test.
WORDS = {
    "--classes": "clearance collision touching penetrating contained duplicate undecided",
    "--stage": "pairs objects features", "--adjacent": "beyond-shared exclude include", "--up": "y z",
    "--unit": "um mm cm dm m km in ft", "--same-parent": "include exclude", "--objects WHAT": "node triangle",
    "--index-type": "uint32 uint64", "--order": "ascending octal", "--log": "text json",
    "--log-level": "debug info warn error",
}
NOTHING = {"N", "M", "S", "F", "BYTES", "SECONDS", "LENGTH", "UUID", "CLIENT", "USER", "ADDRESS", "HOST:PORT", "COMMAND", "TYPE"}
FILES = ["a.npy", "b.csv", "c.jsonl", "c.bcf", "d.pem", "e.html", "f.json", "g.txt", "hnpy"]
FOLDER = "folder"
JOB = "0123abcd-0000-4000-8000-00000000abcd"
# Stands for the program: prints a job without a server, and otherwise runs the program.
WRAPPER = """#!/bin/sh
[ "$*" != status ] || { echo "JOB running"; exit; }
exec 'PROGRAM' "$@"
"""


class Help:
    """The entries of a help text: `options` has NAME -> (argument, description), with a name for each short form; `arguments` has the
    names of positional arguments; `subcommands` and `kinds` are the names in these sections."""

    def __init__(self, text):
        self.options, self.arguments, self.subcommands, self.kinds = {}, [], [], []
        section = None
        for entry in re.sub(r"\n {4,}", "  ", text).splitlines():  # a description may continue on more lines
            if re.match(r"[A-Z][\w ]*:$", entry):
                section = entry[:-1]
            elif entry.startswith("  ") and section != "Examples":
                head, _, words = entry.strip().partition("  ")
                self.add(section, head.split(), " ".join(words.split()))

    def add(self, section, head, words):
        names = [head[0].rstrip(","), head[1]] if head[0].endswith(",") else [head[0]]
        argument = head[len(names)].removesuffix("...") if len(head) > len(names) else ""
        if section in ("Subcommands", "Kinds"):
            {"Subcommands": self.subcommands, "Kinds": self.kinds}[section].append(names[0])
        elif names[0].startswith("-"):
            self.options.update((name, (argument, words)) for name in names)
        else:
            self.arguments.append(names[0].removesuffix("..."))

    def long_options(self):
        return {name for name in self.options if name.startswith("--")}


class Program:
    def __init__(self, path):
        self.path = path

    def run(self, *arguments):
        return subprocess.run([self.path, *arguments], capture_output=True, text=True, check=True).stdout

    def help(self, *subcommand):
        return Help(self.run(*subcommand, "--help"))

    def engines(self):
        """Returns the engines of this build as completions."""
        names = re.search(r"^engines +(.*)$", self.run("info"), re.MULTILINE)[1].split(", ")
        return {"unix:" if name == "server (ADDRESS)" else name for name in names}


def ending(*endings):
    return {name for name in FILES if not endings or name.rpartition(".")[2] in endings} | {FOLDER}


def values_of(program, option, argument, text):
    """Returns the values that an option must have as candidates, or None if the test has no rule for them."""
    words = WORDS.get(option) or WORDS.get(f"{option} {argument}")
    if words:
        unknown = [word for word in words.split() if not re.search(rf"(?<![\w-]){word}(?![\w-])", text)]
        assert not unknown, f"the help of {option} does not have: {unknown}"
        return set(words.split())
    if argument == "ENGINE":
        return program.engines()
    if argument == "DIR":
        return {FOLDER}
    if option in ("-o", "--output") and argument == "FILE":
        return ending("npy", "csv", "jsonl", "bcf")
    if argument == "FILE":
        return ending()
    if "." in argument:
        return ending(argument.rpartition(".")[2])
    return set() if argument in NOTHING else None


def cases_of(program, subcommand):
    """Yields command lines of a subcommand, and the candidates of each."""
    known = program.help(subcommand)
    options = known.options
    yield f"{subcommand} --", known.long_options()
    for option, (argument, text) in options.items():
        if not argument:
            continue
        expected = values_of(program, option, argument, text)
        assert expected is not None, f"{subcommand} {option}: the test has no rule for the argument {argument}"
        yield f"{subcommand} {option} ", expected
    positional = next(iter(known.arguments), None)
    if positional == "KIND":
        kinds = set(known.kinds)
        yield f"{subcommand} ", kinds
        yield f"{subcommand} --seed 1 ", kinds
    elif positional in ("INPUT", "FILE"):
        yield f"{subcommand} ", ending()
        if "--quiet" in options:
            yield f"{subcommand} --quiet ", ending()
    elif positional == "ID":
        yield f"{subcommand} ", {JOB}
        yield f"{subcommand} {JOB} -", set(options)
    else:
        assert positional is None, f"{subcommand}: the test has no rule for the argument {positional}"


def cases(program):
    top = program.help()
    yield "", set(top.subcommands)
    yield "--", top.long_options()
    yield "d", {name for name in top.subcommands if name.startswith("d")}
    yield "help d", {name for name in top.subcommands if name.startswith("d")}
    yield "detect --order a", {"ascending"}
    for subcommand in top.subcommands:
        yield from cases_of(program, subcommand)


def in_bash(script, folder, lines):
    """Returns the candidates that bash offers for each command line."""
    source = f"source '{script}/octopair.bash'\n"
    for line in lines:
        source += f"COMP_LINE='octopair {line}'; read -ra COMP_WORDS <<< \"$COMP_LINE\"\n" \
            '[[ $COMP_LINE != *" " ]] || COMP_WORDS+=("")\n' \
            'COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _octopair octopair; printf "%s\\t" "${COMPREPLY[@]}"; echo\n'
    shell = subprocess.run(["bash", "--norc", "-c", source], capture_output=True, text=True, check=True, cwd=folder)
    assert not shell.stderr, shell.stderr
    return [set(line.split("\t")) - {""} for line in shell.stdout.splitlines()]


def in_fish(script, folder, lines):
    """Returns the candidates that fish offers for each command line."""
    source = f"source '{script}/octopair.fish'\n"
    source += "".join(f"complete -C 'octopair {line}'; echo =\n" for line in lines)
    shell = subprocess.run(["fish", "--no-config", "-c", source], capture_output=True, text=True, check=True, cwd=folder)
    assert not shell.stderr, shell.stderr
    return [{line.split("\t")[0].rstrip("/") for line in block.splitlines() if line} for block in shell.stdout.split("=\n")[:-1]]


# Writes each candidate to the file $CAPTURED, and a line "=" after each completion.
ZSHRC = """
fpath=('{script}' $fpath)
autoload -Uz compinit && compinit -u -D
LISTMAX=100000 PS1= KEYTIMEOUT=1
zstyle ':completion:*' list-prompt ''
compadd() {{
    local -a hits
    if [[ " $* " != *" -"[OAD]" "* ]]; then
        builtin compadd -O hits "$@"
        (( $#hits == 0 )) || print -rl -- $hits >> $CAPTURED
    fi
    builtin compadd "$@"
}}
capture() {{ zle complete-word; zle kill-buffer; print -r -- = >> $CAPTURED }}
zle -N capture
bindkey '^I' capture
print -r -- ready >> $CAPTURED
"""


def read_until(terminal, captured, marks):
    """Waits until the captured file has a number of marks. The terminal is read, so that the shell never waits."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        if select.select([terminal], [], [], 0.02)[0]:
            os.read(terminal, 65536)
        text = captured.read_text(encoding="utf-8") if captured.exists() else ""
        if len(re.findall("^(?:ready|=)$", text, re.MULTILINE)) >= marks:
            return text
    sys.exit("zsh does not answer")


def in_zsh(script, folder, lines):
    """Returns the candidates that zsh offers for each command line, typed at a terminal."""
    with tempfile.TemporaryDirectory() as home:
        captured = pathlib.Path(home, "captured")
        pathlib.Path(home, ".zshrc").write_text(ZSHRC.format(script=script), encoding="utf-8")
        process, terminal = pty.fork()
        if process == 0:
            os.chdir(folder)
            os.execvpe("zsh", ["zsh", "-d", "-i"], {**os.environ, "ZDOTDIR": home, "CAPTURED": str(captured), "TERM": "dumb"})
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 1000, 300, 0, 0))
        text = read_until(terminal, captured, 1)
        for number, line in enumerate(lines, 2):
            os.write(terminal, f"octopair {line}\t".encode())
            text = read_until(terminal, captured, number)
        os.close(terminal)
        os.waitpid(process, 0)
    blocks = re.split("^=$", text.partition("ready\n")[2], flags=re.MULTILINE)[:-1]
    return [{hit.split(":")[0] if hit.startswith("-") else hit for hit in block.split("\n") if hit} for block in blocks]


def complete_in(shell, script, program, wanted):
    """Completes the command lines in a shell. Returns how many have wrong candidates."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, FOLDER).mkdir()
        for name in FILES:
            pathlib.Path(folder, name).touch()
        found = {"bash": in_bash, "zsh": in_zsh, "fish": in_fish}[shell](script, folder, [line for line, _ in wanted])
    assert len(found) == len(wanted), f"{shell}: {len(found)} of {len(wanted)} command lines were completed"
    wrong = 0
    for (line, expected), candidates in zip(wanted, found):
        # The empty first word may also be an option.
        if candidates == expected or (line == "" and candidates == expected | set(program.help().options)):
            continue
        wrong += 1
        print(f"{shell}: octopair {line}<TAB>\n    missing: {sorted(expected - candidates)}\n"
              f"    extra: {sorted(candidates - expected)}")
    return wrong


def main():
    program = Program(str(pathlib.Path(sys.argv[1]).resolve()))
    script = pathlib.Path(sys.argv[2]).resolve()
    wanted = list(cases(program))
    with tempfile.TemporaryDirectory() as folder:
        wrapper = pathlib.Path(folder, "octopair")
        wrapper.write_text(WRAPPER.replace("PROGRAM", program.path).replace("JOB", JOB), encoding="utf-8")
        wrapper.chmod(0o755)
        os.environ.update(PATH=f"{folder}:{os.environ['PATH']}", OCTOPAIR_SERVER="unix:octopair/socket")
        wrong = sum(complete_in(shell, script, program, wanted) for shell in sys.argv[3:] or ["bash", "zsh", "fish"])
    print(f"{len(wanted)} command lines, {wrong} wrong in all shells")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
