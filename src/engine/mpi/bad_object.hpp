// How a rank refuses an object of which the others must know.
#pragma once

#include <cstddef>
#include <cstdint>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// The first object of a rank's source, from this one on, that is not a box. position(number) is where an object of the
/// source stands among those of all ranks, named_from(number) what its name there adds to its number in its set.
template <typename Position, typename NamedFrom>
[[noreturn]] void refuse_object(const BoxSource& source, std::size_t number, const Position& position,
                                const NamedFrom& named_from) {
    Entry entry;
    while (number + 1 < source.size() && source.load(number, {&entry, 1})) ++number;
    try {
        source.refuse(number, named_from(number));
    } catch (const Error& error) {
        throw BadObject{std::uint64_t(position(number)), error.what()};
    }
}

}  // namespace octopair
