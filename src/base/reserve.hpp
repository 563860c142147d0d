// reserve_more(): makes room in a vector before a change that must not fail half-way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace octopair {

/// Makes room for `more` additional elements. Doubles the capacity at least, so that repeated small calls do not copy each
/// time.
template <typename T>
void reserve_more(std::vector<T>& list, std::size_t more) {
    const std::size_t all = list.size() + more;
    if (all > list.capacity()) list.reserve(std::max(all, 2 * list.capacity()));
}

}  // namespace octopair
