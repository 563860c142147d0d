// Facts: what all ranks of a command must have in common, such as options and input files. Ranks that differ would find the pairs of no
// scene, or wait for each other for ever.
#pragma once

#include <string>
#include <vector>

namespace octopair::cli {

struct Fact {
    std::string what;        ///< for messages, such as "--margin"; unique on a rank
    std::string value;       ///< to be the same on all ranks
    std::string where = {};  ///< shown behind the value, such as the path of a file; may differ
};
using Facts = std::vector<Fact>;

/// `of_ranks` has the facts of each rank. Throws: Error{usage} about the first fact that is not that of the first rank.
void check_facts_agree(const std::vector<Facts>& of_ranks);

/// Facts as bytes, to send them. Requires: no text contains '\0'.
std::string packed(const Facts& facts);
Facts unpacked(const std::string& bytes);

}  // namespace octopair::cli
