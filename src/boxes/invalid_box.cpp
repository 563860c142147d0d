#include "boxes/invalid_box.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "boxes/box_check.hpp"
#include "boxes/box_kernel.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr const char* axis_names = "xyz";

std::string number_text(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

/// Returns what is wrong with an object of a set. Returns nothing if the object is a valid box. `which`: name of the object.
std::optional<std::string> fault(const Objects& set, std::size_t index, const std::string& which) {
    const Box3d box = wide_box(set, index);
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

}  // namespace

void throw_invalid_box(const Objects& first, const Objects* second, std::size_t begin, const SetBegins& begins) {
    const std::size_t first_size = first.size(), size = first_size + (second != nullptr ? second->size() : 0);
    for (std::size_t i = begin; i < size; ++i) {
        const bool in_first = i < first_size;
        const std::size_t in_set = in_first ? i : i - first_size;
        const std::uint64_t index = (in_first ? begins.first : begins.second) + in_set;
        const std::string which = (in_first ? "object " : "second set: object ") + std::to_string(index);
        if (const auto found = fault(in_first ? first : *second, in_set, which)) {
            throw PlacedError(ErrorCode::bad_input, *found, {.index = index, .set = in_first ? 0u : 1u, .frame = {}});
        }
    }
    throw_object_changed();
}

void throw_object_changed() { throw Error(ErrorCode::bad_input, "an object changed while it was read"); }

}  // namespace octopair
