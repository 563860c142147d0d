#include "scene/recording/recording.hpp"

#include <cstring>

namespace octopair {

void Checksum::add(Bytes bytes) {
    constexpr std::size_t word = sizeof(std::uint64_t);
    std::size_t at = 0;
    const auto add_byte = [&] {
        part_ |= std::to_integer<std::uint64_t>(bytes[at++]) << 8 * (length_ % word);
        if (++length_ % word != 0) return;
        state_ = mixed(state_, part_);
        part_ = 0;
    };
    while (at < bytes.size() && length_ % word != 0) add_byte();
    for (; at + word <= bytes.size(); at += word, length_ += word) {
        std::uint64_t number = 0;
        std::memcpy(&number, bytes.data() + at, word);
        state_ = mixed(state_, number);
    }
    while (at < bytes.size()) add_byte();
}

std::uint64_t Checksum::value() const {
    const bool part = length_ % sizeof(std::uint64_t) != 0;
    return mixed(part ? mixed(state_, part_) : state_, length_);
}

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
