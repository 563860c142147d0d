#!/usr/bin/env python3
"""Builds and tests the stages of scripts/test.

    run_stages.py --set-up STATUS SECONDS [--all | --long | STAGE...]

STATUS and SECONDS are the exit status of scripts/setup and its time. The default is the stage release.

The stages of a preset share a build. The builds run one after another, with low priority; as soon as a build is finished, its stages
are tested, two at a time. So a stage whose tests wait leaves no core idle. Then come the stages of ranks and `timing`, each alone.
"""
import argparse
import dataclasses
import os
import pathlib
import subprocess
import sys
import threading
import time

import budget
import test_results

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
CORES = os.cpu_count() or 1


@dataclasses.dataclass(frozen=True)
class Stage:
    """Tests of one build.

    preset: also the name of the build folder.
    labels: options of ctest, which select tests by their labels (tests/CMakeLists.txt).
    targets: what to build; nothing stands for everything.
    scenes: numbers of small and of large scenes for the tests of exactness.
    share: number of cases of other random tests, in per cent of the usual number.
    options: what to turn on when the build is configured.
    compiled: options of the compiler for everything but tests and benchmarks.
    from_source: packages are compiled with their own options (tests/packaging/release_objects.sh).
    """
    preset: str
    labels: tuple
    targets: tuple = ()
    scenes: tuple = (1000, 4)
    share: int = 50
    options: tuple = ()
    compiled: str = ""
    from_source: bool = False


EXACTNESS = ("octopair_exactness_test", "octopair_exactness_workers_test", "octopair_mpi_test")
PYTHON = ("OCTOPAIR_WITH_PYTHON",)
READERS = ("OCTOPAIR_WITH_IFC", "OCTOPAIR_WITH_STEP")
# The packages and the wheel take the objects of this build (tests/packaging/release_objects.sh), and one check reads debug information.
DEBUG = "-g -fno-var-tracking"
STAGES = {
    # The package tests take longest, and mostly wait for each other, so they begin first.
    "packages": Stage("release", ("-L", "packages"), ("octopair_packaged",), compiled=DEBUG),
    "release": Stage("release", ("-L", "quick"), scenes=(2000, 8), share=100),
    "slow": Stage("release", ("-L", "slow"), options=READERS),
    "python": Stage("release", ("-L", "python"), options=PYTHON, compiled=DEBUG),
    "viewer": Stage("release", ("-L", "viewer"), options=PYTHON),
    "install": Stage("release", ("-L", "install")),
    "docs": Stage("release", ("-L", "docs"), ("octopair_documented",), options=PYTHON + READERS),
    "bench": Stage("release", ("-L", "bench"), options=("OCTOPAIR_BUILD_BENCHMARKS",)),
    "checks": Stage("clang", ("-L", "checks"), ("octopair_messages", "octopair_page")),
    "clang": Stage("clang", ("-L", "quick", "-LE", "skip_clang"),
                   ("octopair_base_test", "octopair_boxes_test", "octopair_engine_test", *EXACTNESS, "octopair_geometry_test",
                    "octopair_narrow_phase_test", "octopair_processes_test", "octopair_thickness_test", "octopair_viewer_test"),
                   (20000, 60), 100),
    "asan": Stage("asan", ("-L", "quick|slow", "-LE", "skip_asan"), scenes=(10000, 20), share=25, options=PYTHON),
    "fuzz": Stage("asan", ("-L", "fuzz"), ("octopair_fuzzers",)),
    "tsan": Stage("tsan", ("-L", "quick", "-LE", "skip_tsan"),
                  ("octopair_base_test", "octopair_engine_test", "octopair_octree_test", "octopair_parallel_test",
                   "octopair_pipeline_test", "octopair_scene_test", "octopair_viewer_test")),
    # Ranks that wait poll, and each of their messages waits for all other processes: beside other stages they would cost three times as much.
    "ranks": Stage("release", ("-L", "ranks")),
    "asan-ranks": Stage("asan", ("-L", "ranks", "-LE", "skip_asan"), ("octopair_bench_program", "octopair_mpi_test", "octopair_program"),
                        (10000, 20), 25),
    "clang-ranks": Stage("clang", ("-L", "ranks", "-R", "on_[12]_ranks"), ("octopair_mpi_test",), (20000, 60), 100),
    "timing": Stage("release", ("-L", "timing"), options=PYTHON),
}
LONG_STAGES = {f"long-{preset}": Stage(preset, ("-L", "exactness"), EXACTNESS, (1000000, 2000), 100)
               for preset in ("release", "clang")}
