// Any call about the objects of a case, by any engine: to compare engines.
#pragma once

#include <cstdint>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/cases.hpp"

namespace octopair::testing {

/// One call about the objects of a case, by any engine.
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
        const Objects first = asked.first.view();
        std::vector<Pair> found;
        if (streamed) {
            const PairSink sink = [&](auto batch) { found.insert(found.end(), batch.begin(), batch.end()); };
            asked.second ? engine.stream_pairs_between(first, asked.second->view(), sink, options)
                         : engine.stream_pairs(first, sink, options);
        } else {
            PairList list;
            asked.second ? engine.find_pairs_between(first, asked.second->view(), list, options)
                         : engine.find_pairs(first, list, options);
            found = list.to_vector();
        }
        return found;
    }
    std::uint64_t counted_by(Engine& engine) const {
        Options options;
        options.margin = asked.margin;
        options.verify = verify;
        if (limited) options.limit = asked.limit;
        const Objects first = asked.first.view();
        return asked.second ? engine.count_pairs_between(first, asked.second->view(), options)
                            : engine.count_pairs(first, options);
    }
};

}  // namespace octopair::testing
