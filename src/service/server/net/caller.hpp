// Caller: the client that makes a call, its role, and what the role permits.
//
//   role       Describe  run and submit jobs  see jobs     read results  cancel  release  drain
//   owner      yes       yes                  its own      its own       own     own      no
//   reader     yes       no                   one owner's  one owner's   no      no       no
//   operator   yes       no                   all          no            all     no       yes
// A caller that may see an owner's jobs may also list the owner's scenes. A caller that may read the results may watch the scenes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::service {

/// `none`: every call is refused.
enum class Role : std::uint8_t { owner, reader, server_operator, none };

/// Kinds of calls that roles permit or refuse.
enum class Right : std::uint8_t { describe, submit, see, read, cancel, release, drain };

struct Caller {
    std::string name;  ///< owner of the jobs that the caller submits (access.hpp)
    Role role = Role::owner;
    std::string reads = {};  ///< reader: the owner whose jobs it sees

    /// Returns whether the role has the right, for some jobs.
    bool may(Right right) const {
        switch (role) {
            case Role::owner:
                return right != Right::drain;
            case Role::reader:
                return right == Right::describe || right == Right::see || right == Right::read;
            case Role::server_operator:
                return right == Right::describe || right == Right::see || right == Right::cancel ||
                       right == Right::drain;
            case Role::none:
                break;
        }
        return false;
    }
    /// Returns whether the caller sees the jobs of all owners.
    bool sees_all() const { return role == Role::server_operator; }
    /// Returns whether the caller sees the jobs and scenes of `job_owner`.
    bool sees(const std::string& job_owner) const { return sees_all() || owner() == job_owner; }
    /// Returns the owner whose jobs the caller sees, unless it sees those of all.
    const std::string& owner() const { return role == Role::reader ? reads : name; }
};

/// Returns the name of the role in the role file and in messages.
constexpr std::string_view name_of(Role role) {
    switch (role) {
        case Role::owner:
            return "owner";
        case Role::reader:
            return "reader";
        case Role::server_operator:
            return "operator";
        case Role::none:
            break;
    }
    return "none";
}

}  // namespace octopair::service
