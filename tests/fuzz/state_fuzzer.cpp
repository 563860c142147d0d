// Fuzzes the readers of the state folder's files. Accepted content stays the same when it is written again. Random
// bytes have no valid checksums. The fuzzer tries the bytes unchanged and as parts of files with valid checksums.
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "service/server/store/state_format.hpp"

namespace {

using namespace octopair;
using namespace octopair::service;
using fuzz::require;

FileBytes file_of(const std::string& bytes) {
    return {"f.job", bytes.size(), [&bytes](std::uint64_t offset, std::span<std::byte> out) {
                require(offset <= bytes.size() && out.size() <= bytes.size() - offset);
                if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
            }};
}

template <typename Read>
void try_reading(const Read& read) {
    fuzz::require_clear_errors({.begin = "f.job: ", .codes = {ErrorCode::io_failed}}, [&] { read(); });
}

void try_job(const std::string& bytes) {
    try_reading([&] {
        const StoredSpec stored = read_job(file_of(bytes));
        require(stored.input_at <= bytes.size());
        if (stored.hash.empty()) return;
        require(stored.hash.size() == 16);
        require(read_job(file_of(bytes)).owner == stored.owner);
    });
}

void try_result(const std::string& bytes) {
    try_reading([&] {
        const StoredResult result = read_result(file_of(bytes));
        require(result.pairs * sizeof(Pair) <= bytes.size());
        require(result.sums.size() == (result.pairs + stored_piece_pairs - 1) / stored_piece_pairs);
    });
}

/// Reads a complete job file whose owner is the first half of `text`. Then reads damaged files with more text after
/// or before the complete file.
void try_whole_job(const std::string& text) {
    StoredSpec stored;
    stored.owner = text.substr(0, text.size() / 2);
    stored.algorithm = 1;
    stored.spec.set_id("01234567-89ab-cdef-0123-456789abcdef");
    const std::string block = encode_block(stored);
    const std::string file = block + encode_job_end(block, std::string(16, 'h'));
    require(file.size() == job_file_bytes(block, 0));
    const StoredSpec again = read_job(file_of(file));
    require(again.owner == stored.owner && again.hash == std::string(16, 'h') && again.input_at == block.size());
    try_job(file + text.substr(text.size() / 2));
    try_job(text + file);
}

/// Reads a complete result with arbitrary pairs and an arbitrary report text.
void try_whole_result(const std::string& text) {
    StoredResult result;
    result.hash = std::string(16, 'h');
    result.pairs = text.size() / sizeof(Pair);
    if (result.pairs > 0) result.sums.push_back(result.pairs);
    result.ending.set_state(v1::DONE);
    result.ending.set_queued_before(text.size());
    const std::string file =
        encode_result_head(result.hash) + text.substr(0, result.pairs * sizeof(Pair)) + encode_result_end(result);
    const StoredResult again = read_result(file_of(file));
    require(again.pairs == result.pairs && again.sums == result.sums && again.hash == result.hash);
    require(again.ending.queued_before() == text.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    try_job(file);
    try_result(file);
    try_whole_job(file);
    try_whole_result(file);
    return 0;
}
