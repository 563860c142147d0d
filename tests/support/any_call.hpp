// A call with the objects of a case, by any engine, for comparisons of engines.
#pragma once

#include <cstdint>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/cases.hpp"

namespace octopair::test {

/// A call with the objects of a case, by any engine.
struct AnyCall {
    const Case& asked;
    Order order;
    bool streamed;
    bool limited;
    bool verify = false;

    std::vector<Pair> made_by(Engine& engine) const {
        Options options;
        options.order = order;
        options.margin = asked.margin;
        options.buffer_bytes = asked.buffer_bytes;
        options.verify = verify;
        if (limited) options.limit = asked.limit;
        std::vector<Pair> found;
        if (streamed) {
            const PairSink sink = [&](auto batch) { found.insert(found.end(), batch.begin(), batch.end()); };
            engine.stream_pairs(asked.input(), sink, options);
        } else {
            PairList list;
            engine.find_pairs(asked.input(), list, options);
            found = list.to_vector();
        }
        return found;
    }
    std::uint64_t counted_by(Engine& engine) const {
        Options options;
        options.margin = asked.margin;
        options.verify = verify;
        if (limited) options.limit = asked.limit;
        return engine.count_pairs(asked.input(), options);
    }
};

}  // namespace octopair::test
