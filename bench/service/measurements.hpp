// Measurements of the server. Seconds are wall clock.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

/// One call, made locally and remotely in turns.
struct AgainstLocal {
    std::uint64_t objects = 0;
    Order order = Order::octal;
    std::vector<double> local, remote;
    std::vector<double> submit;  ///< remote engine: until submit() returns
    bool same = true;            ///< equal pairs, in equal order
};
AgainstLocal measure_against_local(const std::string& address, std::uint64_t objects, Order order, unsigned rounds);

/// Many concurrent clients. Each has its own connection and calls again as soon as it receives its pairs.
struct Crowd {
    unsigned clients = 0;
    std::uint64_t objects = 0;  ///< objects in each job
    std::uint64_t jobs = 0, wrong = 0;
    double seconds = 0;
    std::vector<double> latencies = {};  ///< ascending
};
Crowd measure_crowd(const std::string& address, const Crowd& what);

/// Equal frames of a scene, processed locally and on the server in turns. In each frame some boxes move a little.
struct SceneAgainstLocal {
    std::uint64_t objects = 0, moved = 0;
    double opening = 0;  ///< first step on the server, which sends all boxes
    double changes = 0;  ///< pairs that begin and end in a frame, on average
    std::vector<double> local, remote, above;
    bool same = true;  ///< equal begun and ended pairs
};
SceneAgainstLocal measure_scene(const std::string& address, std::uint64_t objects, std::uint64_t moved,
                                unsigned frames);

/// Returns a quantile. Requires: ascending values.
double quantile(const std::vector<double>& values, double part);

}  // namespace octopair::bench
