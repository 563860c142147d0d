// OutputRoom: how many pairs fit into the file of `octopair detect --output`. A result that cannot fit is refused before it is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "cli/detect/detection.hpp"
#include "io/files/atomic_file.hpp"
#include "octopair/error.hpp"
#include "octopair/objects.hpp"

namespace octopair::cli {

class OutputRoom {
public:
    /// `pair_bytes`: bytes of a pair in an .npy file. Borrows the request.
    explicit OutputRoom(const DetectRequest& request, std::size_t pair_bytes = sizeof(Pair))
        : request_(request), pair_bytes_(pair_bytes) {}

    /// Returns the maximum number of pairs of the next frame, for Engine::stream_at_most(). Returns nothing if there is no bound, as for
    /// standard output, or if it is unknown. Results below 256 MiB are not bounded: a write that fails reports the error soon enough.
    std::optional<std::uint64_t> max_pairs();
    /// Throws: Error{resource_limit} that says how many bytes the pairs need, and how many they can have. Requires: max_pairs() returned
    /// the bound that the pairs exceed.
    [[noreturn]] void refuse(const TooManyPairs& excess) const;
    /// Throws: as refuse(), if the next frame has too many pairs.
    void require(std::uint64_t pairs);

private:
    const DetectRequest& request_;
    std::size_t pair_bytes_;
    std::optional<io::FileRoom> room_;
};

/// Returns an error of a call with a list. If the pairs do not fit into memory, the message has the options of the command in place of the
/// functions of the library.
Error in_words_of_command(const Error& error);

/// The shortest rows of text that different pairs can have.
struct ShortestRows {
    std::uint64_t fixed;  ///< bytes of a row besides the digits of its two indices
    bool join;            ///< the indices belong to two sets, so both orders are different pairs

    /// Returns the bytes of so many rows.
    std::uint64_t bytes_of(std::uint64_t pairs) const;
    /// Returns how many rows fit into so many bytes.
    std::uint64_t pairs_in(std::uint64_t bytes) const;
};

}  // namespace octopair::cli
