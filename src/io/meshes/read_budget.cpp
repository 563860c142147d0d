#include "io/meshes/read_budget.hpp"

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

void ReadBudget::charge(std::uint64_t count, std::uint64_t bytes) {
    if (count <= (limit() - charged_) / bytes) {
        charged_ += count * bytes;
        return;
    }
    throw Error(ErrorCode::resource_limit,
                fmt::format("{}: its content needs more than {} bytes of memory, the limit for {} bytes of files",
                            path_, limit(), file_bytes_));
}

void ReadBudget::checkpoint() const {
    if (stop_.stop_requested()) cancel();
}

}  // namespace octopair::io
