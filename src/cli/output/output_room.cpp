#include "cli/output/output_room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/free_memory.hpp"
#include "engine/pair_room.hpp"
#include "io/formats/format_choice.hpp"

namespace octopair::cli {

namespace {

constexpr const char* advice = "; use --count-only, --limit or a stream (without --output)";
constexpr unsigned max_digits = 10;  // of an index of 32 bits

/// Returns how many different pairs have indices with so many digits together.
std::uint64_t pairs_with(unsigned digits, bool join) {
    if (digits == 2 * max_digits) return std::numeric_limits<std::uint64_t>::max();
    const auto indices = [](unsigned of) {
        std::uint64_t power = 1;
        for (unsigned digit = 1; digit < of; ++digit) power *= 10;
        return of == 1 ? 10 : 9 * power;
    };
    std::uint64_t pairs = 0;
    for (unsigned a = digits > max_digits ? digits - max_digits : 1; a < digits && a <= max_digits; ++a) {
        const unsigned b = digits - a;
        if (join || a < b) pairs += indices(a) * indices(b);
        if (!join && a == b) pairs += indices(a) * (indices(a) - 1) / 2;
    }
    return pairs;
}

/// Returns the rows of a text format; nothing for .npy files.
std::optional<ShortestRows> rows_of(const DetectRequest& request) {
    const bool join = !request.against.empty();
    switch (io::result_format(request.output)) {
        case io::ResultFormat::csv:
            return ShortestRows{std::string_view(",\n").size(), join};
        case io::ResultFormat::jsonl:
            return ShortestRows{std::string_view("{\"a\":,\"b\":}\n").size(), join};
        case io::ResultFormat::npy:
        case io::ResultFormat::bcf:
            break;
    }
    return {};
}

}  // namespace

std::uint64_t ShortestRows::bytes_of(std::uint64_t pairs) const {
    std::uint64_t bytes = 0;
    for (unsigned digits = 2; pairs > 0; ++digits) {
        const std::uint64_t rows = std::min(pairs, pairs_with(digits, join));
        bytes += rows * (fixed + digits);
        pairs -= rows;
    }
    return bytes;
}

std::uint64_t ShortestRows::pairs_in(std::uint64_t bytes) const {
    std::uint64_t pairs = 0;
    for (unsigned digits = 2; digits <= 2 * max_digits; ++digits) {
        const std::uint64_t rows = std::min(bytes / (fixed + digits), pairs_with(digits, join));
        pairs += rows;
        bytes -= rows * (fixed + digits);
    }
    return pairs;
}

std::optional<std::uint64_t> OutputRoom::max_pairs() {
    constexpr std::uint64_t unchecked_bytes = 1 << 28;
    if (request_.output.empty()) return {};
    room_ = io::room_for_file(request_.output);
    if (!room_) return {};
    const std::uint64_t bytes = std::max(room_->bytes, unchecked_bytes);
    const auto rows = rows_of(request_);
    return rows ? rows->pairs_in(bytes) : bytes / pair_bytes_;
}

void OutputRoom::refuse(const TooManyPairs& excess) const {
    const auto rows = rows_of(request_);
    const std::uint64_t bytes = rows ? rows->bytes_of(excess.pairs()) : excess.pairs() * pair_bytes_;
    const char* const at_least = !excess.exact() ? "more than " : rows ? "at least " : "";
    throw Error(ErrorCode::resource_limit,
                fmt::format("{}: {}{} pairs need {}{}, {} {}{}", request_.output, excess.exact() ? "" : "more than ",
                            digit_groups(excess.pairs()), at_least, byte_text(bytes), byte_text(room_->bytes),
                            room_->what, advice));
}

void OutputRoom::require(std::uint64_t pairs) {
    const std::optional<std::uint64_t> most = max_pairs();
    if (most && pairs > *most) refuse({"", pairs, true});
}

Error in_words_of_command(const Error& error) {
    std::string message = error.what();
    if (message.ends_with(list_advice)) message.replace(message.rfind(list_advice), std::string::npos, advice);
    return {error.code(), message};
}

}  // namespace octopair::cli
