"""Reads the results of ctest and GoogleTest, and prints what failed and what was expensive.

ctest writes a JUnit file for each stage: build/results/STAGE.xml. A process that runs several tests of GoogleTest writes the
outcome and the processor seconds of each (tests/support/main.cpp): build/PRESET/Testing/cases/NAME.xml, where NAME is the name of the
test of ctest.
"""
import collections
import dataclasses
import heapq
import pathlib
import xml.etree.ElementTree as ElementTree

BUILD = pathlib.Path(__file__).resolve().parent.parent / "build"
LAST_LINES = 40  # printed lines of the output of a failed test
MOST = 10        # rows of each list


def file_of(stage):
    """Returns the file in which ctest writes the results of a stage."""
    return BUILD / "results" / f"{stage}.xml"


@dataclasses.dataclass
class Case:
    """A test of GoogleTest, or another test of ctest, whose processor seconds are not known."""
    name: str
    program: str
    outcome: str        # passed, failed or skipped
    seconds: float
    processor: float | None = None
    output: str = ""


def parsed(file):
    """Returns the root of an XML file, or None if the file is missing or damaged."""
    try:
        return ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError):
        return None


def processor_seconds(element):
    """Returns the property that tests/support/main.cpp records, or 0. GoogleTest writes a property of all tests as an attribute."""
    if "processor_seconds" in element.attrib:
        return float(element.get("processor_seconds"))
    return sum(float(one.get("value")) for one in element.iter("property") if one.get("name") == "processor_seconds")


def outcome_in_ctest(case):
    """Returns the outcome of a test of ctest. A test without a built program, which ctest reports as skipped, has failed."""
    if case.get("status") == "run":
        return "passed"
    skipped = case.find("skipped")
    missing = skipped is not None and skipped.get("message", "").startswith("Unable to find")
    return "failed" if missing or case.get("status") not in ("notrun", "disabled") else "skipped"


def outcome_in_googletest(case):
    if case.find("failure") is not None:
        return "failed"
    return "skipped" if case.find("skipped") is not None or case.get("status") == "notrun" else "passed"


class Results:
    """The results of a stage: every test, and the processor seconds that the starts of GoogleTest's programs took.

    Files written before `begin` (seconds since 1970) are of earlier runs."""

    def __init__(self, stage, build, begin):
        self.stage, self.cases, self.starts = stage, [], 0.0
        root = parsed(file_of(stage))
        for case in root.iter("testcase") if root is not None else ():
            file = build / "Testing/cases" / (case.get("name").replace("/", "_") + ".xml")
            several = parsed(file) if file.is_file() and file.stat().st_mtime >= begin else None
            self.add(case, several)

    def add(self, case, several):
        """Adds a test of ctest; `several`: what GoogleTest wrote about the tests in it, or None."""
        name, outcome = case.get("name"), outcome_in_ctest(case)
        program = name.split(".")[0]
        if several is not None:
            self.starts += processor_seconds(several) if "processor_seconds" in several.attrib else 0
            found = [Case(f"{one.get('classname')}.{one.get('name')}", program, outcome_in_googletest(one), float(one.get("time", 0)),
                          processor_seconds(one), "\n".join(failure.text or "" for failure in one.iter("failure")))
                     for one in several.iter("testcase")]
            self.cases += found
            # A process may fail although its tests pass, for example because memory leaks.
            if outcome == "failed" and not any(one.outcome == "failed" for one in found):
                several = None
        if several is None:
            self.cases.append(Case(name, program, outcome, float(case.get("time", 0)), output=case.findtext("system-out") or ""))

    def count(self, outcome):
        return sum(case.outcome == outcome for case in self.cases)

    @property
    def failed(self):
        return [case for case in self.cases if case.outcome == "failed"]

    @property
    def passed(self):
        return self.count("passed")

    @property
    def skipped(self):
        return self.count("skipped")

    def print_failed(self):
        for case in self.failed:
            print(f"\n{self.stage}: {case.name} failed")
            for line in case.output.rstrip().splitlines()[-LAST_LINES:]:
                print(f"    {line}")


def compiled(build, begin):
    """Yields (seconds, target, file) of each file that was compiled since `begin`, from ninja's log."""
    log = build / ".ninja_log"
    lines = log.read_text(encoding="utf-8").splitlines()[1:] if log.is_file() else []
    for start, end, written, output, _ in (line.split("\t") for line in lines):
        if output.endswith(".o") and int(written) / 1e9 >= begin and ".dir/" in output:
            target, file = output.split("/CMakeFiles/", 1)[1].split(".dir/", 1)
            yield (int(end) - int(start)) / 1000, target, f"{target}: {file.removesuffix('.o')}"


def print_most(title, costs):
    """Prints the largest of a mapping of names to processor seconds."""
    print(f"\n{title}")
    for name, cost in heapq.nlargest(MOST, costs.items(), key=lambda item: item[1]):
        print(f"  {cost:7.1f}  {name}")


def print_compiling(run):
    """Prints the most expensive targets and files. Ninja knows only how long each file took, so a file gets this share of the build's
    processor seconds."""
    targets, files = collections.Counter(), collections.Counter()
    for preset, costs in run.builds.items():
        found = list(compiled(BUILD / preset, run.begin))
        share = costs.processor / (sum(seconds for seconds, _, _ in found) or 1)
        for seconds, target, file in found:
            targets[f"{preset}: {target}"] += min(1, share) * seconds
            files[f"{preset}: {file}"] += min(1, share) * seconds
    print_most("compiling, by target", targets)
    print_most("compiling, by file", files)


def print_testing(results):
    """Prints the most expensive programs and tests. Tests that are not GoogleTest's count with their seconds."""
    programs, tests = collections.Counter(), collections.Counter()
    for result in results:
        for case in result.cases:
            cost = case.seconds if case.processor is None else case.processor
            mark = " (seconds)" if case.processor is None else ""
            programs[f"{result.stage}: {case.program}{mark}"] += cost
            tests[f"{result.stage}: {case.name}{mark}"] += cost
    print_most("testing, by program", programs)
    print_most("testing, by test", tests)


def print_costs(run, results):
    """Prints where the time went: by build and stage, then the most expensive targets, files, programs and tests."""
    print("\nprocessor seconds, and seconds from the beginning to the end, of each build and each stage:\n\n"
          "              processor  seconds")
    for preset, costs in run.builds.items():
        print(f"  build {preset:<8}{costs.processor:8.0f} {costs.seconds:8.0f}")
    print("\n              processor  starts   tests   other  seconds  waiting")
    for result in results:
        costs = run.tests[result.stage]
        tests = sum(case.processor or 0 for case in result.cases)
        # Tests wait for events, and for a free core.
        waiting = sum(max(0, case.seconds - case.processor) for case in result.cases if case.processor is not None)
        print(f"  {result.stage:<12}{costs.processor:9.0f}{result.starts:8.0f}{tests:8.0f}"
              f"{max(0, costs.processor - tests - result.starts):8.0f}{costs.seconds:9.0f}{waiting:9.0f}")
    print_compiling(run)
    print_testing(results)
