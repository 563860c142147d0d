"""The figures that pages and public headers may have, for tools/figures.py.

A figure has phrases, in which `{}` stands for its value. A phrase is long enough that no other number fits into it.

    Measured   computed from a file in docs/results; `tools/figures.py --write` puts new values into the pages
    Constant   read from the source or test that enforces it
    Stated     a definition, an example or a value of another system, with the reason why nothing in this project enforces it

To add a figure, add it to one of the three lists at the end of this file.
"""
import dataclasses
import fractions
import json
import re
from collections.abc import Callable

Number = fractions.Fraction


@dataclasses.dataclass
class Measured:
    """`function` computes the value, a text or a number, from the content of `source`."""
    name: str
    source: str
    function: Callable
    phrases: list[str]

    def value(self, root):
        return self.function(json.loads((root / self.source).read_text(encoding="utf-8")))


@dataclasses.dataclass
class Constant:
    """`pattern` finds a number in `source`, and `convert` gives it the unit of the phrases."""
    name: str
    source: str
    pattern: str
    phrases: list[str]
    convert: Callable = Number

    def value(self, root):
        match = re.search(self.pattern, (root / self.source).read_text(encoding="utf-8"))
        if not match:
            raise LookupError(f"no text like '{self.pattern}'")
        return self.convert(Number(re.sub("[',]", "", match[1])))


@dataclasses.dataclass
class Stated:
    """Texts without a source."""
    reason: str
    phrases: list[str]


def thousandth(number):
    """Returns seconds of milliseconds."""
    return number / 1000


def step_share(frames):
    """Returns the share of a full detection's time that a step takes: 1,000,000 objects, 1 in 1,000 moved, one thread, medians."""
    case = next(case for case in frames["results"]
                if (case["objects"], case["share"], case["threads"]) == (1_000_000, 0.001, 1))
    seconds = {row["tracker"]: row["median_seconds"] for row in case["rows"]}
    return f"1/{seconds['full detection'] / seconds['scene']:.2g}"


def region_bytes(cluster):
    """Returns the least and the greatest bytes that ranks send for each object, with neighbouring objects on each of 10 or more ranks."""
    sent = [run["bytes_sent"] / run["objects"] for run in cluster["runs"] if run["ranks"] >= 10]
    return f"{max(1, round(min(sent)))} to {round(max(sent))}"


def octree_against_own(model):
    """Returns how many times as long as their own objects the octree takes 512 ranks with 10^10 objects, by the model."""
    head, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in model["model_far"].splitlines()]
    row = next(dict(zip(head, row)) for row in rows if row[:2] == ["10^10", "512"])
    own, octree = (float(row[name].replace(",", "")) for name in ("ms: own objects", "the octree"))
    return Number(round(octree / own))


