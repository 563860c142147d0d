// Calls of engines as expressions.
#pragma once

#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::test {

/// Borrows the boxes.
template <typename Real>
Objects objects_of(const std::vector<Box<Real>>& boxes) {
    return {boxes};
}

/// Returns a sink that appends to `pairs`.
inline PairSink append_to(std::vector<Pair>& pairs) {
    return [&pairs](std::span<const Pair> batch) { pairs.insert(pairs.end(), batch.begin(), batch.end()); };
}

inline std::vector<Pair> listed_pairs(Engine& engine, const Input& input, const Options& options = {},
                                      std::stop_token stop = {}) {
    PairList list;
    engine.find_pairs(input, list, options, std::move(stop));
    return list.to_vector();
}

inline std::vector<Pair> streamed_pairs(Engine& engine, const Input& input, const Options& options = {}) {
    std::vector<Pair> pairs;
    engine.stream_pairs(input, append_to(pairs), options);
    return pairs;
}

/// Returns a token of a stop that was requested.
inline std::stop_token requested_stop() {
    std::stop_source source;
    source.request_stop();
    return source.get_token();
}

}  // namespace octopair::test
