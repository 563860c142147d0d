// Costs of each kind of scene: time, entries and memory per object.
//
//     scene_costs [OBJECTS [THREADS]]           all kinds except two (left_out), each in its own process
//     scene_costs OBJECTS THREADS KIND float32|float64
//
// Memory is the highest resident size during the first call, minus the size before the call and the size of the pairs.
// Times are medians of 5 further calls in octal order into a reused list; of the median call, the last columns show the shares of the steps
// (`sort`: Summary's count and scatter).

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "measured_memory.hpp"
#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"

namespace {

using namespace octopair;
using bench::forget_peak;
using bench::status_bytes;

template <typename Real>
void measure(const std::string& kind, std::uint64_t objects, unsigned threads) {
    const std::vector<Box3f> narrow = samples::make_scene(kind, objects, 1);
    std::vector<Box<Real>> boxes(narrow.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::copy_n(narrow[i].min, 3, boxes[i].min);
        std::copy_n(narrow[i].max, 3, boxes[i].max);
    }
    const Objects scene{std::span<const Box<Real>>(boxes), {}};
    const auto engine = make_local_engine(threads);
    Options options;
    options.order = Order::octal;
    PairList pairs;
    forget_peak();
    const double before = status_bytes("VmRSS");
    const Summary first = engine->find_pairs(scene, pairs, options);
    const double peak = status_bytes("VmHWM");
    std::array<Summary, 5> calls;
    for (Summary& one : calls) one = engine->find_pairs(scene, pairs, options);
    std::nth_element(calls.begin(), calls.begin() + 2, calls.end(),
                     [](const Summary& a, const Summary& b) { return a.seconds < b.seconds; });
    const Summary& call = calls[2];
    const auto percent = [&](double seconds) { return 100 * seconds / call.seconds; };
    const double n = double(objects);
    const double m = double(first.pairs);
    std::printf("%-12s %-7s %8.1f %8.1f %9.1f %9.2f %9.2f %8.1f %7.0f%% %7.0f%% %7.0f%%\n", kind.c_str(),
                sizeof(Real) == 4 ? "float32" : "float64", first.seconds * 1e3, call.seconds * 1e3,
                call.seconds * 1e9 / (n + m), m / n, double(first.entries) / n, (peak - before - m * sizeof(Pair)) / n,
                percent(call.steps.encode), percent(call.steps.count + call.steps.scatter), percent(call.steps.scan));
    std::fflush(stdout);
}

/// Returns whether a kind is left out: its list of pairs dominates all other costs, or its first frame equals another
/// kind.
bool left_out(std::string_view kind) { return kind == "coincident" || kind == "brownian"; }

}  // namespace

int main(int count, char** words) {
    const std::string objects = count > 1 ? words[1] : "1000000";
    const std::string threads = count > 2 ? words[2] : "1";
    if (count > 4) {
        const bool narrow = std::string_view(words[4]) == "float32";
        const std::uint64_t size = std::strtoull(words[1], nullptr, 10);
        const unsigned k = unsigned(std::strtoul(words[2], nullptr, 10));
        narrow ? measure<float>(words[3], size, k) : measure<double>(words[3], size, k);
        return 0;
    }
    std::printf("%-12s %-7s %8s %8s %9s %9s %9s %8s %8s %8s %8s\n", "scene", "numbers", "first/ms", "then/ms",
                "ns/(n+m)", "pairs/n", "entries/n", "bytes/n", "encode", "sort", "scan");
    std::fflush(stdout);
    for (const std::string_view kind : samples::scene_kinds()) {
        if (left_out(kind)) continue;
        for (const char* numbers : {" float32", " float64"}) {
            const std::string scene = " " + objects + " " + threads + " " + std::string(kind) + numbers;
            if (std::system((words[0] + scene).c_str()) != 0) return 1;
        }
    }
    return 0;
}
