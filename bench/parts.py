"""Parts of the measurements of bench/results: the files of each part, and the programs that write them."""
import os
import subprocess
import sys
import time
from typing import NamedTuple

import origin
from reduce_results import reduced_text

ROOT = origin.ROOT
BUILD = ROOT / "build" / "bench"
PROGRAMS = BUILD / "bench"
COMPONENTS = "build library program meshes pipeline service mpi adapters ifc python viewer viewer_tests bench".split()  # of scripts/setup
PROGRAM = BUILD / "src" / "cli" / "octopair"
STUDIES = PROGRAMS / "program" / "octopair-bench"


class Failure(Exception):
    """The measurement cannot be made."""


def say(text):
    print(f"results: {text}", file=sys.stderr, flush=True)


class Part(NamedTuple):
    what: str
    files: list      # names of its results, without .json
    targets: list    # what it builds
    measure: object  # function of a Runner


class Runner:
    """Measures parts into a folder. `quick`: measures less."""

    def __init__(self, folder, commit, quick):
        self.folder, self.commit, self.quick = folder, commit, quick
        self.configured = False
        self.where = None

    def measure(self, name):
        part = PARTS[name]
        begin = time.monotonic()
        self.build(part)
        self.where = {"commit": self.commit, **origin.machine(BUILD)}
        self.folder.mkdir(parents=True, exist_ok=True)
        say(f"measuring {name}: {part.what}")
        part.measure(self)
        say(f"measured {name} in {time.monotonic() - begin:.0f} s")

    def build(self, part):
        """Configures once, so that the programs name the commit, and builds the programs of a part."""
        subprocess.run([ROOT / "scripts" / "setup", *COMPONENTS], check=True)
        commands = [["cmake", "--build", BUILD, "--target", *part.targets]]
        if not self.configured:
            commands.insert(0, ["cmake", "-S", ROOT, "--preset", "bench"])
        for command in commands:
            through_ccache = ["bash", "-c", 'source scripts/common.sh; compile_through_ccache; exec "$@"', "bash", *command]
            done = subprocess.run(through_ccache, capture_output=True, text=True, check=False, cwd=ROOT)
            if done.returncode != 0:
                raise Failure("the build failed:\n" + (done.stdout + done.stderr)[-3000:])
        self.configured = True

    def option(self, whole, quick):
        """Returns the options of a whole or of a quick measurement as words."""
        return (quick if self.quick else whole).split()

    def run(self, name, *command, statuses=(0,), text=False, environment=None):
        """Runs a program that writes JSON to the file after `--json`, and keeps it as NAME.json. With `text`, its output is kept, too.

        The programs of comparisons end with status 1 if a contender finds other pairs: the pages mark such rows.
        """
        path = self.folder / f"{name}.partial"
        words = [str(word) for word in command] + ["--json", str(path)]
        path.unlink(missing_ok=True)
        done = self.start(words, statuses, text, environment)
        results = origin.stamped(name, path.read_text(encoding="utf-8"), self.where)
        if text:
            results["text"] = done.stdout.strip("\n").split("\n")
        path.unlink()
        self.keep(name, results)

    def run_text(self, name, *commands, environment=None):
        """Runs programs that print tables, and keeps their output as NAME.json."""
        lines = []
        for command in commands:
            lines += self.start([str(word) for word in command], (0,), True, environment).stdout.strip("\n").split("\n")
        self.keep(name, {**origin.stamped(name, "{}", self.where), "text": lines})

    def start(self, words, statuses, text, environment):
        done = subprocess.run(words, stdout=subprocess.PIPE if text else sys.stderr, text=True, check=False, cwd=ROOT,
                              env={**os.environ, **(environment or {})})
        if done.returncode not in statuses:
            raise Failure(f"{' '.join(words)} ended with status {done.returncode}")
        return done

    def keep(self, name, results):
        """Writes results completely or not at all."""
        partial = self.folder / f"{name}.partial"
        partial.write_text(reduced_text(f"{name}.json", results), encoding="utf-8")
        partial.replace(self.folder / f"{name}.json")


def measure_paper(run):
    less = "--rounds 3 --objects 100000 250000 500000 1000000"
    run.run("paper", STUDIES, "paper", *run.option("--rounds 5", less), text=True)


def measure_machines(run):
    run.run("machines", STUDIES, "paper", *run.option("--rounds 3 --machines 1 5 10 15 20", "--machines 1 5 --rounds 1 --objects 1000000"),
            text=True)


def measure_peers(run):
    subprocess.run([ROOT / "scripts" / "data", "libcgal-demo", "lammps-examples"], check=True)
    few = "--seconds 1 --scene uniform dense clustered"
    large = run.option("--rounds 5 --seconds 4", f"--rounds 1 {few}")
    small = run.option("--rounds 7 --seconds 2", f"--rounds 3 {few}")

    def compare(name, *options):
        run.run(f"peers_{name}", PROGRAMS / "octopair_compare", "--least", "1", *options, statuses=(0, 1))

    for threads in "1", "2":
        compare(f"1m_{threads}", "--objects", "1000000", "--threads", threads, *large)
        compare(f"100k_{threads}", "--objects", "100000", "--threads", threads, *small)
    compare("10k_1", "--objects", "10000", "--threads", "1", *small)
    files = run.option("data/bunny00.off data/refined_elephant.off data/nylon_melt.npy", "data/bunny00.off")
    compare("real_1", "--input", *files, "--threads", "1", *run.option("--rounds 5 --seconds 2", "--rounds 1 --seconds 1"))


