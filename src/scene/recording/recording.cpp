#include "scene/recording/recording.hpp"

#include <cstddef>
#include <limits>
#include <string>

#include "octopair/error.hpp"

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

namespace {

/// Returns the length of an array as records store it. Throws: Error{resource_limit} if it is greater than 2^32 - 1.
std::uint32_t count_of(std::uint64_t size) {
    if (size <= std::numeric_limits<std::uint32_t>::max()) return std::uint32_t(size);
    throw Error(ErrorCode::resource_limit, "a call of " + std::to_string(size) + " objects cannot be recorded");
}

Bytes bytes_of_boxes(const Boxes& boxes) {
    return std::visit([](auto span) -> Bytes { return std::as_bytes(span); }, boxes);
}

}  // namespace

RecordEnvelope envelope_of(RecordKind kind, std::initializer_list<Bytes> pieces) {
    RecordHead head = {kind, 0, 0};
    for (const Bytes piece : pieces) head.length += piece.size();
    head.check = head.right_check();
    Checksum sum;
    sum.add(bytes_of(head));
    for (const Bytes piece : pieces) sum.add(piece);
    return {head, sum.value()};
}

void CallEncoder::add(const Objects& objects, std::span<const Traits> traits) {
    const std::uint32_t counts[3] = {count_of(objects.size()), count_of(objects.padding.size()),
                                     count_of(traits.size())};
    append(RecordKind::add,
           {bytes_of(counts), bytes_of_boxes(objects.boxes), std::as_bytes(objects.padding), packed(traits)});
}

void CallEncoder::move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes) {
    const std::uint32_t count = count_of(ids.size());
    append(kind, {bytes_of(count), std::as_bytes(ids), bytes_of_boxes(boxes)});
}

void CallEncoder::remove(std::span<const ObjectId> ids) {
    const std::uint32_t count = count_of(ids.size());
    append(RecordKind::remove, {bytes_of(count), std::as_bytes(ids)});
}

void CallEncoder::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    const std::uint32_t counts[2] = {count_of(ids.size()), count_of(traits.size())};
    append(RecordKind::set_traits, {bytes_of(counts), std::as_bytes(ids), packed(traits)});
}

Bytes CallEncoder::packed(std::span<const Traits> traits) {
    traits_.clear();
    for (const Traits& one : traits) traits_.push_back({one.groups, one.mask, one.fixed ? 1u : 0u});
    return std::as_bytes(std::span<const RecordedTraits>(traits_));
}

}  // namespace octopair