LONG_STAGES["long-files"] = Stage("release", ("-L", "generated"), ("octopair_io_test",), share=2000)
LONG_STAGES["long-near-misses"] = Stage("release", ("-L", "near_miss"),
                                        ("octopair_near_miss_reader", "octopair_program", "octopair_change_at_call"), share=5000)
LONG_STAGES["long-assemblies"] = Stage("release", ("-L", "assemblies"), ("octopair_program",))
LONG_STAGES["long-packages"] = dataclasses.replace(STAGES["packages"], from_source=True)
ALONE = ("ranks", "clang-ranks", "asan-ranks", "timing")


class Costs:
    """Seconds and processor seconds of a part of a stage, and the exit status of its command."""

    def __init__(self):
        self.seconds = self.processor = 0.0
        self.status = 0

    def add(self, command, log, nice=0, environment=None):
        """Runs a command, whose output is appended to a file or shown if `log` is None. Returns whether it succeeded."""
        begin = time.monotonic()
        output = open(log, "ab") if log else None  # closed after the process has it
        process = subprocess.Popen(["nice", "-n", str(nice), *command], cwd=ROOT, stdout=output, stderr=subprocess.STDOUT if output else None,
                                   env={**os.environ, **(environment or {})})
        if output:
            output.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.seconds += time.monotonic() - begin
        self.processor += usage.ru_utime + usage.ru_stime
        self.status = self.status or process.returncode
        return process.returncode == 0


def build_options(stages):
    """Returns the options of CMake for a build of stages that share a preset."""
    on = {option for stage in stages for option in stage.options}
    # All builds have the viewer, so that no stage compiles the program again. They also have the parts that scripts/run leaves out.
    parts = ("OCTOPAIR_BUILD_TESTS", "OCTOPAIR_WITH_VIEWER", "OCTOPAIR_WITH_SERVICE", "OCTOPAIR_WITH_MPI")
    return [*(f"-D{option}=ON" for option in parts),
            *(f"-D{option}={'ON' if option in on else 'OFF'}" for option in ("OCTOPAIR_BUILD_BENCHMARKS", *PYTHON, *READERS)),
            f"-DCMAKE_CXX_FLAGS={max(stage.compiled for stage in stages)}"]


def show(log):
    """Prints a file of output."""
    sys.stdout.flush()
    with open(log, "rb") as file:
        sys.stdout.buffer.write(file.read())
    sys.stdout.flush()


