#include "engine/mpi/rank_search.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/timed.hpp"
#include "base/tuning.hpp"
#include "boxes/invalid_box.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/relay.hpp"
#include "engine/mpi/entries/postponed_pairs.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/order/ascending_pieces.hpp"
#include "engine/mpi/order/index_order.hpp"
#include "engine/receiver.hpp"
#include "octopair/error.hpp"

namespace octopair {

RankSearch::RankSearch(Communicator& comm, const MpiOptions& options, std::function<void()> on_poll)
    : comm_(comm), on_poll_(std::move(on_poll)), passes_(options.threads) {}

Summary RankSearch::run(const detail::Request& request, const detail::Output& output, const detail::Control& control,
                        Recipients recipients) {
    RankCall rank_call(*this, request, output, control.progress);
    rank_call.recipients = recipients;
    if (recipients == Recipients::first && output.sink != nullptr) rank_call.relay.emplace(comm_, *output.sink);
    return run(rank_call, control);
}

Summary RankSearch::run(const detail::Request& request, const IndexedCall& indexed, const detail::Control& control) {
    const detail::Output none;
    RankCall rank_call(*this, request, none, control.progress);
    rank_call.indexed = &indexed;
    return run(rank_call, control);
}

Summary RankSearch::run(RankCall& rank_call, const detail::Control& control) {
    const std::stop_callback forward(control.stop, [&] { rank_call.stop.request_stop(); });
    const auto end = [&] {
        detail::storage_of(found_).reset();
        rank_call.stops.end();
    };
    try {
        const Timed timed(rank_call.summary.seconds);
        const Traffic before = comm_.traffic();
        costs_ = {};
        find(rank_call);
        if (rank_call.recipients == Recipients::first && rank_call.output.list != nullptr) {
            PairList all;
            gather_pieces(*rank_call.output.list, detail::storage_of(all));
            *rank_call.output.list = std::move(all);
        }
        const Traffic& after = comm_.traffic();
        costs_.mpi = after.cpu_seconds - before.cpu_seconds;
        costs_.bytes_sent = after.bytes - before.bytes;
        costs_.messages_sent = after.messages - before.messages;
    } catch (...) {
        end();
        throw;
    }
    end();
    rank_call.progress.finish();
    return rank_call.summary;
}

void RankSearch::skip() noexcept {
    std::stop_source stop;
    StopRelay stops(comm_, stop);
    try {
        join_cancelled(comm_);
    } catch (...) {
    }
    try {
        stops.end();
    } catch (...) {
    }
}

void RankSearch::join(RankCall& rank_call) {
    const CostMeter meter(comm_, costs_.join);
    const detail::Request& asked = rank_call.request;
    const OutputKind output_kind =
        rank_call.indexed != nullptr ? OutputKind::indexed : output_kind_of(rank_call.output);
    const std::uint64_t most = rank_call.indexed != nullptr ? ~std::uint64_t(0) : max_objects;
    rank_call.joint = join_call(comm_, asked, output_kind, most);
    rank_call.slices[0] = rank_call.joint.slice(0, asked.first);
    if (rank_call.joint.join) rank_call.slices[1] = rank_call.joint.slice(1, *asked.second);
    if (rank_call.indexed == nullptr) return;
    for (unsigned set = 0; set < rank_call.sets(); ++set) {
        rank_call.order.take(rank_call.joint, set, rank_call.slices[set], rank_call.indexed->indices[set]);
        rank_call.slices[set] = rank_call.order.objects(set);
    }
    const Objects* const second = rank_call.joint.join ? &rank_call.slices[1] : nullptr;
    rank_call.joint = join_call(comm_, {rank_call.slices[0], second, asked.options}, output_kind, most);
    rank_call.joint.indexed = true;
    for (unsigned set = 0; set < rank_call.sets(); ++set) rank_call.joint.indices[set] = rank_call.order.indices(set);
}

void RankSearch::find(RankCall& rank_call) {
    const detail::Request& asked = rank_call.request;
    join(rank_call);
    costs_.objects = rank_call.joint.sizes[0] + rank_call.joint.sizes[1];
    const Objects& first = rank_call.slices[0];
    const Objects* const second = rank_call.joint.join ? &rank_call.slices[1] : nullptr;
    const BoxSource own(first, second, rank_call.joint.form);
    if (comm_.size() == 1) {
        passes_.set_share(plan_alone(rank_call, own), rank_call.stops);
        return search(rank_call, {first, second, asked.options});
    }
    std::optional<OctreePlanning> planning;
    plan(rank_call, own, planning);
    if (can_send_entries(rank_call, *planning)) {
        if (find_by_entries(rank_call, own, *planning)) return;
        plan(rank_call, own, planning);
    }
    passes_.set_share(exchange_boxes(rank_call, own, *planning), rank_call.stops);
    const Objects first_received = received(0), second_received = received(1);
    search(rank_call, {first_received, rank_call.joint.join ? &second_received : nullptr, asked.options});
}

/// Returns false, with no pairs found, if boxes must be sent.
bool RankSearch::find_by_entries(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning) {
    const Objects* const second = rank_call.joint.join ? &rank_call.slices[1] : nullptr;
    try {
        passes_.set_share(exchange_entries(rank_call, own, planning), rank_call.stops);
        search(rank_call, {rank_call.slices[0], second, rank_call.request.options});
        return true;
    } catch (const NeedsBoxes&) {
        count_path(Path::ranks_bounds_missing);
        calls_with_boxes_ = tuning().ranks.calls_with_boxes;
        costs_.objects_received = 0;
        rank_call.known.reset();
        rank_call.inner.reset();
        rank_call.fetched = {};
        detail::storage_of(found_).reset();
        if (rank_call.output.list != nullptr) detail::storage_of(*rank_call.output.list).reset();
        return false;
    }
}

/// Runs a pass over the octree on all ranks.
/// Throws: as Agreement::together; NeedsBoxes.
void RankSearch::run_pass(RankCall& rank_call, const std::function<void()>& pass) {
    std::uint64_t missing = 0;
    rank_call.agreement.together([&] {
        try {
            pass();
        } catch (const MissingBounds&) {
            missing = 1;
        }
    });
    if (rank_call.known && comm_.sum(missing) > 0) throw NeedsBoxes{};
}

/// Returns those of the found pairs that the pair rule refuses: none unless entries were sent.
std::vector<PostponedPair> RankSearch::settle(RankCall& rank_call) {
    if (!rank_call.known) return {};
    const CostMeter meter(comm_, costs_.scan);
    return refused_pairs(comm_, rank_call.joint, rank_call.slices, rank_call.known->take_postponed());
}

/// Removes the pairs that the pair rule refuses from a list of the found pairs.
void RankSearch::drop_refused(RankCall& rank_call, detail::PairStorage& list) {
    std::vector<PostponedPair> refused = settle(rank_call);
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.scan);
        remove_pairs(list, std::move(refused));
    });
}

