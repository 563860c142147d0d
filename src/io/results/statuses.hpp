// Statuses: what people decided about collisions, in a .json file that is carried from run to run (docs/formats.md).
//
// - A collision is known by its key (collision_key.hpp).
// - A collision that is found for the first time is new. A known one keeps its status and comment.
// - A known collision that is no longer found is resolved, and stays in the file. If it is found again, it is new.
// - A collision of class "clearance" that meets now is new.
// - The file has one line for each collision, in the order of the keys. Keys of an entry that octopair does not know stay.
// - A known collision that options leave out of the result keeps its status. It need not be gone: octopair did not test it, or found it and
//   made no row of it.
// - The file has the options that say what a collision is, such as the margin. A run with other options is refused, because it would resolve
//   collisions that still exist.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/atomic_file.hpp"
#include "io/results/collision_row.hpp"

namespace octopair::io {

/// Options that say what a collision is: names and values, in a fixed order.
using MeaningOptions = std::vector<std::pair<std::string, std::string>>;

struct StatusCounts {
    std::array<std::uint64_t, status_values> found = {};  ///< rows of this result by status
    std::uint64_t resolved = 0;                           ///< collisions in the file that are not found any more
};

class Statuses {
public:
    /// Reads a file of statuses. A file that does not exist has none. Creates a temporary file, so that an unwritable folder is an error now.
    /// Throws: Error{bad_input} that names the file and the entry; Error{usage} if the file belongs to other options;
    /// Error{io_failed, cancelled}.
    Statuses(const std::string& path, MeaningOptions options, const std::stop_token& stop = {});

    /// Returns the status of each collision of the result. Call it for consecutive parts of the result, each part once. The comments are
    /// borrowed. `findings` has one element per pair, or is empty.
    std::vector<RowStatus> take(std::span<const Pair> pairs, std::span<const Finding> findings,
                                const CollisionNames& names);

    /// Takes pairs that options leave out of the result. In any order; not only collisions.
    void leave_out(std::span<const Pair> pairs, const CollisionNames& names);

    /// Writes the file. `complete`: the result has all collisions but those left out, so other known ones are resolved.
    /// Throws: Error{bad_input} if the file was changed since it was read; Error{io_failed}.
    void write(bool complete);

    /// Requires: take() has had the whole result.
    StatusCounts counts() const;

private:
    struct Entry {
        Status status = Status::begun;
        std::string comment = {};
        std::string collision_class = {};         // word of the class, when the collision was found last; or empty
        std::array<std::string, 2> objects = {};  // names for people, in the order of the key
        std::string others = {};                  // other keys of the entry: ,"KEY":VALUE,...
        bool found = false, left_out = false;     // in this result
    };

    void read(std::string_view text);
    void check_options(std::string_view recorded) const;
    static std::string line_of(const std::string& key, const Entry& entry);

    std::string path_;
    MeaningOptions options_;
    std::optional<std::string> text_;       // content of the file when it was read; nothing: it did not exist
    std::string others_;                    // other keys of the file: ,\n"KEY":VALUE...
    std::map<std::string, Entry> entries_;  // by key
    AtomicFile file_;
};

}  // namespace octopair::io
