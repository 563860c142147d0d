// These functions let the threads of a team find pairs, and count them, list them, stream them, or sort them into ascending order.
//
// Each function runs `find` once with an executor of the team. Pairs that are listed or streamed in octal order are in the order of the
// shares, whatever thread found them. Workers use the same outputs (engine/output/outputs.hpp), except for streams.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "base/private_export.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_count.hpp"
#include "engine/pair_list.hpp"
#include "octopair/engine.hpp"
#include "octree/executor.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// Runs shares that write no pairs on a team. Derived classes also run shares that write pairs.
class OCTOPAIR_PRIVATE_EXPORT TeamExecutor : public Executor {
public:
    explicit TeamExecutor(Team& team) : team_(team) {}
    unsigned width() const override { return team_.threads(); }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

protected:
    Team& team() { return team_; }

private:
    Team& team_;
};

/// Finds pairs: writes them in shares of the executor.
using FindPairs = std::function<void(Executor&)>;

/// Returns the number of pairs. Stops when `limit` is reached.
OCTOPAIR_PRIVATE_EXPORT PairCount count_pairs(Team& team, const FindPairs& find, const CountLimit& limit = {});
/// Adds the number of pairs with object i as `a` to counts[i].
OCTOPAIR_PRIVATE_EXPORT void count_pairs_by_object(Team& team, std::span<std::uint32_t> counts, const FindPairs& find);
/// Adds the number of pairs of each bin to `counts`. The bin of a pair is its `a` without the low `bin_shift` bits.
OCTOPAIR_PRIVATE_EXPORT void count_pairs_by_bin(Team& team, std::span<std::uint64_t> counts, unsigned bin_shift,
                                                const FindPairs& find);
/// Appends the pairs to a list.
OCTOPAIR_PRIVATE_EXPORT void list_pairs(Team& team, detail::PairStorage& list, const FindPairs& find);

struct StreamTo {
    const PairSink& deliver;     ///< receives pairs on the calling thread
    std::uint64_t buffer_pairs;  ///< maximum number of buffered pairs
    std::stop_source abandon;    ///< stop requested when a share or `deliver` fails, so that the other shares end soon
};
/// Passes the pairs to a function. Throws: what `to.deliver` throws, which ends the search.
OCTOPAIR_PRIVATE_EXPORT void stream_pairs(Team& team, const StreamTo& to, const FindPairs& find);

/// Control of the sort of list_ascending_pairs(). The functions may be empty.
struct SortControl {
    std::stop_token stop = {};
    std::function<void(std::uint64_t)> begin =
        {};  ///< called with the number of pairs that were found, before they are sorted
    std::function<void(std::uint64_t)> sorted =
        {};  ///< called with the number of pairs of each bucket, on any thread of the team
};
/// Appends the pairs within `bounds` to a list, in ascending order. Scatters pairs into buckets, in pages of the list's own memory, and sorts
/// each bucket into pages of the same memory. Beside the pairs, sorting needs memory for one bucket for each thread.
/// Throws: OverBudget; Error{cancelled}.
OCTOPAIR_PRIVATE_EXPORT void list_ascending_pairs(Team& team, detail::PairStorage& list, const AscendingBounds& bounds,
                                                  const FindPairs& find, const SortControl& control = {});

}  // namespace octopair