void RankSearch::search(RankCall& rank_call, const detail::Request& own_octants) {
    const BoxSource source(own_octants.first, own_octants.second, rank_call.joint.form);
    // This call has its own stop source. If this rank abandons its part of a pass, for example at a limit, the other ranks continue.
    Call call{own_octants, rank_call.output, source, {}, rank_call.progress, {}};
    const std::stop_callback forward(rank_call.stop.get_token(), [&] { call.stop.request_stop(); });
    if (rank_call.indexed != nullptr) {
        find_indexed(rank_call, call);
    } else if (output_kind_of(rank_call.output) == OutputKind::count) {
        count(rank_call, call);
    } else if (rank_call.request.options.order == Order::octal) {
        find_octal(rank_call, call);
    } else {
        find_ascending(rank_call, call);
    }
    rank_call.summary.entries = comm_.sum(call.summary.entries);
    rank_call.summary.steps = call.summary.steps;
}

namespace {

/// Returns how many pairs of a rank's piece are within Options::limit. Stores the number of pairs of all ranks, up to the limit, in
/// `summary`. `pieces`: number of pairs of each rank.
std::uint64_t allowed(const std::vector<std::uint64_t>& pieces, unsigned rank, const Options& options,
                      Summary& summary) {
    const std::uint64_t all = std::accumulate(pieces.begin(), pieces.end(), std::uint64_t(0));
    const std::uint64_t before = std::accumulate(pieces.begin(), pieces.begin() + rank, std::uint64_t(0));
    const std::uint64_t limit = options.limit.value_or(all);
    summary.pairs = std::min(all, limit);
    summary.truncated = all > limit;
    return std::min(pieces[rank], limit - std::min(limit, before));
}

/// Lets `give` pass its pairs to the output, up to `allowance` pairs. Returns the number of pairs that were passed.
template <typename Give>
std::uint64_t receive(const detail::Output& output, std::uint64_t allowance, const Give& give) {
    Receiver receiver(output, allowance);
    receiver.receive([&] { give(receiver); });
    return receiver.pairs();
}

auto hand_out(const PairList& pairs) {
    return [&](Receiver& receiver) {
        for (const auto chunk : pairs.chunks()) receiver.take(chunk);
    };
}

}  // namespace

