// Where the result of `octopair detect` goes: pairs as such, or collisions with what is known of them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "io/results/baseline.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Calls come as begin_frame, write (any number), end_frame, for each frame, then finish.
class FoundWriter {
public:
    virtual ~FoundWriter() = default;
    virtual void begin_frame(std::uint64_t frame) = 0;
    /// As many findings as pairs, or none.
    virtual void write(std::span<const Pair> pairs, std::span<const Finding> findings) = 0;
    virtual void end_frame() = 0;
    virtual void finish() = 0;
    /// After the last write: how the result stands to an older one, where there is one.
    virtual std::optional<io::ChangeCounts> changes() const { return std::nullopt; }
};

/// The sets that a result is of; `second` is the first one's but for a join.
struct FoundIn {
    const InputSet& first;
    const InputSet& second;
    bool moving;  ///< they have frames
};

/// Collisions beyond the pairs, but for .npy, which holds pairs alone; and their report, held against a baseline, where
/// these are asked for. Borrows the request and the sets.
std::unique_ptr<FoundWriter> make_found_writer(const DetectRequest& request, const FoundIn& sets,
                                               const std::stop_token& stop);

}  // namespace octopair::cli
