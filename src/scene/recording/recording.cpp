#include "scene/recording/recording.hpp"

#include <cstddef>

namespace octopair {

std::uint64_t RecordingHead::right_checksum() const {
    Checksum sum;
    sum.add(std::as_bytes(std::span(this, 1)).first(offsetof(RecordingHead, checksum)));
    return sum.value();
}

RecordingHead recording_head(const SceneOptions& options) {
    RecordingHead head;
    head.precision = options.precision == Precision::float64 ? 64 : 32;
    head.margin = options.margin;
    head.checksum = head.right_checksum();
    return head;
}

std::uint32_t RecordHead::right_check() const {
    const RecordHead unchecked = {kind, 0, length};
    Checksum sum;
    sum.add(std::as_bytes(std::span(&unchecked, 1)));
    return std::uint32_t(sum.value());
}

RecordedResult recorded_result(const StepResult& result) {
    Checksum sum;
    for (const std::span<const Pair> pairs : {result.began, result.ended}) {
        sum.add(pairs.size());
        sum.add(std::as_bytes(pairs));
    }
    sum.add(result.persisting);
    return {sum.value(), result.began.size(), result.ended.size(), result.persisting};
}

}  // namespace octopair
