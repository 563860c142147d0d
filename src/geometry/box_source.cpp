#include "geometry/box_source.hpp"

#include <algorithm>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>

#include "geometry/box_kernel.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr const char* axis_names = "xyz";

std::string number_text(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

bool holds_float32(const Objects& set) { return std::holds_alternative<std::span<const Box3f>>(set.boxes); }

Box3d wide_box(const Objects& set, std::size_t index) {
    return std::visit([&](auto boxes) { return wide(boxes[index]); }, set.boxes);
}

}  // namespace

BoxSource::BoxSource(const Objects& first, const Objects* second, double margin)
    : first_(&first), second_(second), first_size_(first.size()), second_size_(second != nullptr ? second->size() : 0) {
    rounding_.margin = margin;
    const auto plain = [](const Objects& set) { return holds_float32(set) && set.padding.empty(); };
    exact_ = margin == 0 && plain(first) && (second == nullptr || plain(*second));
    if (!exact_) choose_origin();
}

void BoxSource::choose_origin() {
    // The median of a strided sample: near the bulk, whatever a few far objects do.
    constexpr std::size_t samples = 255;
    const std::size_t count = std::min(samples, size());
    if (count == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
        std::array<double, samples> lows{};
        std::size_t used = 0;
        for (std::size_t i = 0; i < count; ++i) {
            double padding = 0;
            const double low = box(std::uint32_t(i * size() / count), padding).min[axis];
            if (std::abs(low) <= DBL_MAX) lows[used++] = low;
        }
        if (used == 0) continue;
        std::nth_element(lows.begin(), lows.begin() + std::ptrdiff_t(used / 2), lows.begin() + std::ptrdiff_t(used));
        rounding_.origin[std::size_t(axis)] = lows[used / 2];
    }
}

Box3d BoxSource::box(std::uint32_t object, double& padding) const {
    const bool in_first = object < first_size_;
    const Objects& set = in_first ? *first_ : *second_;
    const std::size_t index = in_first ? object : object - first_size_;
    padding = set.padding.empty() ? 0 : set.padding[index];
    return wide_box(set, index);
}

bool BoxSource::counts(std::uint32_t a, std::uint32_t b) const {
    double padding_a = 0;
    double padding_b = 0;
    const Box3d box_a = box(a, padding_a);
    const Box3d box_b = box(b, padding_b);
    return within_reach(box_a, box_b, rounding_.margin + (padding_a + padding_b));
}

RoundingSlack BoxSource::slack() const {
    // A bound of an entry is off by at most 2^-23 of itself (rounding to float32) plus 2^-47 of the numbers it was made
    // from (OutwardRounding::error_part); more than four times that separates real overlaps from made
    // ones. The widening may exceed the entry's own coordinates, but then so does the box's extent: it is in them.
    RoundingSlack slack;
    for (unsigned axis = 0; axis < 3; ++axis)
        slack.base[axis] = round_up(std::abs(rounding_.origin[axis]) * 0x1p-44 + FLT_MIN);
    return slack;
}

template <typename Real>
bool BoxSource::load_set(std::span<const Box<Real>> boxes, std::span<const double> padding, std::size_t begin,
                         std::span<Entry> out) const {
    const auto some = boxes.subspan(begin, out.size());
    if constexpr (std::is_same_v<Real, float>) {
        if (exact_) return copy_boxes(some, out);
    }
    return round_boxes(some, padding.empty() ? padding : padding.subspan(begin, out.size()), rounding_, out);
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

std::span<const Box3f> BoxSource::plain(std::size_t begin, std::size_t count) const {
    if (!exact_ || join()) return {};
    return std::get<std::span<const Box3f>>(first_->boxes).subspan(begin, count);
}

void BoxSource::pick(std::span<const std::size_t> positions, std::span<Entry> out) const {
    if (const auto boxes = plain(0, size()); !boxes.empty()) {
        for (std::size_t i = 0; i < out.size(); ++i) std::memcpy(&out[i], &boxes[positions[i]], sizeof(Box3f));
        return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        double padding = 0;
        const Box3d wide = box(std::uint32_t(positions[i]), padding);
        out[i] = rounding_.entry(wide, padding);
    }
}

std::optional<std::string> BoxSource::fault(const Objects& set, std::size_t index) const {
    const Box3d box = wide_box(set, index);
    const std::string which =
        std::string(&set == first_ ? "" : "of the second set ") + "object " + std::to_string(index);
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name(1, axis_names[axis]);
        for (const auto& [value, end] : {std::pair{box.min[axis], "min "}, std::pair{box.max[axis], "max "}}) {
            if (!std::isfinite(value))
                return which + ": " + end + name + " is " + number_text(value) + ", not a finite number";
        }
        if (box.min[axis] > box.max[axis]) {
            return which + ": min " + name + " " + number_text(box.min[axis]) + " is above max " + name + " " +
                   number_text(box.max[axis]);
        }
    }
    if (!set.padding.empty() && !is_padding(set.padding[index])) {
        return which + ": padding is " + number_text(set.padding[index]) + ", not a finite number >= 0";
    }
    return std::nullopt;
}

void BoxSource::refuse(std::size_t begin) const {
    for (std::size_t i = begin; i < size(); ++i) {
        const bool in_first = i < first_size_;
        const auto found = fault(in_first ? *first_ : *second_, in_first ? i : i - first_size_);
        if (found) throw Error(ErrorCode::bad_input, *found);
    }
    throw Error(ErrorCode::bad_input, "an object changed while it was read");
}

}  // namespace octopair
