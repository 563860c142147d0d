// ObjectArrays: arrays of objects of one set that are sent between ranks.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/objects.hpp"

namespace octopair {

struct ObjectArrays {
    bool wide = false;     ///< boxes are float64, in `wide_boxes`; otherwise float32, in `boxes`
    bool padded = false;   ///< `padding` is used
    bool indexed = false;  ///< objects are identified by `indices`; otherwise by `positions` or `near_positions`
    bool near = false;     ///< unless `indexed`: objects are identified by `near_positions`
    Buffer<Box3f> boxes = {};
    Buffer<Box3d> wide_boxes = {};
    Buffer<double> padding = {};
    Buffer<std::uint32_t> positions = {};       ///< position of each object in its set
    Buffer<std::uint16_t> near_positions = {};  ///< lowest bits of each position (Routing::near_position)
    Buffer<std::uint64_t> indices = {};

    std::size_t size() const { return indexed ? indices.size() : near ? near_positions.size() : positions.size(); }
    void resize(std::size_t objects) {
        if (wide) wide_boxes.resize_discard(objects);
        if (!wide) boxes.resize_discard(objects);
        if (padded) padding.resize_discard(objects);
        if (indexed) indices.resize_discard(objects);
        if (!indexed && near) near_positions.resize_discard(objects);
        if (!indexed && !near) positions.resize_discard(objects);
    }
    /// Calls use(copy). copy(to, from) copies box and padding of object `from` of `objects` to place `to`.
    /// Requires: `objects` have the same form (`wide`, `padded`).
    template <typename Use>
    void copying(const Objects& objects, Use&& use) {
        const auto with = [&](auto* to_boxes, auto from_boxes) {
            double* const to_padding = padding.data();
            const double* const from_padding = objects.padding.data();
            if (padded) {
                use([=](std::size_t to, std::size_t from) {
                    to_boxes[to] = from_boxes[from];
                    to_padding[to] = from_padding[from];
                });
            } else {
                use([=](std::size_t to, std::size_t from) { to_boxes[to] = from_boxes[from]; });
            }
        };
        if (wide) with(wide_boxes.data(), std::get<std::span<const Box3d>>(objects.boxes));
        if (!wide) with(boxes.data(), std::get<std::span<const Box3f>>(objects.boxes));
    }
    Objects view() const {
        const std::span<const double> paddings = padded ? padding.span() : std::span<const double>();
        if (wide) return {wide_boxes.span(), paddings};
        return {boxes.span(), paddings};
    }
};

/// Collective. Sends boxes and paddings of `out`. Stores the received ones in `in`, from `place` on.
/// Requires: `out` and `in` are equally wide and padded; `in` is large enough.
// NOLINTNEXTLINE(readability-function-size): source, target, and the two numbers are one concept here.
inline void exchange_objects(Communicator& comm, const Objects& out, ObjectArrays& in, const Exchange& counts,
                             std::size_t place = 0) {
    if (in.wide) {
        comm.exchange(std::get<std::span<const Box3d>>(out.boxes).data(), in.wide_boxes.data() + place, counts);
    } else {
        comm.exchange(std::get<std::span<const Box3f>>(out.boxes).data(), in.boxes.data() + place, counts);
    }
    if (in.padded) comm.exchange(out.padding.data(), in.padding.data() + place, counts);
}

}  // namespace octopair