std::uint64_t RankSearch::allowed(RankCall& rank_call, const PiecePlan& plan) const {
    std::vector<std::uint64_t> pieces(comm_.size());
    for (unsigned rank = 0; rank < comm_.size(); ++rank) pieces[rank] = plan.pairs(rank);
    return octopair::allowed(pieces, comm_.rank(), rank_call.request.options, rank_call.summary);
}

/// Finds pairs in this rank's object numbers, and replaces the numbers by indices. For ascending order, each pair is sent to
/// the rank that its `a` belongs to.
void RankSearch::find_indexed(RankCall& rank_call, Call& call) {
    const Options& options = rank_call.request.options;
    std::vector<Pair64>& pairs = rank_call.indexed->pairs;
    rank_call.agreement.together([&] {
        build(rank_call, call);
        const CostMeter meter(comm_, costs_.scan);
        passes_.list_octal(call, detail::storage_of(found_), 1);
        const auto indices = [&](unsigned set) {
            return comm_.size() == 1 ? rank_call.joint.indices[set]
                                     : std::as_const(exchanged_[set].received.indices).span();
        };
        name_pairs(found_, indices(0), indices(rank_call.joint.join ? 1 : 0), pairs);
        detail::storage_of(found_).reset();
    });
    if (options.order == Order::ascending) {
        const CostMeter meter(comm_, costs_.order);
        sort_over_ranks(comm_, pairs);
    }
    const auto pieces = comm_.all_gather(std::uint64_t(pairs.size()));
    pairs.resize(std::size_t(octopair::allowed(pieces, comm_.rank(), options, rank_call.summary)));
}

/// Passes each rank's pairs to the caller on that rank. With a relay, passes the pairs of all ranks, one rank after another, to
/// the caller on rank 0.
void RankSearch::deliver(RankCall& rank_call, std::uint64_t allowance, const Give& give) {
    if (!rank_call.relay)
        return rank_call.agreement.together([&] { (void)receive(rank_call.output, allowance, give); });
    for (unsigned from = 0; from < comm_.size(); ++from) {
        rank_call.relay->forward(from, [&](const PairSink& sink) { (void)receive({.sink = &sink}, allowance, give); });
    }
}

void RankSearch::gather(PairList& piece, detail::PairStorage& all) {
    try {
        join_gather(comm_);
    } catch (...) {
        std::stop_source stop;
        StopRelay(comm_, stop).end();  // collective: the other ranks call end() in run()
        throw;
    }
    gather_pieces(piece, all);
}

void RankSearch::gather_pieces(PairList& piece, detail::PairStorage& all) {
    RankCounts to_first(comm_.size(), 0);
    to_first[0] = piece.size();
    const Exchange counts = comm_.plan_exchange(std::move(to_first));
    Buffer<Pair> sent;
    std::span<Pair> gathered;
    Agreement(comm_).together([&] {
        sent.resize_discard(std::size_t(piece.size()));
        std::size_t at = 0;
        for (const auto chunk : piece.chunks()) {
            std::copy(chunk.begin(), chunk.end(), sent.data() + at);
            at += chunk.size();
        }
        const std::size_t size = counts.incoming();
        if (size > 0) gathered = all.take_block(size).first(size);
    });
    comm_.exchange(sent.data(), gathered.data(), counts);
    if (!gathered.empty()) all.append(gathered);
}

/// Call in the same Agreement::together() as the first pass, because the octree is then still in the cache.
void RankSearch::build(RankCall& rank_call, Call& call) {
    constexpr double built = 0.3;  // progress after the build
    const CostMeter meter(comm_, costs_.build);
    try {
        passes_.build(call, built);
    } catch (const LinearOctree::Invalid& invalid) {
        if (comm_.size() == 1) rank_call.joint.refuse(call.source, invalid.begin);
        throw_object_changed();
    }
}

void RankSearch::count(RankCall& rank_call, Call& call) {
    std::uint64_t pairs = 0;
    run_pass(rank_call, [&] {
        build(rank_call, call);
        const CostMeter meter(comm_, costs_.scan);
        pairs = passes_.count(call, 1).pairs;
    });
    pairs -= settle(rank_call).size();
    (void)octopair::allowed(comm_.all_gather(pairs), comm_.rank(), rank_call.request.options, rank_call.summary);
}

