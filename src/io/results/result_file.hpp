// Reads the results that octopair writes: pairs (.npy), and pairs, events and collisions as text (.csv, .jsonl).
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <string>

#include "io/results/result_frames.hpp"

namespace octopair::io {

struct ResultFile {
    ResultFrames frames;
    bool moving = false;            ///< true if rows or the name of the file have a frame number
    std::uint64_t first_frame = 0;  ///< frame number in the name, as in pairs.000003.npy: that of the first of `frames`
    std::map<std::uint32_t, std::string> names;
    std::uint64_t objects = 0;  ///< 1 more than the largest index
};

/// Returns whether the content of a file is a result, not a scene.
bool is_result(const std::string& path);

/// Throws: Error{bad_input} that names the file and the row; Error{io_failed, cancelled}.
ResultFile read_result(const std::string& path, const std::stop_token& stop);

}  // namespace octopair::io
