// Receiver: passes pairs, in their final order, to the caller's list or sink, up to a limit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/private_export.hpp"
#include "engine/request.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT Receiver {
public:
    Receiver(const detail::Output& output, std::optional<std::uint64_t> limit) : output_(output), limit_(limit) {}

    struct LimitReached {};

    /// Passes on the pairs that are within the limit.
    /// Throws: LimitReached if some of `pairs` are beyond the limit, after it has passed on the others; what the sink throws.
    void take(std::span<const Pair> pairs);
    /// Passes the batched pairs to the sink.
    void flush();

    std::uint64_t pairs() const { return pairs_; }
    bool truncated() const { return truncated_; }
    double sink_seconds() const { return sink_seconds_; }

private:
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