RESULTS = "docs/results/"
MEASURED = [
    Measured("step with 1 in 1,000 of a million objects moved / full detection", RESULTS + "frames.json", step_share,
             ["a step costs about {} of a full detection"]),
    Measured("bytes that ranks send for each object of their own region", RESULTS + "cluster_regions.json", region_bytes,
             ["nothing is sent: {} bytes an object"]),
    Measured("octree / own objects on 512 ranks", RESULTS + "model.json", octree_against_own,
             ["10^10 objects on 512 ranks they would take {} times as long"]),
]
CONNECTIONS = "src/service/server/net/connection_watch.hpp"
CONTEXT = "src/service/server/server_context.cpp"
SCHEDULER = "src/service/server/jobs/job_scheduler.hpp"
LIMITS = "src/service/server/server_options.hpp"
TIMEOUTS = "src/engine/processes/worker_timeouts.hpp"
TUNING = "src/base/tuning.hpp"
CONSTANTS = [
    # Times of calls
    Constant("cancellation", "tests/support/cancel_time.hpp", r"cancel_patience\(sanitized \? \d+ : (\d+)\)",
             ["within {} ms after a stop request", "a running one within {} ms", "running job ends within {} ms",
              "Ctrl-C ends a call within {} ms", "Within {} ms after Ctrl-C", "calls below have {} ms in `Cancel`"]),
    Constant("cancellation in the tests of Python", "tests/python/test_interrupts.py", r"MOST_DELAY = ([\d.]+)", ["The test allows {} s"]),
    Constant("wait for a cancelled job", "src/service/server/calls/job_calls.cpp", r"double seconds = (\d+)",
             ["waits at most {} s until it has ended"]),
    Constant("counting of pairs that are too many", TUNING, r"counting_seconds = (\d+)", ["Counting takes at most about {} seconds"]),
    # Worker processes
    Constant("replacement of a worker", "tests/processes/timing_test.cpp", r"patience\(sanitized \? \d+ : (\d+)\)",
             ["notices within {} second", "killed within {} second, and replaced", "replaced within {} second"], thousandth),
    Constant("interval between checks of workers", TIMEOUTS, r"check_interval\((\d+)\); +///< interval between checks of the workers",
             ["by the pidfd within {} ms"]),
    Constant("end of workers: two checks of the client", TIMEOUTS, r"client_check_interval\((\d+)\)",
             ["within {} seconds after the application"], lambda milliseconds: 2 * milliseconds / 1000),
    Constant("address space for each shared file", "src/engine/processes/shared_memory/shared_memory.cpp", r"RLIMIT_AS\) / (\d+)",
             ["{} times the need of the largest file"]),
    # Memory
    Constant("search on threads", "tests/engine/large_test.cpp", r"EXPECT_LE\(bytes, (\d+)\)",
             ["a search on threads | at most {} per object"]),
    Constant("search in worker processes", "bench/engines/memory.hpp", r"max_engine_bytes = (\d+)",
             ["about {} per object with the copy of its box"]),
    Constant("object of a scene", "tests/scene/steady_test.cpp", r"bytes, (\d+) \* double\(objects\)", ["| a `Scene` | {} per object"]),
    Constant("pair of a scene", "tests/scene/steady_test.cpp", r"\+ (\d+) \* double\(pairs\)", ["per object and {} per pair; with slack"]),
    Constant("search of a server", CONTEXT, r"working_bytes = (\d+)", ["its pairs, and {} per object for the search"]),
    Constant("box of the check", "src/verification/box_tree.hpp", r"float32: (\d+) bytes a box", ["`Options::verify` | {} per object"]),
    Constant("box of the check, float64", "src/verification/box_tree.hpp", r"float64: (\d+) bytes",
             ["per object ({} for float64), 12 more"]),
    Constant("sums of the check", "src/verification/result_check.hpp", r"Memory: (\d+) bytes an object",
             ["for float64), {} more in octal order"]),
    Constant("entries of an object", "tests/engine/large_test.cpp", r"entries, (\d+) \* objects",
             ["the linear octree; at most {} per object"]),
    Constant("unchecked results", TUNING, r"unchecked_bytes = 1 << (\d+)",
             ["Lists and files of {} MiB or more"], lambda bits: 2 ** (bits - 20)),
    Constant("least memory for pairs", TUNING, r"min_buffer_bytes = 1 << (\d+)", ["{} MiB at least is used", "for pairs, at least {} MiB"],
             lambda bits: 2 ** (bits - 20)),
    Constant("array of a stream", "python/src/jobs.cpp", r"most = 1u << (\d+)",
             ["uint32, at most {} MiB each"], lambda bits: 2 ** (bits - 20)),
    Constant("alignment", "src/base/memory.cpp", r"alignment = (\d+);", ["aligned to {} bytes"]),
    Constant("box", "src/scene/recording/recording.hpp", r"sizeof\(Box3f\) == (\d+)", ["with the copy of its box; {} more for float64"]),
    Constant("entry", "src/boxes/entry.hpp", r"sizeof\(CellEntry\) == (\d+)",
             ["entry of an octree | {} |", "a `CellEntry` of {} bytes", "entries, of {} bytes, are sent", "bit for bit, {} bytes each"]),
    Constant("whole entry", "src/boxes/entry.hpp", r"sizeof\(Entry\) == (\d+)", ["whole entry, in a small crowd | {} |"]),
    Constant("chunk: entries of 16 bytes", TUNING, r"max_chunk = (\d+)",
             ["chunk of a list of entries | up to {} |"], lambda entries: 16 * entries),
    Constant("pair", "src/scene/recording/recording.hpp", r"sizeof\(Pair\) == (\d+)",
             ["a pair of a list | {};", "| pair | {} |", "and {} bytes for each pair are subtracted", "receives {} bytes per pair that began"]),
    Constant("block of a scene's octree", "src/octree/dynamic/small_block.hpp", r"sizeof\(SmallBlock\) == (\d+)",
             ["scene's octree | {} |"]),
    Constant("piece of pairs", "src/service/protocol/messages.hpp", r"piece_bytes = std::size_t\((\d+)\) << 20",
             ["kept in pieces of {} MiB"]),
    Constant("message of ranks", "src/engine/mpi/comm/communicator.hpp", r"max_message_bytes = std::size_t\(1\) << (\d+)",
             ["messages of at most {} gibibyte"], lambda bits: 2 ** (bits - 30)),
    # The octree
    Constant("quantiles of a sample", "src/octree/plan/space.cpp", r"between the (\d+/\d+) quantiles", ["the {} quantiles"]),
    Constant("widening of a space", "src/octree/plan/space.cpp", r"lows\.quantile\) / (\d+)",
             ["quantiles, widened by {}"], lambda part: 1 / part),
    Constant("crowded octant", TUNING, r"always_above = (\d+)", ["it has over {} objects, or over"]),
    Constant("octant that stays whole", TUNING, r"never_up_to = (\d+)", ["objects, or over {} of which"]),
    Constant("tests for an object", TUNING, r"max_tests_per_object = (\d+)", ["would test over {} for each"]),
    Constant("growth of a nested octree", TUNING, r"max_growth = (\d+);", ["must be at most {} entries for each of the join"]),
    Constant("objects for a worker", TUNING, r"objects_per_worker = (\d+)", ["one worker for each {} objects"]),
    Constant("entries below an octant", TUNING, r"max_entries_per_object = ([\d.]+)", ["would grow past {} for each object"]),
    Constant("octant of a nested octree", TUNING, r"max_part_in_octant = ([\d.]+)", ["at most {} of the entries"]),
    Constant("aborted step", "src/scene/scene_step.cpp", r"abort_cost = (\d+)", ["search takes {} times as long as a full detection"]),
    Constant("built octree of a scene", "src/scene/scene_step.cpp", r"max_rebuild_cost = ([\d.]+)",
             ["less than {} of the time of a full detection"]),
    Constant("search around changes", "src/scene/scene_step.cpp", r"max_search_cost = ([\d.]+)", ["should take less than {} of the time"]),
    Constant("logged changes", TUNING, r"log_part = ([\d.]+)", ["Changes of more than {} of the objects"]),
    Constant("changes of a list", TUNING, r"waiting_part = (\d+)", ["the changes have become {} of the list"], lambda part: 1 / part),
    # The server
    Constant("first call", CONNECTIONS, r"greeting\{(\S+?)\}", ["that is admitted within {} seconds"], thousandth),
    Constant("bytes before the first call", CONNECTIONS, r"max_bytes = (\d+) << 10", ["may send at most {} KiB"]),
    Constant("slow connections", CONNECTIONS, r"remembered\{(\S+?)\}", ["more slowly for {} seconds"], thousandth),
    Constant("rate of slow connections", CONNECTIONS, r" interval\{(\d+)\}",
             ["seconds: {} per second"], lambda milliseconds: 1000 / milliseconds),
    Constant("unknown connections", "src/service/server/net/connection_watch.cpp", r"at_least, most / (\d+)\) \|\|",
             ["at most {} of `--max-connections`"], lambda part: 1 / part),
    Constant("unknown connections of an address", "src/service/server/net/connection_watch.cpp",
             r"same >= std::max\(at_least, most / (\d+)\)", ["and {} for one address"], lambda part: 1 / part),
    Constant("rate of resets", CONNECTIONS, r"resets_per_second = (\d+)", ["more than {} a second for long"]),
    Constant("pause after a cut", CONNECTIONS, r"pause\{(\d+)\}", ["For {} second after the cut"], thousandth),
    Constant("token", "src/service/server/net/token_file.cpp", r"shortest_token = (\d+)", ["A token has at least {} bytes"]),
    Constant("part of the machine's memory", "src/cli/server/serving.cpp", r"/ 4 \* (\d)\)", ["at most {} of the memory of the machine"],
             lambda quarters: quarters / 4),
    Constant("memory of the server itself", "src/cli/server/serving.cpp", r"fixed = std::uint64_t\((\d+)\) << 20",
             ["control group, less {} MiB"]),
    Constant("memory of gRPC", "src/service/server/server.cpp", r"transport_bytes = std::size_t\((\d+)\) << 20",
             ["gRPC takes up to {} MiB"]),
    Constant("kept arrays", "src/service/server/jobs/array_pool.cpp", r"max_spare_bytes = std::uint64_t\((\d+)\) << 20",
             ["input take up to {} MiB"]),
    Constant("pairs in order", CONTEXT, r"max_small_objects \? \d+ : (\d+)\) << 20", ["put in order: up to {} MiB"]),
    Constant("pairs in order, small jobs", CONTEXT, r"max_small_objects \? (\d+) : \d+\) << 20", ["({} MiB for each engine of small jobs"]),
    Constant("pairs in order, part of the memory", CONTEXT, r"memory_bytes / (\d+)", ["or {} of `--max-memory`"], lambda part: 1 / part),
    Constant("idle engines", SCHEDULER, r"idle_before_renewal\((\d+)\)", ["idle for {} seconds"]),
    Constant("end of a server on ranks", "src/cli/server/rank_serving.cpp", r"drain_timeout\((\d+)\)",
             ["At most {} seconds later the server ends"]),
    Constant("watchdog of systemd", "cmake/octopair_install.cmake", r"WatchdogSec=(\d+)", ["reports twice in {} seconds"]),
    Constant("memory of the service", "packaging/octopair.service", r"MemoryMax=(\d+)G", ["has {} GiB of memory (`MemoryMax`"]),
    Constant("checks of deadlines", "src/service/server/jobs/watchdog.cpp", r"poll_interval\((\d+)\)",
             ["checks deadlines {} times a second"],
             lambda milliseconds: 1000 / milliseconds),
    Constant("kept results", LIMITS, r"keep\{(\d+) \* 3600\}", ["A result stays for {} day (`--keep`)"],
             lambda hours: hours / 24),
    Constant("patience", "include/octopair/client.hpp", r"patience = std::chrono::seconds\((\d+)\)", ["at most `--patience` ({} s)"]),
    Constant("first contact", "include/octopair/client.hpp", r"connect_timeout = std::chrono::seconds\((\d+)\)",
             ["stops waiting after {} s"]),
    Constant("silent network: time and timeout of keepalive", "src/service/client/connection.cpp", r"KEEPALIVE_TIME_MS, (\S+)\)",
             ["detects this within {} s"], lambda milliseconds: 2 * milliseconds / 1000),
    Constant("copies of a watched scene", "src/service/server/scenes/scene_publisher.hpp", r"min_interval\{(\d+)\}",
             ["a scene at most once in {} ms"]),
    Constant("time of copies of a watched scene", "src/service/server/scenes/scene_publisher.hpp", r"intervals_per_copy = (\d+)",
             ["for at most {} of the scene's time"], lambda part: 1 / part),
    # The server's limits
    Constant("objects of a job", LIMITS, r"objects = (\S+);", ["objects of a job or a scene | {} |"]),
    Constant("input of a job", LIMITS, r"input_bytes = std::uint64_t\((\d+)\) << 30", ["bytes of a job's input | {}G |"]),
    Constant("pairs of a job", LIMITS, r" pairs = (\S+);", ["result, or of a scene | {} |"]),
    Constant("jobs", LIMITS, r" jobs = (\d+);", ["have not ended, and scenes, together | {} |"]),
    Constant("jobs of a client", LIMITS, r"jobs_per_client = (\d+);", ["jobs and scenes, of one client | {} |"]),
    Constant("connections", LIMITS, r" connections = (\d+);", ["open files allows (`ulimit -n`, hard limit), and logs this | {} |"]),
    Constant("seconds of a job", LIMITS, r"job_seconds = (\d+);", ["seconds that a job runs | {} |"]),
    Constant("memory of jobs", LIMITS, r" memory_bytes = std::uint64_t\((\d+)\) << 30", ["its control group has, and logs this | {}G |"]),
    Constant("state folder", LIMITS, r"state_bytes = std::uint64_t\((\d+)\) << 30", ["bytes of the state folder | {}G |"]),
    Constant("stalled client", LIMITS, r"stall\{(\d+)\}", ["or to read its next message; at least 1 | {} |"]),
    Constant("end of a server", LIMITS, r"grace\{(\d+)\}", ["`--grace` seconds (default {})"]),
    Constant("calls of a client", CONTEXT, r"tells_clients_apart\(given\) \? (\d+)", ["calls of one client at a time | {},"]),
    Constant("small jobs", SCHEDULER, r"max_small_objects = (\d+)", ["Jobs of at most {} objects have engines"]),
    Constant("instant jobs", SCHEDULER, r"max_instant_objects = (\d+)", ["Up to {} objects a job takes less"]),
    Constant("refused calls", CONNECTIONS, r"max_refused_calls = (\d+)", ["and {} refused calls before"]),
    Constant("open calls", CONNECTIONS, r"max_open_calls = (\d+)", ["more than {} of its calls have begun"]),
    Constant("open calls of HTTP/2", "src/service/server/server.cpp", r"MAX_CONCURRENT_STREAMS, (\d+)",
             ["of which HTTP/2 lets {} be open"]),
    Constant("resets at once", CONNECTIONS, r"max_resets = (\d+)", ["connections together reset {} calls"]),
    Constant("tolerated resets", CONNECTIONS, r"tolerated_resets = (\d+)", ["with at most {} such calls lately"]),
    # The viewer
    Constant("frames a second", "include/octopair/view.hpp", r"frames_per_second = (\d+)", ["the boxes at most {} times a second"]),
    Constant("time of copies", "src/viewer/live/view.cpp", r"largest_share = (\d+)",
             ["takes at most {} of the time"], lambda part: 1 / part),
    Constant("drawn objects", "src/viewer/live/live_feed.hpp", r"default_most_shown = (\S+);",
             ["more than {} objects, the page draws", "more than {} objects, those"]),
    Constant("drawn objects of files", "src/viewer/scene/frame_source.hpp", r"default_most_shown = (\S+);",
             ["Of more than {} objects, the page draws an overview"]),
    Constant("exported page", "src/viewer/scene/page_file.hpp", r"max_page_bytes = std::uint64_t\((\d+)\) << 20",
             ["page has at most {} MiB", "page, of at most {} MiB"]),
    Constant("frames of all pages", "src/viewer/server/page_server.cpp", r"max_frame_bytes_per_second = (\d+)e6",
             ["together get at most {} MB of frames"]),
    # Tests and measurements
    Constant("step of a moving box", "bench/frames/motion.cpp", r"max_move = ([\d.]+)", ["moves by up to {} of its size"]),
    Constant("moved objects", "bench/frames/cases.cpp", r'"1m-percent", \S+ ([\d.]+)', ["Where {} or 0.1% move"]),
    Constant("few moved objects", "bench/frames/cases.cpp", r'"1m-permille", \S+ ([\d.]+)', ["Where 1% or {} move"]),
    Constant("margin of Bullet", "bench/peers/bullet.cpp", r"btScalar\(([\d.]+) \* sides", ["Its margin is {} of an object"]),
    Constant("time of a tracker", "bench/parts.py", r'option\("--seconds (\d+)", "--quick"\)', ["has used up {} seconds"]),
    Constant("moved objects of a scene with pages", "bench/viewer/pace.cpp", r"each step, (\d+) % of the objects",
             ["of which {}% move in each step"]),
    Constant("latency of the modelled network", "bench/cluster/machines.hpp", r"latency_seconds = (\d+)e-6",
             ["a latency of {} microseconds"]),
    Constant("budget of all stages", "tools/budget.py", r"MOST_SECONDS = (\d+)", ["more than {} seconds of two busy cores"]),
    Constant("rounds of the costs of ranks", "bench/parts.py", r"\{whole\} --rounds (\d+)", ["repeats its part {} times"]),
]
STATED = [
    Stated("reading times of pages", ["ten minutes"]),
    Stated("the paper's own measurement", [
        "it loses a third of its time", "falls from 95% to 50%", "is 36% of what it lists", "The paper got to 20 times",
        "octal codes took 40 times as long", "one second of its time carries 100 MB"]),
    Stated("arithmetic", ["from 16.6 to 20.9, by a quarter", "grows as n^(5/3)", "A million boxes are 24 MB",
                          "an octal code and an index, 16 bytes", "and exchange half of the entries"]),
    Stated("the length of a run, which depends on the machine", ["in about an hour"]),
    Stated("definitions of scenes, which a test pins (Scenes.AreAsPinned)",
           ["n^(-1/3) / 2", "ours have half a pair an object", "ten times the volume", "80% in 20 Gaussian clusters", "5% world-wide thin sheets",
            "at most an eighth of its side", "at most an eighth of their side"]),
    Stated("a counted number of copies, checks or calls", ["copy it twice more"]),
    Stated("defaults relative to another option",
           ["half of `--max-connections`, with", "half of `--max-memory`, with", "half of `--max-state`, with"]),
    Stated("sums of the parts of a structure or message", [
        "about 40 per object of a rank; about 130", "about 100 per octant that it stores", "a gigabyte of memory in each rank",
        "half are sums over octants", "one byte for each", "four bytes of an entry",
        "element of a large crowd | 8 |", "| octant | 28 |", "element of the look-up table | 4 |", "page of pairs | 4,096 |",
        "with slack 24 more per object (48 for float64) and 16 more per pair",
        "about 32 m bytes (56 m in float64)", "about 35 bytes per object", "(60 in float64), 16 per pair",
        "24 bytes per index of the scene (48 in float64), and 8 per listed pair", "4 bytes per entry, 4 per object and 96 per octant"]),
    Stated("1,024 blocks of 4 KiB", ["all of a file up to 4 MiB"]),
    Stated("the least window of objects", ["the pairs of 1/2^14 of the objects"]),
    Stated("an allowance for the files of large calls", ["It must allow 2 GiB, and half a GiB for each worker"]),
    Stated("the shape of octants (src/octree/plan/space.hpp)", ["are four times longer on"]),
    Stated("s and l are sizes", ["half the longest side of the box", "1e-8 s + 1e-12 l", "2e-6 s; if l is more than 1,000 s"]),
    Stated("advice: a length that users choose", ["20 to 100 times"]),
    Stated("other programs: Open MPI, gRPC",
           ["Open MPI waits for a second", "makes each wait 30 seconds", "New connections have new certificates two seconds later"]),
    Stated("examples", ["draws them 60 times a second", "A frame may take 16.7 ms", "twice the greatest distance"]),
    Stated("an allowance for the network", ["may take 0.1 s longer than `most`"]),
]


def figures():
    return [*MEASURED, *CONSTANTS, *STATED]
