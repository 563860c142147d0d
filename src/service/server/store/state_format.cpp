#include "service/server/store/state_format.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "octopair/error.hpp"
#include "service/protocol/job_spec.hpp"

namespace octopair::service {

static_assert(std::endian::native == std::endian::little, "numbers are written in the byte order of memory");

namespace {

constexpr std::uint32_t newest_version = 1;
constexpr std::uint64_t max_text = 1 << 16;  // maximum bytes of an owner, a spec or an ending
constexpr std::size_t hash_bytes = 16;

struct BlockHead {
    static constexpr std::array<char, 8> right_magic = {'\x93', 'O', 'C', 'T', 'O', 'J', 'O', 'B'};

    std::array<char, 8> magic = right_magic;
    std::uint32_t version = newest_version;
    std::uint32_t algorithm = 0;
    std::uint32_t owner_bytes = 0;
    std::uint32_t spec_bytes = 0;
    std::uint64_t input_bytes = 0;
};
static_assert(sizeof(BlockHead) == 32);

struct JobTail {
    std::array<char, hash_bytes> hash{};
    std::uint64_t block_bytes = 0;
    std::uint64_t checksum = 0;  // checksum of the members above
};
static_assert(sizeof(JobTail) == 32);

struct ResultHead {
    static constexpr std::array<char, 8> right_magic = {'\x93', 'O', 'C', 'T', 'O', 'R', 'E', 'S'};

