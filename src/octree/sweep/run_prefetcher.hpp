// RunPrefetcher: prefetches the entries that a later step reads, while another step computes.
#pragma once

#include <algorithm>
#include <span>

#include "base/memory.hpp"
#include "octree/plan/octant_cells.hpp"

namespace octopair {

/// Prefetches runs of entries, a cache line at a time. Borrows the span of the runs.
class RunPrefetcher {
public:
    RunPrefetcher() = default;
    explicit RunPrefetcher(std::span<const std::span<const CellEntry>> runs) : runs_(runs) {}

    /// Prefetches the next line, if there is one.
    void fetch_line() {
        if (at_ == end_) {
            if (runs_.empty()) return;
            at_ = runs_.front().data();
            end_ = at_ + runs_.front().size();
            runs_ = runs_.subspan(1);
        }
        prefetch(at_);
        constexpr std::ptrdiff_t line = 64 / sizeof(CellEntry);
        at_ += std::min(line, end_ - at_);
    }
    void fetch_rest() {
        while (at_ != end_ || !runs_.empty()) fetch_line();
    }

private:
    std::span<const std::span<const CellEntry>> runs_;
    const CellEntry *at_ = nullptr, *end_ = nullptr;
};

}  // namespace octopair
