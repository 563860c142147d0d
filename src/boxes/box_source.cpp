#include "boxes/box_source.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <variant>
#include <vector>

#include "base/memory.hpp"
#include "boxes/box_kernel.hpp"

namespace octopair {

namespace {

/// True if the boxes of `set` are float32 without padding.
bool is_plain(const Objects& set) {
    return std::holds_alternative<std::span<const Box3f>>(set.boxes) && set.padding.empty();
}

/// Returns the boxes of `set` if they are float64 without padding; otherwise null.
const Box3d* plain_wide_boxes(const Objects& set) {
    const auto* const boxes = std::get_if<std::span<const Box3d>>(&set.boxes);
    return boxes != nullptr && set.padding.empty() ? boxes->data() : nullptr;
}

/// Returns the padding of the objects [begin, begin + count), or none if no object has padding.
std::span<const double> part_of(std::span<const double> padding, std::size_t begin, std::size_t count) {
    return padding.empty() ? padding : padding.subspan(begin, count);
}

}  // namespace

BoxSource::BoxSource(const Objects& first, const Objects* second, const EntryForm& form)
    : first_(&first),
      second_(second),
      first_size_(first.size()),
      second_size_(second != nullptr ? second->size() : 0),
      form_(form) {
    const Box3d* const wide_second = second != nullptr ? plain_wide_boxes(*second) : nullptr;
    if (second != nullptr && wide_second == nullptr) return;
    plain_wide_first_ = plain_wide_boxes(first);
    plain_wide_second_ = wide_second;
}

BoxSource::BoxSource(const Objects& first, const Objects* second, double margin)
    : BoxSource(first, second,
                EntryForm{margin == 0 && is_plain(first) && (second == nullptr || is_plain(*second)),
                          {.origin = {}, .margin = margin}}) {
    if (exact()) return;
    const OriginSample sample{size()};
    std::vector<OriginSample::Corner> corners(sample.size());
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = low_corner(sample[i]);
    form_.rounding.origin = OriginSample::median(corners);
}

OriginSample::Corner BoxSource::low_corner(std::size_t position) const {
    double padding = 0;
    const Box3d low = box(std::uint32_t(position), padding);
    return {low.min[0], low.min[1], low.min[2]};
}

Box3d BoxSource::box(std::uint32_t object, double& padding) const {
    const bool in_first = object < first_size_;
    const Objects& set = in_first ? *first_ : *second_;
    const std::size_t index = in_first ? object : object - first_size_;
    padding = set.padding.empty() ? 0 : set.padding[index];
    return wide_box(set, index);
}

bool BoxSource::is_pair(std::uint32_t a, std::uint32_t b) const {
    double padding_a = 0;
    double padding_b = 0;
    const Box3d box_a = box(a, padding_a);
    const Box3d box_b = box(b, padding_b);
    return within_reach(box_a, box_b, form_.rounding.margin + (padding_a + padding_b));
}

std::uint32_t BoxSource::pairs_with(const std::uint32_t* objects, std::uint32_t other, std::uint32_t asked) const {
    if (plain_wide_first_ == nullptr) return EntrySource::pairs_with(objects, other, asked);
    const auto plain = [&](std::uint32_t object) -> const Box3d& {
        return object < first_size_ ? plain_wide_first_[object] : plain_wide_second_[object - first_size_];
    };
    const Box3d box = plain(other);
    const double margin = form_.rounding.margin;
    return kept_bits(asked, [&](unsigned i) { return within_reach(plain(objects[i]), box, margin); });
}

std::size_t BoxSource::refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const {
    // The objects `b` of a join are in the second set.
    const Objects& set_of_b = join() ? *second_ : *first_;
    const auto* const plain_a = std::get_if<std::span<const Box3f>>(&first_->boxes);
    const auto* const plain_b = std::get_if<std::span<const Box3f>>(&set_of_b.boxes);
    if (form_.exact) return refused_pairs(doubtful, {plain_a->data(), plain_b->data(), second_begin()}, out);
    const auto* const wide_a = std::get_if<std::span<const Box3d>>(&first_->boxes);
    const auto* const wide_b = std::get_if<std::span<const Box3d>>(&set_of_b.boxes);
    const bool without_clearance = form_.rounding.margin == 0 && first_->padding.empty() && set_of_b.padding.empty();
    if (without_clearance && wide_a != nullptr && wide_b != nullptr) {
        return refused_pairs(doubtful, {wide_a->data(), wide_b->data(), second_begin()}, out);
    }
    return refused_one_by_one(doubtful, out);
}

namespace {

constexpr std::size_t boxes_ahead = 16;  // distance at which boxes are prefetched

/// Prefetches a box, which may lie on two cache lines.
template <typename Real>
inline void prefetch_box(const Box<Real>& box) {
    prefetch(&box);
    prefetch(&box.max[2]);
}

/// Boxes of the objects from `first_object` on. `padding`: empty for none.
template <typename Real>
struct BoxSet {
    std::span<const Box<Real>> boxes;
    std::span<const double> padding;
    std::uint32_t first_object;
};

/// Collects the boxes of some entries, and rounds them together.
template <typename Real>
void load_rounded(const BoxSet<Real>& set, const OutwardRounding& rounding, std::span<Entry> entries) {
    const auto& [boxes, padding, first_object] = set;
    constexpr std::size_t most = 32;
    std::array<Box<Real>, most> some;
    std::array<double, most> paddings;
    std::array<Entry, most> rounded;
    for (std::size_t begin = 0; begin < entries.size(); begin += most) {
        const std::size_t count = std::min(most, entries.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t ahead = begin + i + boxes_ahead;
            if (ahead < entries.size()) prefetch_box(boxes[entries[ahead].object - first_object]);
            const std::uint32_t index = entries[begin + i].object - first_object;
            some[i] = boxes[index];
            paddings[i] = padding.empty() ? 0 : padding[index];
        }
        // Ignores the result of the check: the boxes were checked when the octree was built.
        const auto used = std::span<const double>(paddings).first(padding.empty() ? 0 : count);
        (void)round_boxes(std::span<const Box<Real>>(some).first(count), used, rounding,
                          std::span(rounded).first(count));
        for (std::size_t i = 0; i < count; ++i) std::memcpy(&entries[begin + i], &rounded[i], sizeof(Box3f));
    }
}

}  // namespace

void BoxSource::load_bounds(std::span<Entry> entries) const {
    if (form_.exact) {
        const auto box = [&](const Entry& entry) -> const Box3f& {
            const bool in_first = entry.object < first_size_;
            const Objects& set = in_first ? *first_ : *second_;
            return std::get<std::span<const Box3f>>(set.boxes)[in_first ? entry.object : entry.object - first_size_];
        };
        for (std::size_t i = 0; i < entries.size(); ++i) {
            if (i + boxes_ahead < entries.size()) prefetch_box(box(entries[i + boxes_ahead]));
            std::memcpy(&entries[i], &box(entries[i]), sizeof(Box3f));
        }
        return;
    }
    while (!entries.empty()) {
        const bool in_first = entries.front().object < first_size_;
        const auto is_other = [&](const Entry& entry) { return (entry.object < first_size_) != in_first; };
        const auto run = std::size_t(std::ranges::find_if(entries, is_other) - entries.begin());
        const Objects& set = in_first ? *first_ : *second_;
        const auto first_object = std::uint32_t(in_first ? 0 : first_size_);
        const auto load = [&]<typename Real>(std::span<const Box<Real>> boxes) {
            load_rounded<Real>({boxes, set.padding, first_object}, form_.rounding, entries.first(run));
        };
        std::visit(load, set.boxes);
        entries = entries.subspan(run);
    }
}

RoundingSlack BoxSource::slack() const {
    // The error of an entry's bound has two parts: 2^-23 of the bound (rounding to float32), and 2^-47 of the numbers from
    // which the bound was computed (OutwardRounding::error_part). The slack is more than four times the error, which separates
    // real overlaps from those made by rounding. The widening needs no term of its own: a widening larger than the entry's
    // coordinates would make the box's extent as large.
    RoundingSlack slack;
    for (unsigned axis = 0; axis < 3; ++axis)
        slack.base[axis] = rounding::finite_float_above(std::abs(form_.rounding.origin[axis]) * 0x1p-44 + FLT_MIN);
    return slack;
}

template <typename Real>
bool BoxSource::load_set(std::span<const Box<Real>> boxes, std::span<const double> padding, std::size_t begin,
                         std::span<Entry> out) const {
    const auto some = boxes.subspan(begin, out.size());
    if constexpr (std::is_same_v<Real, float>) {
        if (form_.exact) return copy_boxes(some, out);
    }
    return round_boxes(some, part_of(padding, begin, out.size()), form_.rounding, out);
}

bool BoxSource::load(std::size_t begin, std::span<Entry> out) const {
    if (join() && begin < first_size_ && begin + out.size() > first_size_) {
        const std::size_t of_first = first_size_ - begin;
        const bool good = load(begin, out.first(of_first));
        return load(first_size_, out.subspan(of_first)) && good;
    }
    const bool in_first = begin < first_size_;
    const Objects& set = in_first ? *first_ : *second_;
    const std::size_t offset = in_first ? 0 : first_size_;
    const bool good =
        std::visit([&](auto boxes) { return load_set(boxes, set.padding, begin - offset, out); }, set.boxes);
    const std::uint32_t mask = !join() ? 0 : in_first ? first_set : second_set;
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i].object = std::uint32_t(begin + i);
        out[i].mask = mask;
    }
    return good;
}

