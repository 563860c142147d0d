// Values of each object of the two sets that a pair is of, which may be one and the same. A number beyond a set's end is an
// error: the filter was given the values of other objects than the pipeline.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "octopair/error.hpp"
#include "octopair/objects.hpp"

namespace octopair {

template <typename Value>
class PerObject {
public:
    /// `what`: of what an object has none, in the message.
    PerObject(const char* what, std::span<const Value> first, std::optional<std::span<const Value>> second)
        : what_(what), first_(first), second_(second.value_or(first)) {}

    const Value& first(std::uint32_t a) const { return at(first_, a); }
    const Value& second(std::uint32_t b) const { return at(second_, b); }

    /// Throws where a number is beyond the end.
    void check(Pair pair) const { (void)first(pair.a), (void)second(pair.b); }
    std::span<const Value> all_first() const { return first_; }
    std::span<const Value> all_second() const { return second_; }

private:
    const Value& at(std::span<const Value> values, std::uint32_t object) const {
        if (object >= values.size()) refuse(values.size(), object);
        return values[object];
    }
    [[noreturn]] void refuse(std::size_t size, std::uint32_t object) const {
        throw Error(ErrorCode::bad_input,
                    "object " + std::to_string(object) + " has no " + what_ + ": there are " + std::to_string(size));
    }

    const char* what_;
    std::span<const Value> first_, second_;
};

}  // namespace octopair
