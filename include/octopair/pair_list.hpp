// PairList: the pairs that a call found, in order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octopair/objects.hpp"

namespace [[gnu::visibility("default")]] octopair {

class PairList;

namespace detail {  // not for users
struct PairStorage;
PairStorage& storage_of(PairList& list);
}  // namespace detail

/// Owns pairs, in order, in one or more chunks. Reuse the list for later calls: it keeps its memory. chunks() is valid until
/// the list is next written or destroyed. Thread safety: none.
class PairList {
public:
    PairList();
    PairList(PairList&&) noexcept;
    PairList& operator=(PairList&&) noexcept;
    ~PairList();

    std::uint64_t size() const;
    std::span<const std::span<const Pair>> chunks() const;
    std::vector<Pair> to_vector() const;  ///< copies all pairs

private:
    friend detail::PairStorage& detail::storage_of(PairList& list);
    std::unique_ptr<detail::PairStorage> storage_;
};

}  // namespace octopair
