// Times octopair on one scene through the public interface alone. bench/guard links this program with each commit.
//
//     guard_timer FILE.npy THREADS     FILE: float32, shape (n, 6)
//
// Prints the number of pairs and the median nanoseconds per object. The first call is not counted. Further calls run for half
// a second, but at least 3 times.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"

namespace {

/// Reads the rows after the header; bytes 8 and 9 hold the length of the header.
std::vector<octopair::Box3f> read_boxes(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto size = std::uint64_t(file.tellg());
    unsigned char head[10] = {};
    file.seekg(0).read(reinterpret_cast<char*>(head), sizeof head);
    const std::uint64_t begin = sizeof head + head[8] + 256u * head[9];
    if (!file || size <= begin) throw std::runtime_error("cannot read " + path);
    std::vector<octopair::Box3f> boxes((size - begin) / sizeof(octopair::Box3f));
    file.seekg(std::streamoff(begin));
    file.read(reinterpret_cast<char*>(boxes.data()), std::streamsize(boxes.size() * sizeof(octopair::Box3f)));
    if (!file) throw std::runtime_error("cannot read " + path);
    return boxes;
}

double seconds_of_call(octopair::Engine& engine, const octopair::Objects& objects, octopair::PairList& pairs) {
    octopair::Options options;
    options.order = octopair::Order::octal;
    const auto begin = std::chrono::steady_clock::now();
    (void)engine.find_pairs(objects, pairs, options);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void run(const std::string& path, unsigned threads) {
    constexpr double max_seconds = 0.5;
    constexpr std::size_t min_calls = 3, max_calls = 1000;
    const std::vector<octopair::Box3f> boxes = read_boxes(path);
    const octopair::Objects objects{std::span<const octopair::Box3f>(boxes), {}};
    const auto engine = octopair::make_local_engine(threads);
    octopair::PairList pairs;
    (void)seconds_of_call(*engine, objects, pairs);
    std::vector<double> seconds;
    seconds.reserve(max_calls);
    double spent = 0;
    while (seconds.size() < min_calls || (spent < max_seconds && seconds.size() < max_calls)) {
        seconds.push_back(seconds_of_call(*engine, objects, pairs));
        spent += seconds.back();
    }
    const auto middle = seconds.begin() + std::ptrdiff_t(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    std::printf("%llu %.6f\n", static_cast<unsigned long long>(pairs.size()), *middle * 1e9 / double(boxes.size()));
}

}  // namespace

int main(int count, char** words) {
    try {
        if (count != 3) throw std::runtime_error("guard_timer FILE.npy THREADS");
        run(words[1], unsigned(std::strtoul(words[2], nullptr, 10)));
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "guard_timer: %s\n", error.what());
        return 1;
    }
}
