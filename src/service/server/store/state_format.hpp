// State format: encodes and decodes the files of the state folder (docs/formats.md has every byte).
//
// Invariants, for any bytes of a file:
//  - Reading returns what was written, or throws Error{io_failed} "FILE: damaged: ...".
//  - Reading allocates memory only for parts that the file really has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/objects.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

/// Number of pairs in a piece of a result. Each piece has its own checksum.
inline constexpr std::uint64_t stored_piece_pairs = piece_bytes / sizeof(Pair);
inline constexpr std::uint64_t result_head_bytes = 32;

/// Returns the 64-bit XXH3 hash.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// Name, size and bytes of a file to decode.
struct FileBytes {
    std::string name;
    std::uint64_t size = 0;
    std::function<void(std::uint64_t offset, std::span<std::byte> bytes)> read;
};

/// Throws: Error{io_failed} "FILE: damaged: HOW".
[[noreturn]] void fail_damaged(std::string_view file, std::string_view how);

/// Contents of a job's file besides its input. The file has this block before the input and again after it, so that the job of
/// a damaged file can still be identified.
struct StoredSpec {
    std::string owner;
    v1::JobSpec spec;
    std::uint32_t algorithm = 0;
    std::string hash;            ///< hash of the job; empty: the end of the file is damaged
    std::uint64_t input_at = 0;  ///< offset of the input in the file
};

std::string encode_block(const StoredSpec& stored);
/// Returns the bytes after the input: the block again, and the tail with the hash.
std::string encode_job_end(const std::string& block, const std::string& hash);
/// Returns the size of a job's whole file.
std::uint64_t job_file_bytes(const std::string& block, std::uint64_t input_bytes);
/// Throws: Error{io_failed} if neither block is valid.
StoredSpec read_job(const FileBytes& file);

/// Contents of a result's file besides its pairs.
struct StoredResult {
    std::string hash;  ///< hash of the job
    std::uint64_t pairs = 0;
    std::vector<std::uint64_t> sums;  ///< checksum of each piece
    v1::JobReport ending;             ///< how the job ended
};

std::string encode_result_head(const std::string& hash);
/// Returns the bytes after the pairs.
std::string encode_result_end(const StoredResult& result);
StoredResult read_result(const FileBytes& file);

}  // namespace octopair::service
