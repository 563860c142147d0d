// ListMaker: makes the sorted list of a rank's objects, in the paper's arrangement.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

class ListMaker {
public:
    /// Encodes and sorts the objects of a source. Returns their list, whose memory stays valid until the next call.
    /// `first_object`: number of the first object among the objects of all ranks.
    /// Throws: Error{cancelled}; LinearOctree::Invalid.
    SortedList make(const EntrySource& source, const OctreeLayout& layout, std::uint32_t first_object,
                    const std::stop_token& stop);

private:
    BuildMemory memory_{own_pages(), own_pages()};
    Buffer<Entry> entries_;
};

}  // namespace octopair