    std::array<char, 8> magic = right_magic;
    std::uint32_t version = newest_version;
    std::uint32_t reserved = 0;
    std::array<char, hash_bytes> hash{};
};
static_assert(sizeof(ResultHead) == result_head_bytes);

struct ResultTail {
    std::uint64_t pairs = 0;
    std::uint64_t ending_bytes = 0;
    std::uint64_t checksum = 0;  // checksum of the head, the sums, the ending and the members above
};
static_assert(sizeof(ResultTail) == 24);

template <typename Plain>
std::string_view text_of(const Plain& plain) {
    return {reinterpret_cast<const char*>(&plain), sizeof plain};
}

std::uint64_t text_checksum(std::string_view text) { return checksum_of(std::as_bytes(std::span(text))); }

std::string text_at(const FileBytes& file, std::uint64_t offset, std::uint64_t bytes) {
    if (offset > file.size || bytes > file.size - offset) fail_damaged(file.name, "the file is too short");
    std::string text(std::size_t(bytes), '\0');
    file.read(offset, std::as_writable_bytes(std::span(text)));
    return text;
}

template <typename Plain>
Plain plain_at(const FileBytes& file, std::uint64_t offset) {
    const std::string text = text_at(file, offset, sizeof(Plain));
    Plain plain;
    std::memcpy(&plain, text.data(), sizeof plain);
    return plain;
}

void check_version(const FileBytes& file, std::uint32_t version) {
    if (version == newest_version) return;
    throw Error(ErrorCode::io_failed, file.name + ": format version " + std::to_string(version) +
                                          "; this program reads version " + std::to_string(newest_version));
}

std::uint64_t bytes_of(const BlockHead& head) {
    return sizeof head + head.owner_bytes + head.spec_bytes + sizeof(std::uint64_t);
}

/// Returns the block that begins at `offset`. Throws: Error{io_failed} if it is invalid or longer than the file.
StoredSpec block_at(const FileBytes& file, std::uint64_t offset) {
    const auto head = plain_at<BlockHead>(file, offset);
    if (head.magic != BlockHead::right_magic)
        fail_damaged(file.name, "the job's block does not begin with its magic bytes");
    check_version(file, head.version);
    if (head.owner_bytes > max_text || head.spec_bytes > max_text) fail_damaged(file.name, "wrong lengths");
    const std::string block = text_at(file, offset, bytes_of(head));
    std::uint64_t checksum = 0;
    const std::string_view covered = std::string_view(block).substr(0, block.size() - sizeof checksum);
    std::memcpy(&checksum, block.data() + covered.size(), sizeof checksum);
    if (text_checksum(covered) != checksum) fail_damaged(file.name, "wrong checksum of the job spec");

    StoredSpec stored;
    stored.owner = covered.substr(sizeof head, head.owner_bytes);
    stored.algorithm = head.algorithm;
    stored.input_at = block.size();
    if (!stored.spec.ParseFromString(std::string(covered.substr(sizeof head + head.owner_bytes)))) {
        fail_damaged(file.name, "the job spec cannot be parsed");
    }
    try {
        check(stored.spec);
        check_id(stored.spec.id());
    } catch (const Error& error) {
        fail_damaged(file.name, error.what());
    }
    if (head.input_bytes != input_bytes(stored.spec))
        fail_damaged(file.name, "the size of the input does not match the job spec");
    return stored;
}

JobTail job_tail(const FileBytes& file) {
    if (file.size < sizeof(JobTail)) fail_damaged(file.name, "the file is too short");
    const auto tail = plain_at<JobTail>(file, file.size - sizeof(JobTail));
    if (text_checksum(text_of(tail).substr(0, sizeof tail - sizeof tail.checksum)) != tail.checksum) {
        fail_damaged(file.name, "wrong checksum of the end of the file");
    }
    return tail;
}

StoredSpec first_block(const FileBytes& file) {
    try {
        return block_at(file, 0);
    } catch (const Error&) {
        const std::uint64_t behind = job_tail(file).block_bytes + sizeof(JobTail);
        if (behind < sizeof(JobTail) || behind > file.size) throw;
        return block_at(file, file.size - behind);
    }
}

}  // namespace

std::uint64_t checksum_of(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

void fail_damaged(std::string_view file, std::string_view how) {
    throw Error(ErrorCode::io_failed, std::string(file) + ": damaged: " + std::string(how));
}

std::string encode_block(const StoredSpec& stored) {
    const std::string spec = stored.spec.SerializeAsString();
    if (stored.owner.size() > max_text) throw Error(ErrorCode::usage, "the client's name is too long for a state file");
    if (spec.size() > max_text) throw Error(ErrorCode::bad_input, "the job spec is too long for a state file");
    BlockHead head;
    head.algorithm = stored.algorithm;
    head.owner_bytes = std::uint32_t(stored.owner.size());
    head.spec_bytes = std::uint32_t(spec.size());
    head.input_bytes = input_bytes(stored.spec);
    std::string block(text_of(head));
    block += stored.owner;
    block += spec;
    const std::uint64_t checksum = text_checksum(block);
    return block.append(text_of(checksum));
}

std::string encode_job_end(const std::string& block, const std::string& hash) {
    JobTail tail;
    std::copy_n(hash.begin(), std::min(hash.size(), hash_bytes), tail.hash.begin());
    tail.block_bytes = block.size();
    tail.checksum = text_checksum(text_of(tail).substr(0, sizeof tail - sizeof tail.checksum));
    return block + std::string(text_of(tail));
}

std::uint64_t job_file_bytes(const std::string& block, std::uint64_t input_bytes) {
    return 2 * block.size() + input_bytes + sizeof(JobTail);
}

StoredSpec read_job(const FileBytes& file) {
    StoredSpec stored = first_block(file);
    const std::uint64_t whole = 2 * stored.input_at + input_bytes(stored.spec) + sizeof(JobTail);
    if (file.size != whole) return stored;
    try {
        const JobTail tail = job_tail(file);
        if (tail.block_bytes == stored.input_at) stored.hash.assign(tail.hash.begin(), tail.hash.end());
    } catch (const Error&) {
        return stored;
    }
    return stored;
}

namespace {

std::uint64_t pieces_of(std::uint64_t pairs) { return (pairs + stored_piece_pairs - 1) / stored_piece_pairs; }

std::uint64_t result_checksum(std::string_view head, std::string_view sums_and_ending, const ResultTail& tail) {
    std::string covered(head);
    covered += sums_and_ending;
    covered += text_of(tail).substr(0, sizeof tail - sizeof tail.checksum);
    return text_checksum(covered);
}

}  // namespace

std::string encode_result_head(const std::string& hash) {
    ResultHead head;
    std::copy_n(hash.begin(), std::min(hash.size(), hash_bytes), head.hash.begin());
    return std::string(text_of(head));
}

std::string encode_result_end(const StoredResult& result) {
    const std::string ending = result.ending.SerializeAsString();
    std::string text(reinterpret_cast<const char*>(result.sums.data()), result.sums.size() * sizeof(std::uint64_t));
    text += ending;
    ResultTail tail;
    tail.pairs = result.pairs;
    tail.ending_bytes = ending.size();
    tail.checksum = result_checksum(encode_result_head(result.hash), text, tail);
    return text.append(text_of(tail));
}

StoredResult read_result(const FileBytes& file) {
    const auto head = plain_at<ResultHead>(file, 0);
    if (head.magic != ResultHead::right_magic)
        fail_damaged(file.name, "the file does not begin with the magic bytes of a result");
    check_version(file, head.version);
    if (file.size < sizeof head + sizeof(ResultTail)) fail_damaged(file.name, "the file is too short");
    const std::uint64_t inner = file.size - sizeof head - sizeof(ResultTail);
    const auto tail = plain_at<ResultTail>(file, file.size - sizeof(ResultTail));
    const bool fits = tail.pairs <= inner / sizeof(Pair) && tail.ending_bytes <= max_text;
    const std::uint64_t sums_bytes = fits ? pieces_of(tail.pairs) * sizeof(std::uint64_t) : 0;
    if (!fits || tail.pairs * sizeof(Pair) + sums_bytes + tail.ending_bytes != inner) {
        fail_damaged(file.name, "wrong lengths");
    }
    const std::string text = text_at(file, sizeof head + tail.pairs * sizeof(Pair), sums_bytes + tail.ending_bytes);
    if (result_checksum(text_of(head), text, tail) != tail.checksum)
        fail_damaged(file.name, "wrong checksum of the end of the file");

    StoredResult result;
    result.hash.assign(head.hash.begin(), head.hash.end());
    result.pairs = tail.pairs;
    result.sums.resize(std::size_t(pieces_of(tail.pairs)));
    if (sums_bytes > 0) std::memcpy(result.sums.data(), text.data(), std::size_t(sums_bytes));
    if (!result.ending.ParseFromString(text.substr(std::size_t(sums_bytes)))) {
        fail_damaged(file.name, "the report of how the job ended cannot be parsed");
    }
    return result;
}

}  // namespace octopair::service
