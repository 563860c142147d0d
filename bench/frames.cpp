// Moving scenes: octopair::Scene frame by frame, compared with full detection of every frame and with its peers.
//
//     octopair_frames [--case NAME...] [--frames N] [--seconds S] [--quick] [--json FILE]
//
// Boxes of the kind uniform move (frames/motion.hpp). All trackers take turns, frame by frame (frames/tracking.hpp).
// Each row shows the median, the 99th percentile and the slowest frame after the first, and the median of processor
// time. Processor time is more reliable when other programs use the machine. Cases of few objects also show the mean time
// of a frame's queries for the objects that overlap a box. The case `memory` measures the memory of a scene in separate
// processes. A tracker is marked, and the exit status is 1, if it finds other pairs than full detection, or other
// numbers of overlapping objects than the scene. `--quick` uses a tenth of the frames, and a tenth of the objects, but not fewer than 1,000.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "frames/memory.hpp"
#include "frames/tracking.hpp"
#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"

namespace {

using namespace octopair;
using namespace octopair::bench;
using Json = nlohmann::ordered_json;

const std::string memory_name = "memory";

struct Request {
    std::vector<std::string> cases;
    FramePlan plan;
    bool quick = false;
    std::string json;

    bool asks(const std::string& name) const {
        return cases.empty() || std::find(cases.begin(), cases.end(), name) != cases.end();
    }
};

std::string remark(const Track& track, unsigned frames) {
    std::string text;
    if (track.seconds.size() < frames) text += fmt::format("  {} frames", track.seconds.size());
    if (track.differing > 0) {
        text += fmt::format("  DIFFERS in {} frames: {} pairs", track.differing, track.differs_pairs);
    }
    if (track.differing_queries > 0)
        text += fmt::format("  OTHER NUMBERS of overlaps in {} frames", track.differing_queries);
    return text;
}

void print(const FrameCase& which, const std::vector<Track>& tracks, const FramePlan& plan) {
    fmt::print("{}: {} objects, {:g}% move, {} thread(s), {} pairs\n", which.name, which.objects, which.share * 100,
               which.threads, tracks.front().pairs);
    fmt::print("  {:<20} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "milliseconds", "median", "99%", "slowest",
               "first", "processor", "frames/s");
    for (const Track& track : tracks) {
        const double median = track.quantile(0.5);
        fmt::print("  {:<20} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.1f}{}\n", track.tracker,
                   median * 1e3, track.quantile(0.99) * 1e3, track.quantile(1) * 1e3, track.first_seconds * 1e3,
                   track.quantile(0.5, Clock::processor) * 1e3, 1 / median, remark(track, frames_of(which, plan)));
    }
    for (const Track& track : tracks) {
        if (track.query_seconds.empty()) continue;
        fmt::print("  {:<20} {:>10.3f} {:>10.3f}  microseconds a query\n", track.tracker,
                   track.query_quantile(0.5) * 1e6, track.query_quantile(0.99) * 1e6);
    }
    std::fflush(stdout);
}

Json track_json(const Track& track) {
    Json json = {{"tracker", track.tracker},
                 {"frames", track.seconds.size()},
                 {"median_seconds", track.quantile(0.5)},
                 {"percentile99_seconds", track.quantile(0.99)},
                 {"slowest_seconds", track.quantile(1)},
                 {"first_seconds", track.first_seconds},
                 {"median_processor_seconds", track.quantile(0.5, Clock::processor)},
                 {"seconds", track.seconds},
                 {"processor_seconds", track.processor_seconds},
                 {"pairs", track.pairs},
                 {"differing_frames", track.differing}};
    if (!track.query_seconds.empty()) {
        json["median_query_seconds"] = track.query_quantile(0.5);
        json["percentile99_query_seconds"] = track.query_quantile(0.99);
        json["differing_query_frames"] = track.differing_queries;
    }
    return json;
}

Json case_json(const FrameCase& which, const std::vector<Track>& tracks) {
    Json rows = Json::array();
    for (const Track& track : tracks) rows.push_back(track_json(track));
    return {{"case", which.name},
            {"objects", which.objects},
            {"share", which.share},
            {"threads", which.threads},
            {"rows", rows}};
}

Json memory_json(const MemoryCase& which, const MemoryUse& use) {
    return {{"scene", which.kind},          {"objects", which.objects},
            {"share", which.share},         {"pairs", use.pairs},
            {"first_peak", use.first_peak}, {"peak", use.peak},
            {"steady", use.steady},         {"most", promised_bytes(double(which.objects), double(use.pairs))}};
}

/// Reduces the number of objects for a quick trial of the program.
void shrink(std::uint64_t& objects) {
    if (objects > 1000) objects = std::max<std::uint64_t>(1000, objects / 10);
}

Json run_memory(const Request& request) {
    Json rows = Json::array();
    fmt::print("{}: bytes per object of a scene, 1 thread\n", memory_name);
    fmt::print("  {:<10} {:>6} {:>8} {:>10} {:>10} {:>10} {:>10}\n", "scene", "moved", "pairs/n", "first peak", "peak",
               "steady", "at most");
    for (MemoryCase which : memory_cases()) {
        if (request.quick) shrink(which.objects);
        const MemoryUse use = measure_memory(which);
        const double n = double(which.objects);
        const double most = promised_bytes(n, double(use.pairs));
        fmt::print("  {:<10} {:>5g}% {:>8.2f} {:>10.1f} {:>10.1f} {:>10.1f} {:>10.1f}{}\n", which.kind,
                   which.share * 100, double(use.pairs) / n, use.first_peak / n, use.peak / n, use.steady / n, most / n,
                   use.highest() <= most ? "" : "  MISSED");
        std::fflush(stdout);
        rows.push_back(memory_json(which, use));
    }
    return rows;
}

/// Runs a case, prints the results and adds them to `results`. Returns false if a tracker found other pairs or overlaps.
bool run_case(const FrameCase& which, const FramePlan& plan, Json& results) {
    const auto tell = [&](std::string_view what) { fmt::print(stderr, "{}: {}\n", which.name, what); };
    const std::vector<Track> tracks = track(which, plan, tell);
    print(which, tracks, plan);
    results.push_back(case_json(which, tracks));
    return std::all_of(tracks.begin(), tracks.end(),
                       [](const Track& track) { return track.differing + track.differing_queries == 0; });
}

int run(const Request& request) {
    std::optional<io::AtomicFile> file;
    if (!request.json.empty()) file.emplace(request.json);
    Json all = machine_json();
    // Memory comes first: the measurement forks while this process has one thread and no memory of other measurements.
    if (request.asks(memory_name)) all["memory"] = run_memory(request);
    Json results = Json::array();
    bool agree = true;
    for (FrameCase which : frame_cases()) {
        if (!request.asks(which.name)) continue;
        if (request.quick) shrink(which.objects);
        agree = run_case(which, request.plan, results) && agree;
    }
    all["results"] = results;
    if (file) {
        file->write(all.dump(1) + '\n');
        file->commit();
    }
    return agree ? 0 : 1;
}

std::vector<std::string> case_names() {
    std::vector<std::string> names{memory_name};
    for (const FrameCase& which : frame_cases()) names.push_back(which.name);
    return names;
}

}  // namespace

int main(int count, char** words) {
    Request request;
    CLI::App app("Compares octopair's scenes with full detection and with peers on moving boxes, frame by frame.");
    app.add_option("--case", request.cases, "cases to run (default: all)")->check(CLI::IsMember(case_names()));
    const CLI::Option* const frames =
        app.add_option("--frames", request.plan.frames,
                       "frames after the first frame (default 100); ten times as many in cases of up to 5,000 objects")
            ->check(CLI::PositiveNumber);
    app.add_option("--seconds", request.plan.max_seconds,
                   "time limit of a tracker per case, after 10 frames at least (default 30)");
    app.add_flag("--quick", request.quick, "use a tenth of the frames, and of the objects, but not fewer than 1,000");
    app.add_option("--json", request.json);
    CLI11_PARSE(app, count, words);
    if (request.quick && frames->count() == 0) request.plan.frames /= 10;
    try {
        return run(request);
    } catch (const std::exception& error) {
        std::cerr << "octopair_frames: " << error.what() << '\n';
        return 3;
    }
}
