// Baseline: compares a new result with an older one, and says which collisions are new, the same, or gone.
//
// - Rows with the same key (collision_key.hpp) are the same collision.
// - A row of the older result without a key is of octopair 0.2 or of another program. It is matched by the names of its two objects, in any
//   order. A triangle adds its number within its owner. The number of an object stands for a missing name, in a join with the set.
// - Collisions with the same key are matched in order: the first old row with the first new row, and so on.
// - A pair that was apart (class "clearance") and is now in contact counts as new, and the other way round.
// - A row without a class matches rows of any class.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/results/collision_row.hpp"

namespace octopair::io {

struct ChangeCounts {
    std::uint64_t begun = 0, same = 0, gone = 0;
};

class Baseline {
public:
    /// Reads a .jsonl file of collisions or pairs. `join` says whether the result is that of a join.
    /// Throws: Error{bad_input} that names the file and the line; Error{io_failed, cancelled}.
    Baseline(const std::string& path, bool join, const std::stop_token& stop = {});
    /// Parses the text of such a file. `file` is the name that messages begin with.
    static Baseline of_text(std::string_view text, std::string_view file, bool join);

    /// Returns the change of each new collision. Call it for consecutive parts of the new result, each part once.
    /// `findings` has one element per pair, or is empty.
    std::vector<Change> compare(std::span<const Pair> pairs, std::span<const Finding> findings,
                                const CollisionNames& names);

    /// Returns the lines of the old collisions that match no new collision, in their order.
    std::vector<std::string_view> gone() const;
    /// Returns the number of collisions by change. Requires: compare() has had all new collisions.
    ChangeCounts counts() const;

private:
    explicit Baseline(bool join) : join_(join) {}
    void read(std::string_view text, std::string_view file, const std::stop_token& stop);
    /// Matches a new collision with the first unmatched old collision that has the key. Returns whether there was such a collision.
    bool match(std::string key, CollisionClass collision_class);

    bool join_;
    bool by_name_ = false;  // true if a line has no key
    std::vector<std::string> lines_;
    std::vector<bool> matched_;  // for each line: true if a new collision matched it
    /// Unmatched lines by key, the last line first. The first character of a key is the contact state (baseline.cpp).
    std::unordered_map<std::string, std::vector<std::size_t>> unmatched_;
    ChangeCounts counts_;
};

}  // namespace octopair::io
