// Role file: the roles of clients that are not owners (caller.hpp).
//
// Each line is CLIENT ROLE. CLIENT is a client's name as in the log (access.hpp). ROLE is one of
//   owner            the role of all clients that the file does not name
//   reader OWNER     sees the jobs of this owner, and reads their results
//   operator         sees and cancels the jobs of all owners, and drains the server
//   none             has no access
// A name that contains blanks or quotes is in quotes, in which \" and \\ stand for " and \.
// Lines that begin with # are comments, and empty lines are skipped. A file with any other line is refused.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "service/server/net/caller.hpp"

namespace octopair::service {

class Roles {
public:
    /// All clients are owners.
    Roles() = default;
    /// Throws: as read_private_file; Error{bad_input} for an invalid line or a client with two lines.
    explicit Roles(const std::string& path);

    /// Returns the names of the clients that the file has lines for.
    std::vector<std::string> clients() const;
    /// Returns the caller with this name and its role.
    Caller caller(const std::string& name) const;

private:
    void add_line(std::string_view text);

    std::map<std::string, Caller> callers_;
};

}  // namespace octopair::service
