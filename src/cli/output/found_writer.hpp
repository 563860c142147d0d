// FoundWriter: writes the result of `octopair detect`: pairs alone, or collisions with their findings.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "io/results/baseline.hpp"
#include "io/results/collision_writer.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Requires: for each frame, one call of begin_frame(), any number of calls of write(), and one call of end_frame(); then finish().
class FoundWriter {
public:
    virtual ~FoundWriter() = default;
    virtual void begin_frame(std::uint64_t frame) = 0;
    /// Writes pairs of the current frame, with their findings. Requires: `findings` has one element per pair, or is empty.
    virtual void write(std::span<const Pair> pairs, std::span<const Finding> findings) = 0;
    virtual void end_frame() = 0;
    virtual void finish() = 0;
    /// Returns how many collisions are new, the same, or gone since the older result of --baseline; nothing without --baseline.
    /// Requires: the last call of write() was made.
    virtual std::optional<io::ChangeCounts> changes() const { return std::nullopt; }
};

/// The sets of a result. `second` is `first` unless the result is of a join.
struct FoundIn {
    const InputSet& first;
    const InputSet& second;
    bool moving;  ///< true if the result has frames
};

/// Makes the writer of --output, --report and --baseline. It writes pairs alone at the stage `pairs`, and into .npy files; otherwise it
/// writes collisions. Borrows the request and the sets.
std::unique_ptr<FoundWriter> make_found_writer(const DetectRequest& request, const FoundIn& sets,
                                               const std::stop_token& stop);

/// Makes the HTML report of --report (report_page.cpp). The report has no measured times, so equal results give equal bytes. Borrows the
/// request and the sets.
std::unique_ptr<io::CollisionWriter> make_report(const DetectRequest& request, const FoundIn& sets);

}  // namespace octopair::cli
