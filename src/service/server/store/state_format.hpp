// The files of the state folder, to the byte (docs/formats.md): what is in them, encoded and read back.
//
// Whatever bytes a file has, reading it gives what was written or an Error{io_failed} "FILE: damaged: ..."; and takes no
// more memory than a part of the file's size.
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

/// Pairs of a result are checked piece by piece.
inline constexpr std::uint64_t stored_piece_pairs = piece_bytes / sizeof(Pair);
inline constexpr std::uint64_t result_head_bytes = 32;

/// XXH3 in 64 bits.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// A file as it is read.
struct FileBytes {
    std::string name;
    std::uint64_t size = 0;
    std::function<void(std::uint64_t offset, std::span<std::byte> bytes)> read;
};

[[noreturn]] void fail_damaged(std::string_view file, std::string_view how);

/// What a job's file says beside its input. The block that says it stands before the input and behind it again, so that a
/// job whose file is damaged still has its name.
struct StoredSpec {
    std::string owner;
    v1::JobSpec spec;
    std::uint32_t algorithm = 0;
    std::string hash;            ///< of the job; empty: the file's end is damaged
    std::uint64_t input_at = 0;  ///< where the input begins
};

std::string encode_block(const StoredSpec& stored);
/// What stands behind the input: the block again, and the hash.
std::string encode_job_end(const std::string& block, const std::string& hash);
/// Of a job's whole file.
std::uint64_t job_file_bytes(const std::string& block, std::uint64_t input_bytes);
/// Throws if neither block is right.
StoredSpec read_job(const FileBytes& file);

/// What a result's file says beside its pairs.
struct StoredResult {
    std::string hash;  ///< of the job
    std::uint64_t pairs = 0;
    std::vector<std::uint64_t> sums;  ///< checksum of each piece
    v1::JobReport ending;             ///< how the job ended
};

std::string encode_result_head(const std::string& hash);
/// What stands behind the pairs.
std::string encode_result_end(const StoredResult& result);
StoredResult read_result(const FileBytes& file);

}  // namespace octopair::service
