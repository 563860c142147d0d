// ObjectArrays: arrays of objects of one set that are sent between ranks.
#pragma once

#include <hwy/cache_control.h>

#include <cstddef>
#include <cstdint>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/objects.hpp"

namespace octopair {

struct ObjectArrays {
    bool wide = false;     ///< boxes are float64, in `wide_boxes`; otherwise float32, in `boxes`
    bool padded = false;   ///< `padding` is used
    bool indexed = false;  ///< objects are identified by `indices`; otherwise by `positions`
    Buffer<Box3f> boxes = {};
    Buffer<Box3d> wide_boxes = {};
    Buffer<double> padding = {};
    Buffer<std::uint32_t> positions = {};  ///< of the objects in the set
    Buffer<std::uint64_t> indices = {};

    std::size_t size() const { return indexed ? indices.size() : positions.size(); }
    void resize(std::size_t objects) {
        if (wide) wide_boxes.resize_discard(objects);
        if (!wide) boxes.resize_discard(objects);
        if (padded) padding.resize_discard(objects);
        if (indexed) indices.resize_discard(objects);
        if (!indexed) positions.resize_discard(objects);
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
                use([=](std::size_t to, std::size_t from) {
                    to_boxes[to] = from_boxes[from];
                    fetch_ahead(to_boxes + to);
                });
            }
        };
        if (wide) with(wide_boxes.data(), std::get<std::span<const Box3d>>(objects.boxes));
        if (!wide) with(boxes.data(), std::get<std::span<const Box3f>>(objects.boxes));
    }
    /// Calls use(name). name(to, from) stores the index of object `from` at place `to`, or its position, `slice_begin + from`.
    template <typename Use>
    void naming(std::span<const std::uint64_t> from_indices, std::uint64_t slice_begin, Use&& use) {
        if (indexed) {
            std::uint64_t* const to_indices = indices.data();
            use([=](std::size_t to, std::size_t from) { to_indices[to] = from_indices[from]; });
        } else {
            std::uint32_t* const to_positions = positions.data();
            use([=](std::size_t to, std::size_t from) {
                to_positions[to] = std::uint32_t(slice_begin + from);
                fetch_ahead(to_positions + to);
            });
        }
    }
    Objects view() const {
        const std::span<const double> paddings = padded ? padding.span() : std::span<const double>();
        if (wide) return {wide_boxes.span(), paddings};
        return {boxes.span(), paddings};
    }

private:
    /// Prefetches memory that is written soon. Hardware prefetchers do not follow writes that alternate between many places.
    template <typename T>
    static void fetch_ahead(const T* place) {
        constexpr std::size_t ahead_bytes = 112;
        hwy::Prefetch(reinterpret_cast<const std::byte*>(place) + ahead_bytes);
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

/// Collective. Sends the objects of `out`, with their indices or positions. Stores the received ones in `in`.
/// Requires: `out` and `in` are equally wide, padded and indexed; `in` is large enough.
inline void exchange(Communicator& comm, const ObjectArrays& out, ObjectArrays& in, const Exchange& counts) {
    exchange_objects(comm, out.view(), in, counts);
    if (out.indexed) comm.exchange(out.indices.data(), in.indices.data(), counts);
    if (!out.indexed) comm.exchange(out.positions.data(), in.positions.data(), counts);
}

}  // namespace octopair
