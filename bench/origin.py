"""Origin of results: the commit, compiler, machine and dates of a measurement, under the key "measured" of each file of results."""
import datetime
import json
import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
OF_PROGRAMS = ("version", "commit", "compiler", "processor", "cores", "machine")  # what the programs of bench/ say themselves
SAME = ("version", "commit", "compiler", "processor", "cores")  # equal in all published files


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=True).stdout


def checkout():
    """Returns the last commit, with -dirty if files are changed, and the names of these files."""
    changed = [line[3:] for line in git("status", "--porcelain", "--untracked-files=all").splitlines()]
    return git("rev-parse", "--short=12", "HEAD").strip() + ("-dirty" if changed else ""), changed


def machine(build):
    """Returns version, compiler, processor and cores. `build`: a build folder."""
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    compiler = next(pathlib.Path(build).glob("CMakeFiles/*/CMakeCXXCompiler.cmake")).read_text(encoding="utf-8")
    known = {name: re.search(rf'set\(CMAKE_CXX_COMPILER_{name} "([^"]*)"', compiler)[1] for name in ("ID", "VERSION")}
    model = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    return {"version": re.search(r"project\(octopair VERSION ([\d.]+)", cmake)[1], "compiler": f"{known['ID']} {known['VERSION']}",
            "processor": model[1] if model else "unknown", "cores": os.cpu_count()}


def stamped(name, text, where):
    """Returns the results of a program with their origin. Throws: ValueError if the program names another commit."""
    results = json.loads(text)
    said = results.get("machine", results)
    commit, changed = re.fullmatch(r"(.*?)(-dirty)?", said.get("commit", "")).groups()
    if not where["commit"].startswith(commit) or (changed and not where["commit"].endswith(changed)):
        raise ValueError(f"{name}: measured at {said['commit']}, not at {where['commit']}")
    today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    rest = {key: value for key, value in results.items() if key not in OF_PROGRAMS}
    return {"measured": {"date": today, **where}, **rest}


def of(path):
    """Returns the origin of a file of results."""
    return json.loads(path.read_text(encoding="utf-8")).get("measured", {})


def differences(paths):
    """Returns a message for each difference: all files have an origin, and the same one but for the date."""
    origins = {path.name: of(path) for path in paths}
    errors = [f"{name} does not say where it was measured" for name, found in origins.items() if not set(SAME) <= set(found)]
    for key in SAME:
        values = {name: found[key] for name, found in origins.items() if key in found}
        first = next(iter(values), None)
        errors += [f"{name} has the {key} {value}, {first} has {values[first]}" for name, value in values.items() if value != values[first]]
    return errors


def sentence(path):
    """Returns a sentence that says where and when the files next to `path` were measured."""
    found, dates = of(path), sorted({of(other)["date"] for other in path.parent.glob("*.json")})
    when = dates[0] if len(dates) == 1 else f"{dates[0]} to {dates[-1]}"
    return (f"Measured on {found['processor']}, {found['cores']} cores, {when}, with {found['compiler']}: octopair {found['version']}, "
            f"commit {found['commit']}.")