/// How a rank finds its pairs in octal order.
struct RankSearch::OctalPairs {
    std::function<void()> build_first;  // builds the octree if that is not done
    Give stream;                        // passes the pairs to a receiver
    std::uint64_t allowance;            // maximum number of pairs of this rank
};

void RankSearch::find_octal(RankCall& rank_call, Call& call) {
    const std::optional<std::uint64_t> limit = rank_call.request.options.limit;
    std::uint64_t pairs = 0, allowance = ~std::uint64_t(0);
    if (limit) {
        rank_call.agreement.together([&] {
            build(rank_call, call);
            const CostMeter meter(comm_, costs_.scan);
            pairs = passes_.count(call, 0.6).pairs;
        });
        allowance =
            octopair::allowed(comm_.all_gather(pairs), comm_.rank(), rank_call.request.options, rank_call.summary);
    }
    const auto build_first = [&] {
        if (!limit) build(rank_call, call);
    };
    const Give stream = [&](Receiver& receiver) {
        passes_.stream_octal(
            call, [&](std::span<const Pair> some) { receiver.take(some); }, 1);
    };
    if (rank_call.relay) {
        pairs = relay_octal(rank_call, call, {build_first, stream, allowance});
    } else if (rank_call.output.list != nullptr && !limit) {
        detail::PairStorage& list = detail::storage_of(*rank_call.output.list);
        run_pass(rank_call, [&] {
            build_first();
            const CostMeter meter(comm_, costs_.scan);
            const PairRoom room({call.request.options.limit}, &list, call.progress, false);
            passes_.list_octal(call, list, 1);
        });
        drop_refused(rank_call, list);
        pairs = list.size;
    } else {
        rank_call.agreement.together([&] {
            build_first();
            const CostMeter meter(comm_, costs_.scan);
            pairs = receive(rank_call.output, allowance, stream);
        });
    }
    if (!limit)
        (void)octopair::allowed(comm_.all_gather(pairs), comm_.rank(), rank_call.request.options, rank_call.summary);
}

/// Rank 0 streams its pairs to its sink while each other rank collects its pairs in a list. Then the other ranks send their pairs in turn.
/// A rank whose pairs do not fit into its buffer drops the list, and scans again when its turn comes. Returns the number of this rank's
/// pairs.
std::uint64_t RankSearch::relay_octal(RankCall& rank_call, Call& call, const OctalPairs& own) {
    bool listed = false;
    std::uint64_t pairs = 0;
    rank_call.agreement.together([&] {
        own.build_first();
        const CostMeter meter(comm_, costs_.scan);
        if (own.allowance == 0) return;
        if (comm_.rank() == 0) {
            pairs = receive(rank_call.output, own.allowance, own.stream);
        } else {
            listed = list_octal(call, call.buffer_pairs());
        }
    });
    if (comm_.rank() != 0) count_path(listed ? Path::relay_listed : Path::relay_found_again);
    const Give give = listed ? Give(hand_out(found_)) : own.stream;
    for (unsigned from = 1; from < comm_.size(); ++from) {
        rank_call.relay->forward(from, [&](const PairSink& sink) {
            if (own.allowance > 0) pairs = receive({.sink = &sink}, own.allowance, give);
        });
    }
    return pairs;
}

void RankSearch::find_ascending(RankCall& rank_call, Call& call) {
    const bool whole = rank_call.output.list != nullptr && !rank_call.request.options.limit;
    if (comm_.size() == 1 && whole) {
        rank_call.agreement.together([&] { build(rank_call, call); });
        const CostMeter meter(comm_, costs_.scan);
        detail::PairStorage& list = detail::storage_of(*rank_call.output.list);
        const std::uint64_t rows = rank_call.joint.totals[0];
        const PairRoom room({call.request.options.limit}, &list, call.progress, false);
        passes_.list_ascending(call, list, {{0, rows}, rank_call.joint.columns()}, 1);
        (void)octopair::allowed({list.size}, 0, rank_call.request.options, rank_call.summary);
        return;
    }
    // Pairs that are not returned as a whole list must fit into buffer_bytes.
    std::uint64_t over = 0;
    run_pass(rank_call, [&] {
        build(rank_call, call);
        const CostMeter meter(comm_, costs_.scan);
        const auto most = whole ? std::optional<std::uint64_t>() : call.buffer_pairs() / 2;
        over = list_octal(call, most) ? 0 : 1;
    });
    if (comm_.sum(over) > 0) return find_windows(rank_call, call);
    drop_refused(rank_call, detail::storage_of(found_));
    const CostMeter meter(comm_, costs_.order);
    AscendingPieces pieces(comm_, passes_.threads(), rank_call.joint.columns(),
                           [&](std::uint64_t pairs) { call.progress.add(pairs); });
    const PiecePlan plan = pieces.plan(found_, RowBins(rank_call.joint.totals[0]));
    call.progress.stage(1, plan.pairs(comm_.rank()));
    const std::uint64_t allowance = allowed(rank_call, plan);
    PairList sorted;
    PairList& piece = whole ? *rank_call.output.list : sorted;
    pieces.exchange_and_sort(found_, plan, 0, detail::storage_of(piece), rank_call.stop.get_token());
    if (!whole) deliver(rank_call, allowance, hand_out(piece));
}

