// ArrayPool: the arrays of jobs that ended, for the next ones: memory that a job had before need not be cleared by the system,
// which takes a third as long as a search of these boxes.
#pragma once

#include <cstdint>
#include <mutex>
#include <variant>
#include <vector>

#include "octopair/box_array.hpp"
#include "octopair/engine.hpp"

namespace octopair::service {

using AnyBoxes = std::variant<BoxArray<Box3f>, BoxArray<Box3d>>;

/// Thread-safe.
class ArrayPool {
public:
    /// At least `count` boxes, where `engine` reads them. Throws Error.
    template <typename Real>
    BoxArray<Box<Real>> take(Engine& engine, std::uint64_t count) {
        AnyBoxes spare = find(engine, AnyBoxes(BoxArray<Box<Real>>()).index(), count);
        auto& boxes = std::get<BoxArray<Box<Real>>>(spare);
        return boxes.size() >= count && count > 0 ? std::move(boxes) : engine.allocate_boxes<Box<Real>>(count);
    }
    /// Keeps them, or not.
    void give(const Engine& engine, AnyBoxes boxes) noexcept;
    /// Kept.
    std::uint64_t bytes() const;

private:
    struct Spare {
        const Engine* engine = nullptr;
        AnyBoxes boxes;
    };

    /// One of the kind that is not much too large; or none, in that kind.
    AnyBoxes find(const Engine& engine, std::size_t kind, std::uint64_t count);

    mutable std::mutex mutex_;
    std::vector<Spare> spares_;  // from the oldest on
    std::uint64_t bytes_ = 0;
};

}  // namespace octopair::service
