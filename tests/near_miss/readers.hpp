// The parsers of octopair that near misses test. Each function parses the bytes of one file, and appends what they say to `values`.
// Throws: Error, as the parser.
#pragma once

#include <string>

#include "near_miss/values.hpp"

namespace octopair::test {

/// A file with a name, for parsers that open their file themselves.
struct NearMissFile {
    std::string content;
    std::string path;  ///< file with this content, which only its owner can access
};

// Inputs.
void read_csv(const NearMissFile& file, Values& values);
void read_npy(const NearMissFile& file, Values& values);
void read_json_scene(const NearMissFile& file, Values& values);
void read_exclusion_rules(const NearMissFile& file, Values& values);

// Options.
void read_config(const NearMissFile& file, Values& values);
void read_count(const NearMissFile& file, Values& values);
void read_bytes(const NearMissFile& file, Values& values);
void read_length(const NearMissFile& file, Values& values);

#ifdef OCTOPAIR_WITH_SERVICE
void read_tokens(const NearMissFile& file, Values& values);
void read_client_token(const NearMissFile& file, Values& values);
void read_roles(const NearMissFile& file, Values& values);
void read_address(const NearMissFile& file, Values& values);
#endif

}  // namespace octopair::test
