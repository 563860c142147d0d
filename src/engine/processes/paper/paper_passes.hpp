// PaperPasses: the paper's arrangement. Workers build sorted lists; the client alone merges and scans them.
//
// Source: Lucchesi, Egbert, Harris 2014, section 4.
#pragma once

#include <memory>
#include <vector>

#include "engine/processes/client/shared_inputs.hpp"
#include "engine/processes/client/worker_pool.hpp"
#include "engine/processes/paper/sorted_lists.hpp"
#include "engine/threads/thread_passes.hpp"

namespace octopair {

class PaperPasses final : public ThreadPasses {
public:
    /// Requires: `pool` and `arrays` outlive this object.
    PaperPasses(WorkerPool& pool, const SharedArrays& arrays) : ThreadPasses(1), pool_(pool), inputs_(arrays) {}

    void build(Call& call, double progress) override;

private:
    std::vector<SortedList> find_lists(std::size_t lists, const ListBounds& bounds) const;

    WorkerPool& pool_;
    SharedInputs inputs_;
    std::shared_ptr<Region> arena_;
};

}  // namespace octopair
