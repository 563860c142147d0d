// Refusal of an invalid object, so that all ranks report the same object.
#pragma once

#include <cstddef>
#include <cstdint>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// Refuses the first object of a rank's source, from `number` on, that is not a valid box. position(number) returns the
/// position of an object among the objects of all ranks. named_from(number) returns the offsets, one for each set, that turn
/// an object's number in the source into its name. Throws: BadObject.
template <typename Position, typename NamedFrom>
[[noreturn]] void refuse_object(const BoxSource& source, std::size_t number, const Position& position,
                                const NamedFrom& named_from) {
    Entry entry;
    while (number + 1 < source.size() && source.load(number, {&entry, 1})) ++number;
    try {
        source.refuse(number, named_from(number));
    } catch (const Error& error) {
        throw BadObject{std::uint64_t(position(number)), error.what(), error.place()};
    }
}

}  // namespace octopair
