// What the server is measured by. Seconds are wall clock.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

/// The same call, local and remote in turns.
struct AgainstLocal {
    std::uint64_t objects = 0;
    Order order = Order::octal;
    std::vector<double> local, remote;
    std::vector<double> submit;  ///< of the remote engine: until the application has its thread back
    bool same = true;            ///< pairs, in order
};
AgainstLocal measure_against_local(const std::string& address, std::uint64_t objects, Order order, unsigned rounds);

/// Many clients at once, each with its own connection, each calling again as soon as it has its pairs.
struct Crowd {
    unsigned clients = 0;
    std::uint64_t objects = 0;  ///< of each job
    std::uint64_t jobs = 0, wrong = 0;
    double seconds = 0;
    std::vector<double> latencies = {};  ///< ascending
};
Crowd measure_crowd(const std::string& address, const Crowd& what);

/// The same frames of a scene, here and on the server, in turns: some of its boxes move a little.
struct SceneAgainstLocal {
    std::uint64_t objects = 0, moved = 0;
    double opening = 0;  ///< the first step on the server, which all boxes go to
    double changes = 0;  ///< pairs that begin and end in a frame, on average
    std::vector<double> local, remote, above;
    bool same = true;  ///< what began and ended
};
SceneAgainstLocal measure_scene(const std::string& address, std::uint64_t objects, std::uint64_t moved,
                                unsigned frames);

double median(std::vector<double> values);
/// Of ascending values.
double quantile(const std::vector<double>& values, double part);

}  // namespace octopair::bench