class Run:
    """All builds and tests of one run.

    Thread safety: builds run in one thread, tests in others; `changed` guards what they share."""

    def __init__(self, names):
        self.stages = {name: {**STAGES, **LONG_STAGES}[name] for name in names}
        self.begin = time.time()
        self.presets = list(dict.fromkeys(stage.preset for stage in self.stages.values()))
        self.builds = {preset: Costs() for preset in self.presets}
        self.tests = {name: Costs() for name in names}
        self.built = set()
        self.waiting = [name for name in names if name not in ALONE]
        self.changed = threading.Condition()
        self.several = len(names) > 1

    def everything(self):
        """Runs all builds and tests."""
        threads = [threading.Thread(target=self.build_all)]
        threads += [threading.Thread(target=self.test_some) for _ in range(min(2, len(self.waiting)))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for name in ALONE:
            if name in self.stages:
                self.test(name)

    def build_all(self):
        for preset in self.presets:
            self.build(preset)
            with self.changed:
                self.built.add(preset)
                self.changed.notify_all()

    def build(self, preset):
        """Configures and builds what the stages of a preset need."""
        stages = [stage for stage in self.stages.values() if stage.preset == preset]
        targets = [] if any(not stage.targets for stage in stages) else sorted({name for stage in stages for name in stage.targets})
        log = BUILD / "results" / f"build-{preset}.log"
        log.unlink(missing_ok=True)
        costs = self.builds[preset]
        nice = 10 if self.several else 0
        built = costs.add(["cmake", "-S", str(ROOT), "--preset", preset, *build_options(stages)], log)
        if built:
            built = costs.add(["cmake", "--build", str(BUILD / preset), *(["--target", *targets] if targets else [])],
                              log if self.several else None, nice)
        # Lists the tests, so that stages which are tested at the same time do not.
        if built:
            built = costs.add(["ctest", "--test-dir", str(BUILD / preset), "--show-only"], log, nice)
        with self.changed:
            print(f"\n{preset} {'is built' if built else 'did not build'}, {costs.seconds:.0f} s", flush=True)
            if not built:
                show(log)

    def test_some(self):
        """Tests one stage after another whose build is finished, until none is left."""
        while True:
            with self.changed:
                while self.waiting and not (ready := [name for name in self.waiting if self.stages[name].preset in self.built]):
                    self.changed.wait()
                if not self.waiting:
                    return
                name = ready[0]
                self.waiting.remove(name)
            self.test(name)

    def test(self, name):
        """Runs the tests of a stage; its output comes when it is finished, unless it is the only stage."""
        stage = self.stages[name]
        if self.builds[stage.preset].status:
            return
        log = BUILD / "results" / f"{name}.log" if self.several else None
        if log:
            log.unlink(missing_ok=True)
        small, large = stage.scenes
        environment = {"OCTOPAIR_TEST_SMALL_SCENES": str(small), "OCTOPAIR_TEST_LARGE_SCENES": str(large),
                       "OCTOPAIR_TEST_SHARE": str(stage.share), "OCTOPAIR_TEST_FROM_SOURCE": str(int(stage.from_source))}
        # Many tests mostly wait: more of them run at a time than there are cores.
        at_a_time = (2 if self.several else 3) * CORES
        self.tests[name].add(["ctest", "--test-dir", str(BUILD / stage.preset), "-j", str(at_a_time), "--output-on-failure", "--timeout", "600",
                              "--output-junit", str(test_results.file_of(name)), *stage.labels],
                             log, environment={**environment, **{key: os.environ[key] for key in environment if key in os.environ}})
        if log:
            with self.changed:
                print(f"\nstage {name}")
                show(log)


def parse(words):
    """Returns the status and the time of the set-up, and the names of the stages."""
    parser = argparse.ArgumentParser(prog="scripts/test", description="Sets up, builds and tests octopair.")
    parser.add_argument("--set-up", nargs=2, type=int, metavar=("STATUS", "SECONDS"), help=argparse.SUPPRESS, default=(0, 0))
    parser.add_argument("--all", action="store_true", help="all stages except the long ones")
    parser.add_argument("--long", action="store_true", help="the long stages")
    parser.add_argument("stages", nargs="*", metavar="STAGE", help=", ".join([*STAGES, *LONG_STAGES]))
    arguments = parser.parse_args(words)
    for name in arguments.stages:
        if name not in STAGES and name not in LONG_STAGES:
            parser.error(f"no stage '{name}'; there are: {' '.join([*STAGES, *LONG_STAGES])}")
    wanted = arguments.stages or ([*STAGES] if arguments.all else [*LONG_STAGES] if arguments.long else ["release"])
    # In the order of the table, because stages that begin early take long.
    return arguments.set_up, [name for name in [*STAGES, *LONG_STAGES] if name in wanted]


def main(words):
    (set_up_status, set_up_seconds), names = parse(words)
    (BUILD / "results").mkdir(parents=True, exist_ok=True)
    for name in names:
        test_results.file_of(name).unlink(missing_ok=True)
    run = Run(names)
    speed = budget.speed_of_machine()
    run.everything()

    results = {name: test_results.Results(name, BUILD / stage.preset, run.begin) for name, stage in run.stages.items()}
    failed = sum(len(result.failed) for result in results.values()) + (set_up_status != 0)
    # A build that fails, or a stage without results, counts as one failure.
    failed += sum(costs.status != 0 for costs in run.builds.values())
    for name, result in results.items():
        if not result.cases and not run.builds[run.stages[name].preset].status:
            failed += 1
    if failed:
        for result in results.values():
            result.print_failed()
    test_results.print_costs(run, list(results.values()))
    if not budget.print_comparison(run, speed) and not failed:
        failed += 1
    print(f"\n  set-up {'passed' if set_up_status == 0 else 'failed'}, {set_up_seconds} s\n"
          f"  in all {set_up_seconds + time.time() - run.begin:.0f} s\n")
    passed, skipped = (sum(getattr(result, kind) for result in results.values()) for kind in ("passed", "skipped"))
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
