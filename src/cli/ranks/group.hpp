// Group: the processes that run one command together: this process alone, or the ranks of MPI (cluster.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "octopair/error.hpp"

namespace octopair::cli {

/// Implements a group of this process alone. Cluster overrides all virtual functions for the ranks of MPI.
class Group {
public:
    Group() = default;
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;
    virtual ~Group() = default;

    virtual unsigned rank() const { return 0; }
    virtual unsigned ranks() const { return 1; }
    bool first() const { return rank() == 0; }

    /// Collective. Runs `part`.
    /// Throws: if `part` throws on any rank, the same Error on all ranks.
    virtual void together(const std::function<void()>& part) { part(); }

    /// Throws Error{bad_input} about an object. Requires: called within together(). If several ranks call it, together() throws the error
    /// with the lowest `position`: a number that orders the objects of all ranks.
    [[noreturn]] virtual void refuse_object([[maybe_unused]] std::uint64_t position, const std::string& message) {
        throw Error(ErrorCode::bad_input, message);
    }
};

}  // namespace octopair::cli