Float32Boxes BoxSource::float32_boxes(std::size_t begin, std::span<Box3f> room) const {
    if (join()) return {};
    const auto first_object = std::uint32_t(begin);
    if (form_.exact) {
        return {std::get<std::span<const Box3f>>(first_->boxes).subspan(begin, room.size()), first_object};
    }
    const auto round = [&](auto boxes) {
        const auto padding = part_of(first_->padding, begin, room.size());
        return round_boxes(boxes.subspan(begin, room.size()), padding, form_.rounding, room);
    };
    return {room, first_object, nullptr, std::visit(round, first_->boxes)};
}

void BoxSource::pick(std::span<const std::size_t> positions, std::span<Entry> out) const {
    if (form_.exact && !join()) {
        const auto boxes = std::get<std::span<const Box3f>>(first_->boxes);
        for (std::size_t i = 0; i < out.size(); ++i) std::memcpy(&out[i], &boxes[positions[i]], sizeof(Box3f));
        return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        double padding = 0;
        const Box3d wide = box(std::uint32_t(positions[i]), padding);
        out[i] = form_.rounding.entry(wide, padding);
    }
}

void BoxSource::refuse(std::size_t begin, const SetBegins& begins) const {
    throw_invalid_box(*first_, second_, begin, begins);
}

}  // namespace octopair
