// ObjectArrays: objects of one set on their way from rank to rank, as arrays.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/memory.hpp"
#include "engine/mpi/communicator.hpp"
#include "octopair/objects.hpp"

namespace octopair {

struct ObjectArrays {
    bool wide = false;    ///< boxes are float64: `wide_boxes` has them, otherwise `boxes`
    bool padded = false;  ///< otherwise `padding` is empty
    Buffer<Box3f> boxes = {};
    Buffer<Box3d> wide_boxes = {};
    Buffer<double> padding = {};
    Buffer<std::uint32_t> positions = {};  ///< in the set, of all ranks'

    std::size_t size() const { return positions.size(); }
    void resize(std::size_t objects) {
        if (wide) wide_boxes.resize_discard(objects);
        if (!wide) boxes.resize_discard(objects);
        if (padded) padding.resize_discard(objects);
        positions.resize_discard(objects);
    }
    /// The object `from` of the same set becomes number `to`.
    void put(std::size_t to, const Objects& objects, std::size_t from, std::uint32_t position) {
        if (wide) wide_boxes[to] = std::get<std::span<const Box3d>>(objects.boxes)[from];
        if (!wide) boxes[to] = std::get<std::span<const Box3f>>(objects.boxes)[from];
        if (padded) padding[to] = objects.padding[from];
        positions[to] = position;
    }
    Objects view() const {
        const std::span<const double> paddings = padded ? padding.span() : std::span<const double>();
        if (wide) return {wide_boxes.span(), paddings};
        return {boxes.span(), paddings};
    }
};

/// Collective: `out` holds what is to be sent; `in`, of the same form and large enough, gets what comes.
inline void exchange(Communicator& comm, const ObjectArrays& out, ObjectArrays& in, const Exchange& counts) {
    if (out.wide) comm.exchange(out.wide_boxes.data(), in.wide_boxes.data(), counts);
    if (!out.wide) comm.exchange(out.boxes.data(), in.boxes.data(), counts);
    if (out.padded) comm.exchange(out.padding.data(), in.padding.data(), counts);
    comm.exchange(out.positions.data(), in.positions.data(), counts);
}

}  // namespace octopair
