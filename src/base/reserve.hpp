// Room in a vector before something is changed that must not fail half-way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace octopair {

/// Room for so many more, by doubling: a few at a time do not copy all each time.
template <typename T>
void reserve_more(std::vector<T>& list, std::size_t more) {
    const std::size_t all = list.size() + more;
    if (all > list.capacity()) list.reserve(std::max(all, 2 * list.capacity()));
}

}  // namespace octopair
