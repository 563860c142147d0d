// ArrayPool: keeps the box arrays of ended jobs for later jobs. The system need not clear memory that a job has used before;
// clearing takes a third as long as a search of these boxes.
#pragma once

#include <cstdint>
#include <mutex>
#include <variant>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/engine.hpp"

namespace octopair::service {

using AnyBoxes = std::variant<BoxArray<Box3f>, BoxArray<Box3d>>;

/// Thread safety: any thread may call it.
class ArrayPool {
public:
    /// Returns a pooled or new array of at least `count` boxes in memory of `engine`. Throws: Error.
    template <typename Real>
    BoxArray<Box<Real>> take(Engine& engine, std::uint64_t count) {
        AnyBoxes spare = find(engine, AnyBoxes(BoxArray<Box<Real>>()).index(), count);
        auto& boxes = std::get<BoxArray<Box<Real>>>(spare);
        return boxes.size() >= count && count > 0 ? std::move(boxes) : engine.allocate_boxes<Box<Real>>(count);
    }
    /// Returns `boxes` to the pool. The pool frees arrays that are too small or too large, and the oldest ones when it is full.
    void give(const Engine& engine, AnyBoxes boxes) noexcept;
    /// Frees all arrays of the pool.
    void clear() noexcept;
    /// Returns the number of bytes in the pool.
    std::uint64_t bytes() const;

private:
    struct Spare {
        const Engine* engine = nullptr;
        AnyBoxes boxes;
    };

    /// Takes out an array of type `kind` (index in AnyBoxes) with `count` to 9/8 `count` boxes. Returns an empty array of that
    /// type if there is none.
    AnyBoxes find(const Engine& engine, std::size_t kind, std::uint64_t count);

    mutable std::mutex mutex_;
    std::vector<Spare> spares_;  // oldest first
    std::uint64_t bytes_ = 0;
};

}  // namespace octopair::service
