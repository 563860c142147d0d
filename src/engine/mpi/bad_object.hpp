// How a rank refuses an object of which the others must know.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/mpi/agreement.hpp"
#include "geometry/box_source.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// The first object of a rank's source, from this one on, that is not a box. `begins`: where the source's sets begin among
/// those of all ranks; position(number) is where an object of the source stands there.
template <typename Position>
[[noreturn]] void refuse_object(const BoxSource& source, std::size_t number, const SetBegins& begins,
                                const Position& position) {
    Entry entry;
    while (number + 1 < source.size() && source.load(number, {&entry, 1})) ++number;
    try {
        source.refuse(number, begins);
    } catch (const Error& error) {
        throw BadObject{std::uint64_t(position(number)), error.what()};
    }
}

}  // namespace octopair
