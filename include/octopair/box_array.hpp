// BoxArray: an array of boxes in memory that an engine allocated. The engine reads these boxes without copying them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "octopair/objects.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// Owns boxes, aligned to 64 bytes and uninitialised. Engine::allocate_boxes makes them. The array may outlive the engine.
/// Empty after default construction or a move from it. Thread safety: none.
template <typename Element>
class BoxArray {
    static_assert(std::is_same_v<Element, Box3f> || std::is_same_v<Element, Box3d>);

public:
    BoxArray() = default;
    BoxArray(BoxArray&& other) noexcept
        : memory_(std::move(other.memory_)), boxes_(std::exchange(other.boxes_, std::span<Element>())) {}
    BoxArray& operator=(BoxArray&& other) noexcept {
        BoxArray moved(std::move(other));
        std::swap(memory_, moved.memory_);
        std::swap(boxes_, moved.boxes_);
        return *this;
    }
    ~BoxArray() = default;

    std::span<Element> boxes() noexcept { return boxes_; }
    std::span<const Element> boxes() const noexcept { return boxes_; }
    std::uint64_t size() const noexcept { return boxes_.size(); }

private:
    friend class Engine;
    BoxArray(std::shared_ptr<void> memory, std::uint64_t count)
        : memory_(std::move(memory)), boxes_(static_cast<Element*>(memory_.get()), std::size_t(count)) {}

    std::shared_ptr<void> memory_;
    std::span<Element> boxes_;
};

}  // namespace octopair