def measure_frames(run):
    run.run("frames", PROGRAMS / "octopair_frames", *run.option("--seconds 20", "--quick"), statuses=(0, 1))


def measure_engines(run):
    run.run("engines", PROGRAMS / "octopair_engines", *run.option("", "--quick"), statuses=(0, 1))


def measure_exact(run):
    for threads in "1", "2":
        run.run(f"exact_objects_{threads}", PROGRAMS / "octopair_exact_objects", "--threads", threads,
                *run.option("", "--objects 1000 --rounds 3"))
    run.run("self_intersections", PROGRAMS / "octopair_self_intersections", *run.option("", "--triangles 100000 --rounds 3"))


def measure_service(run):
    run.run("service", PROGRAMS / "octopair_service", *run.option("", "--quick"))


def measure_scaling(run):
    less = "--objects 100000 --rounds 3"
    run.run("scaling", STUDIES, "scaling", "--scene", "uniform", "dense", "clustered", *run.option("--objects 1000000", less))
    run.run("scaling_weak", STUDIES, "scaling", "--weak", *run.option("--objects 1000000", less))


def measure_cluster(run):
    for name, whole, quick in (
            ("cluster", "--scene uniform clustered mixed micro20", "--objects 100000 --ranks 1 2 5 10"),
            ("cluster_sizes", "--objects 250000 500000 2000000 20000000 --ranks 1 2 4 10 16 20 30 40 64",
             "--objects 50000 200000 --ranks 1 5"),
            ("cluster_regions", "--arrangement space blocks --objects 2000000 20000000 --ranks 1 2 10 40",
             "--arrangement space blocks --objects 200000 --ranks 1 5")):
        run.run(name, STUDIES, "cluster", *run.option(f"{whole} --rounds 9", f"{quick} --rounds 3"))


def measure_scenes(run):
    run.run_text("scenes", [PROGRAMS / "scene_costs", *run.option("1000000", "100000")])


def measure_files(run):
    subprocess.run([ROOT / "scripts" / "data", "assimp-testmodels"], check=True)
    readers = f"{BUILD / 'readers' / 'bin'}:{os.environ['PATH']}"  # octopair-ifc
    run.run("files", ROOT / "bench" / "whole_runs.py", PROGRAM, *run.option("", "--quick"), environment={"PATH": readers})


def measure_adapters(run):
    quick = run.option("", "--quick")
    for name in "bullet", "cgal", "fcl":
        run.run_text(f"adapter_{name}", [PROGRAMS / f"octopair_adapter_{name}", *quick])


def measure_python(run):
    run.run("python", ROOT / "bench" / "python" / "compare.py", PROGRAMS / "liboctopair_python_calls_cpp.so",
            *run.option("", "--rounds 3 --objects 100000"), environment={"PYTHONPATH": str(BUILD / "python" / "package")})


def measure_viewer(run):
    libraries = next((ROOT / "build" / "npm").glob("*/node_modules/playwright-core")).parent  # scripts/setup viewer_tests fetched them
    run.run("viewer", "node", ROOT / "bench" / "viewer" / "first_picture.mjs", PROGRAM, *run.option("", "--quick"),
            environment={"NODE_PATH": str(libraries)})
    run.run_text("viewer_pace", [PROGRAMS / "pace", *run.option("100000 3 120", "10000 1 20")])


PARTS = {
    "paper": Part("the paper's section 5 again", ["paper"], ["octopair_bench_program"], measure_paper),
    "machines": Part("the paper's cluster, on ranks", ["machines"], ["octopair_bench_program"], measure_machines),
    "peers": Part("octopair and its peers, generated scenes and real ones",
                  [f"peers_{name}" for name in ("1m_1", "1m_2", "100k_1", "100k_2", "10k_1", "real_1")], ["octopair_compare"],
                  measure_peers),
    "frames": Part("moving scenes, frame by frame, and their peers", ["frames"], ["octopair_frames"], measure_frames),
    "engines": Part("threads and worker processes", ["engines"], ["octopair_engines", "octopair_worker"], measure_engines),
    "exact": Part("exact stages, FCL and CGAL", ["exact_objects_1", "exact_objects_2", "self_intersections"],
                  ["octopair_exact_objects", "octopair_self_intersections"], measure_exact),
    "service": Part("a server and the local engine, and many concurrent clients", ["service"], ["octopair_service"], measure_service),
    "scaling": Part("threads and ranks by wall clock, on all cores", ["scaling", "scaling_weak"], ["octopair_bench_program"],
                    measure_scaling),
    "cluster": Part("costs of a call on each of up to 64 ranks, in processor time", ["cluster", "cluster_sizes", "cluster_regions"],
                    ["octopair_bench_program"], measure_cluster),
    "scenes": Part("costs of each kind of scene", ["scenes"], ["octopair_scene_costs"], measure_scenes),
    "files": Part("whole runs of the program: models, large meshes, large scenes, verification", ["files"], ["octopair_program", "octopair_ifc"],
                  measure_files),
    "adapters": Part("adapters and their hosts", ["adapter_bullet", "adapter_cgal", "adapter_fcl"],
                     [f"octopair_adapter_{name}" for name in ("bullet", "cgal", "fcl")], measure_adapters),
    "python": Part("calls of Python, of C++ and of SciPy", ["python"], ["octopair_python", "octopair_python_calls_cpp"], measure_python),
    "viewer": Part("the first picture of the viewer, and steps of a scene with pages", ["viewer", "viewer_pace"],
                   ["octopair_program", "octopair_viewer_pace"], measure_viewer),
}