namespace {

/// Lets a list allocate memory for about `most` pairs, and then throw OverBudget. No limit outlives this object.
class ListLimit {
public:
    ListLimit(detail::PairStorage& list, std::uint64_t most) : list_(list) {
        list_.ask([this, most](std::uint64_t more) {
            bytes_ += more;
            if (bytes_ / sizeof(Pair) > most) throw OverBudget{};
        });
    }
    ~ListLimit() { list_.ask({}); }
    ListLimit(const ListLimit&) = delete;
    ListLimit& operator=(const ListLimit&) = delete;

private:
    detail::PairStorage& list_;
    std::uint64_t bytes_ = 0;
};

}  // namespace

/// Lists this rank's pairs in found_. Returns false, with found_ empty, if there are more than about `most` pairs.
bool RankSearch::list_octal(Call& call, std::optional<std::uint64_t> most) {
    constexpr double listed = 0.8;  // progress after the scan
    if (!most) {
        const PairRoom room({call.request.options.limit}, &detail::storage_of(found_), call.progress, false);
        passes_.list_octal(call, detail::storage_of(found_), listed);
        return true;
    }
    // A list that has memory from an earlier call would fill this memory before it asks for more, so `most` would not bound its size.
    found_ = PairList();
    detail::PairStorage& list = detail::storage_of(found_);
    const ListLimit limit(list, *most);
    try {
        passes_.list_octal(call, list, listed);
        return true;
    } catch (const OverBudget&) {
        list.reset();
        return false;
    }
}

/// Used if the pairs do not fit into the buffer. Counts the pairs of each bin of objects, then finds the pairs of as many
/// objects at a time as fit into the buffer.
void RankSearch::find_windows(RankCall& rank_call, Call& call) {
    const RowBins bins(rank_call.joint.totals[0]);
    std::vector<std::uint64_t> counts;
    // found_ still has pairs here if the pairs of this rank fitted into the buffer, and those of another rank did not.
    detail::storage_of(found_).reset();
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.scan);
        counts.resize(bins.size(), 0);
        passes_.count_rows(call, bins, counts, 0.5);
    });
    comm_.add_up(counts);
    const std::uint64_t all = std::accumulate(counts.begin(), counts.end(), std::uint64_t(0));
    // During the exchange a rank stores a window's pairs three times: the list of found pairs, the sent copy, and the received pairs.
    const std::uint64_t fit = std::max<std::uint64_t>(1, call.buffer_pairs() / 3);
    const unsigned windows = unsigned(all / (fit * comm_.size()) + 1);
    const PiecePlan plan(bins, counts, {comm_.size(), windows, rank_call.relay.has_value()});
    (void)allowed(rank_call, plan);
    const std::uint64_t limit = rank_call.request.options.limit.value_or(all);
    AscendingPieces pieces(comm_, passes_.threads(), rank_call.joint.columns());
    for (unsigned window = 0; window < windows; ++window) {
        if (!plan.is_wanted(window, limit)) continue;
        count_path(Path::ranks_window);
        std::vector<std::uint8_t> marks;
        PairList sorted;
        rank_call.agreement.together([&] {
            const CostMeter meter(comm_, costs_.scan);
            marks = plan.marks(window);
            passes_.set_wanted_rows({bins, marks});
            passes_.list_octal(call, detail::storage_of(found_), 0.5 + 0.5 * double(window + 1) / double(windows));
        });
        pieces.exchange_and_sort(found_, plan, window, detail::storage_of(sorted), rank_call.stop.get_token());
        deliver(rank_call, plan.allowed(comm_.rank(), window, limit), hand_out(sorted));
    }
}

}  // namespace octopair
