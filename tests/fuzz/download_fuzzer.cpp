// Fuzzes the client's reader of results, once into a list and once into a sink. Both get the same pairs, and an
// incomplete answer is refused. The input is a sequence of messages, each after its length in two bytes. The highest
// bit of the length starts another attempt.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/require.hpp"
#include "octopair/error.hpp"
#include "service/client/received.hpp"
#include "service/protocol/messages.hpp"

namespace {

using namespace octopair;
using namespace octopair::service;
using fuzz::require;

/// Splits a message into pieces, as the network may deliver it.
grpc::ByteBuffer in_pieces(std::string_view bytes) {
    std::vector<grpc::Slice> slices;
    for (std::size_t length = 1; !bytes.empty(); length = 3 * length + 1) {
        const std::string_view piece = bytes.substr(0, length);
        slices.emplace_back(piece.data(), piece.size());
        bytes.remove_prefix(piece.size());
    }
    return {slices.data(), slices.size()};
}

/// The pairs that arrived before a refusal, and the summary if the answer was complete.
struct Outcome {
    std::vector<Pair> pairs;
    std::optional<std::uint64_t> summed;
    std::string refusal;
};

void feed(std::string_view input, Received& received) {
    while (input.size() >= 2) {
        const unsigned head = unsigned(std::uint8_t(input[0])) | unsigned(std::uint8_t(input[1])) << 8;
        input.remove_prefix(2);
        if ((head & 0x8000) != 0) received.begin_attempt();
        const std::string_view bytes = input.substr(0, head & 0x7fff);
        input.remove_prefix(bytes.size());
        grpc::ByteBuffer message = in_pieces(bytes);
        received.take(message);
    }
}

Outcome outcome_of(std::string_view input, const detail::Output& output) {
    const std::string server = "server";
    double last = 0;
    const ProgressSink progress = [&](double done) {
        require(done >= last && done <= 1);
        last = done;
    };
    const detail::Control control{{}, progress};
    Received received(server, output, control);
    Outcome outcome;
    try {
        feed(input, received);
        outcome.summed = received.finish().pairs;
        require(*outcome.summed == received.pairs());
    } catch (const Error& error) {
        require(error.code() == ErrorCode::engine_failed);
        outcome.refusal = error.what();
        require(outcome.refusal.find('\n') == std::string::npos);
    }
    return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(bytes), size);
    PairList list;
    Outcome listed = outcome_of(input, {.list = &list});
    listed.pairs = list.to_vector();
    std::vector<Pair> pairs;
    const PairSink sink = [&](std::span<const Pair> batch) { pairs.insert(pairs.end(), batch.begin(), batch.end()); };
    const Outcome sunk = outcome_of(input, {.sink = &sink});
    require(listed.pairs == pairs && listed.summed == sunk.summed && listed.refusal == sunk.refusal);
    return 0;
}
