// Receiver: passes pairs, in their final order, to the caller's list or sink, up to a limit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/private_export.hpp"
#include "base/test_hooks.hpp"
#include "engine/request.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT Receiver {
public:
    Receiver(const detail::Output& output, std::optional<std::uint64_t> limit) : output_(output), limit_(limit) {}

    /// Runs give(), which calls take(), until it returns or a pair is beyond the limit. Then passes the batched pairs to the sink.
    /// Throws: what give() and the sink throw.
    template <typename Give>
    void receive(Give&& give) {
        try {
            give();
        } catch (const LimitReached&) {
            count_path(Path::limit_reached);
        }
        flush();
    }
    /// Passes on the pairs that are within the limit. Requires: the caller was called by receive().
    /// Throws: if some of `pairs` are beyond the limit, after it has passed on the others; what the sink throws.
    void take(std::span<const Pair> pairs);

    std::uint64_t pairs() const { return pairs_; }
    bool truncated() const { return truncated_; }
    double sink_seconds() const { return sink_seconds_; }

private:
    struct LimitReached {};

    void flush();
    void deliver(std::span<const Pair> pairs);
    void give(std::span<const Pair> pairs);
    void keep(std::span<const Pair> pairs);

    const detail::Output& output_;
    std::optional<std::uint64_t> limit_;
    std::uint64_t pairs_ = 0;
    bool truncated_ = false;
    double sink_seconds_ = 0;
    std::vector<Pair> held_;  // batch for the sink
};

}  // namespace octopair
