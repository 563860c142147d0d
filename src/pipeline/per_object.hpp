// PerObject: one value for each object of a call, which has one set, or two sets in a join.
// in_second_set(): marks errors as errors about an object of the second set.
//
// A pair with an object that has no value is an error: the caller gave the filter values for other objects than those of the engine.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "octopair/error.hpp"
#include "octopair/objects.hpp"

namespace octopair {

template <typename Value>
class PerObject {
public:
    /// `what` names the value in error messages. Borrows the spans.
    PerObject(const char* what, std::span<const Value> first, std::optional<std::span<const Value>> second)
        : what_(what), first_(first), second_(second.value_or(first)), in_join_(second.has_value()) {}

    const Value& first(std::uint32_t a) const { return at(first_, a, 0); }
    const Value& second(std::uint32_t b) const { return at(second_, b, in_join_ ? 1 : 0); }

    /// Throws: Error{bad_input} if an object of the pair has no value.
    void check(Pair pair) const { (void)first(pair.a), (void)second(pair.b); }
    std::span<const Value> all_first() const { return first_; }
    std::span<const Value> all_second() const { return second_; }

private:
    const Value& at(std::span<const Value> values, std::uint32_t object, unsigned set) const {
        if (object >= values.size()) refuse(values.size(), {.index = object, .set = set, .frame = {}});
        return values[object];
    }
    [[noreturn]] void refuse(std::size_t size, const ErrorPlace& object) const {
        throw PlacedError(ErrorCode::bad_input,
                          "object " + std::to_string(object.index) + " has no " + what_ + ": values were given for " +
                              std::to_string(size) + " objects",
                          object);
    }

    const char* what_;
    std::span<const Value> first_, second_;
    bool in_join_;
};

/// Calls `check`, which checks the objects of a second set. An error about one of them gets the set 1 (Error::place()).
/// Throws: what `check` throws.
template <typename Check>
void in_second_set(Check&& check) {
    try {
        std::forward<Check>(check)();
    } catch (const Error& error) {
        auto place = error.place();
        if (!place) throw;
        place->set = 1;
        throw PlacedError(error.code(), error.what(), *place);
    }
}

}  // namespace octopair
