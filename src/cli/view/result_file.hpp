// Reads the results that octopair writes: pairs (.npy), and pairs, events and collisions as text (.csv, .jsonl).
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/collision.hpp"
#include "octopair/objects.hpp"

namespace octopair::cli {

/// Rows of one frame, ascending by pair.
struct ResultFrame {
    std::vector<Pair> pairs;
    std::vector<Finding> findings;  ///< one per pair, or empty
};

struct ResultFile {
    std::vector<ResultFrame> frames;  ///< at least one
    bool moving = false;              ///< true if rows have frames
    std::map<std::uint32_t, std::string> names;
    std::uint64_t objects = 0;  ///< 1 more than the largest index

    /// Returns whether a collision of any frame has contacts.
    bool has_contacts() const;
};

/// Returns whether the content of a file is a result, not a scene.
bool is_result(const std::string& path);

/// Throws: Error{bad_input} that names the file and the row; Error{io_failed, cancelled}.
ResultFile read_result(const std::string& path, const std::stop_token& stop);

}  // namespace octopair::cli
