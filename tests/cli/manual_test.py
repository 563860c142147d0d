#!/usr/bin/env python3
"""Compares a manual page with the help of its program: subcommands, options in their sections, and examples, all in the same order.

    manual_test.py PROGRAM PAGE     PAGE: docs/octopair.1

The page may describe more: options of parts that a build lacks, and more examples. Options of a section of the page may stand in any
sections of the help if the page's section has no headings.
"""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*[a-z]")
COMMON = {"--help", "--version"}  # described once for all subcommands


def help_of(program, *subcommand):
    """Returns the sections of a help: title -> lines that begin an entry or an example, without their indentation."""
    sections, lines = {}, []
    for line in subprocess.run([program, *subcommand, "--help"], capture_output=True, text=True, check=True).stdout.splitlines():
        if re.match(r"[A-Z][\w ]*:$", line):
            assert line[:-1] not in sections, f"{subcommand}: the help has two sections {line}"
            lines = sections.setdefault(line[:-1], [])
        elif re.match(r"  \S", line):
            lines.append(line[2:])
    return sections


def options_of_help(sections):
    """Returns [(title, options)] of a help."""
    groups = [(title, [OPTION.findall(line)[0] for line in lines if line.startswith("-")]) for title, lines in sections.items()]
    return without(lambda option: option in COMMON, groups)


def without(is_left_out, groups):
    kept = [(title, [option for option in options if not is_left_out(option)]) for title, options in groups]
    return [(title, options) for title, options in kept if options]


class Page:
    def __init__(self, path):
        text = pathlib.Path(path).read_text(encoding="utf-8").replace("\\-", "-")
        self.options = set(OPTION.findall(text))
        self.sections = {}
        for section in text.split("\n.SH ")[1:]:
            title, _, body = section.partition("\n")
            self.sections[title] = body
        self.examples = self.sections["EXAMPLES"].splitlines()

    def subcommands(self):
        return re.findall(r"^\.TP\n\.B (\S+)$", self.sections["SUBCOMMANDS"], re.M)

    def options_of(self, subcommand):
        """Returns [(heading, options)] of the entries about a subcommand. The heading is empty if the section has none."""
        groups, heading, before = [("", [])], "", ""
        for line in self.sections.get(f"OPTIONS OF {subcommand.upper()}", "").splitlines():
            if line.startswith(".SS "):
                heading = line[4:]
                groups.append((heading, []))
            elif before == ".TP":
                groups[-1][1].extend(OPTION.findall(line))
            before = line
        return [(title, options) for title, options in groups if options]


def flat(groups):
    return [option for _, options in groups for option in options]


def faults(program, page):
    """Yields what is missing in the page, or at another place than in the help."""
    overview = help_of(program)
    subcommands = [line.split()[0] for line in overview["Subcommands"]]
    assert subcommands, overview
    if [name for name in page.subcommands() if name in subcommands] != subcommands:
        yield f"SUBCOMMANDS: the order of the help is {subcommands}"
    described = [title[11:].lower() for title in page.sections if title.startswith("OPTIONS OF ")]
    if described != [name for name in page.subcommands() if name in described]:
        yield f"the order of the sections OPTIONS OF ... is {described}, not that of SUBCOMMANDS"
    for name in subcommands:
        yield from faults_of(program, name, page)
    if page.examples[1:1 + len(overview["Examples"])] != overview["Examples"]:
        yield "EXAMPLES: does not begin with those of the help"


def faults_of(program, name, page):
    sections = help_of(program, name)
    wanted, shown = options_of_help(sections), page.options_of(name)
    known = set(flat(wanted))
    shown = without(lambda option: option not in known, shown)
    missing = sorted(known - set(flat(shown)))
    if missing:
        yield f"OPTIONS OF {name.upper()}: {', '.join(missing)} missing"
    elif all(title for title, _ in shown) and shown != wanted:
        yield f"OPTIONS OF {name.upper()}: the sections of the help are {wanted}, those of the page {shown}"
    elif flat(shown) != flat(wanted):
        yield f"OPTIONS OF {name.upper()}: the order of the help is {flat(wanted)}, that of the page {flat(shown)}"
    for example in sections.get("Examples", []):
        if example not in page.examples:
            yield f"EXAMPLES: missing: {example}"


def main():
    program, path = sys.argv[1:]
    found = list(faults(program, Page(path)))
    for fault in found:
        print(f"{path}: {fault}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
