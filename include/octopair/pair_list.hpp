// PairList: the pairs that a call found, in order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair {

/// Pairs in order, owned, in one or more chunks. Reuse it from call to call: it keeps its memory.
/// Not thread-safe; chunks() is valid until the list is next written to or destroyed.
class PairList {
public:
    PairList();
    PairList(PairList&&) noexcept;
    PairList& operator=(PairList&&) noexcept;
    ~PairList();

    std::uint64_t size() const;
    std::span<const std::span<const Pair>> chunks() const;
    std::vector<Pair> to_vector() const;  ///< a copy

    struct Storage;  ///< what engines write to; its type is internal
    Storage& storage() { return *storage_; }

private:
    std::unique_ptr<Storage> storage_;
};

}  // namespace octopair
