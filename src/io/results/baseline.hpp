// An older result that a new one is held against: which collisions are new, which are gone, which are the same.
//
// A collision is known by the names of its two objects, in any order, and triangles by their number within their owner as
// well; an object without a name by its number, and in a join by its set. Where several collisions have the same names,
// the first of the old ones is the first of the new ones, and so on. Two objects that were apart, within the margin, and
// meet now are something new, and the other way round; a row that says nothing of its class may be either.
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
    /// A .jsonl file of collisions or pairs. Throws Error{bad_input} that names the file and the line, Error{io_failed,
    /// cancelled}.
    Baseline(const std::string& path, bool join, const std::stop_token& stop = {});
    /// The same for what is in such a file.
    static Baseline of_text(std::string_view text, std::string_view file, bool join);

    /// How each of the new collisions stands to the old ones; called with all of them, in order, once. `findings`: as
    /// many, or none.
    std::vector<Change> compare(std::span<const Pair> pairs, std::span<const Finding> findings,
                                const CollisionNames& names);

    /// Of the old collisions, the lines of those that compare() has not met, in their order.
    std::vector<std::string_view> gone() const;
    /// After all calls of compare().
    ChangeCounts counts() const;

private:
    explicit Baseline(bool join) : join_(join) {}
    void read(std::string_view text, std::string_view file, const std::stop_token& stop);
    std::string key_of(Pair pair, const CollisionNames& names) const;
    /// Whether an old collision with this key waits for a new one of this class; it waits no more.
    bool find_again(std::string key, CollisionClass collision_class);

    bool join_;
    std::vector<std::string> lines_;
    std::vector<bool> met_;  // of each line
    /// Of each key, which begins with how the two stand, the lines with it, the last one first.
    std::unordered_map<std::string, std::vector<std::size_t>> waiting_;
    ChangeCounts counts_;
};

}  // namespace octopair::io
