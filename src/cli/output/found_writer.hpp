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
#include "io/results/statuses.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Requires: for each frame, one call of begin_frame(), any number of calls of write() and
/// leave_out(), and one call of end_frame(); then finish().
class FoundWriter {
public:
    virtual ~FoundWriter() = default;
    virtual void begin_frame(std::uint64_t frame) = 0;
    /// Writes pairs of the current frame, with their findings. Requires: `findings` has one element per pair, or is empty.
    virtual void write(std::span<const Pair> pairs, std::span<const Finding> findings) = 0;
    virtual void end_frame() = 0;
    /// Takes pairs that options leave out of the result, for --statuses.
    virtual void leave_out(std::span<const Pair>) {}
    /// `complete`: false if --limit has cut the result.
    virtual void finish(bool complete) = 0;
    /// Returns how many collisions are new, the same, or gone since the older result of --baseline; nothing without --baseline.
    /// Requires: the last call of write() was made.
    virtual std::optional<io::ChangeCounts> changes() const { return std::nullopt; }
    /// Returns the number of collisions by the status of --statuses; nothing without --statuses. Requires: finish() was called.
    virtual std::optional<io::StatusCounts> statuses() const { return std::nullopt; }
};

/// The sets of a result. `second` is `first` unless the result is of a join.
struct FoundIn {
    const InputSet& first;
    const InputSet& second;
    bool moving;  ///< true if the result has frames
};

/// Makes the writer of --output, --report, --baseline and --statuses. It writes pairs alone at the stage `pairs`, and into .npy files; otherwise it
/// writes collisions. Borrows the request and the sets.
std::unique_ptr<FoundWriter> make_found_writer(const DetectRequest& request, const FoundIn& sets,
                                               const std::stop_token& stop);

/// Returns the axis up and the unit of a result: from the options if given, else from the formats of the inputs. Unknown if the formats
/// differ (report_page.cpp).
io::SceneSpace space_of_result(const DetectRequest& request, const FoundIn& sets);

/// Makes the HTML report of --report (report_page.cpp). The report has no measured times, so equal results give equal bytes. Borrows the
/// request and the sets.
std::unique_ptr<io::CollisionWriter> make_report(const DetectRequest& request, const FoundIn& sets);

}  // namespace octopair::cli
