#include "engine/mpi/joint_call.hpp"

#include <string>
#include <string_view>

#include "boxes/origin_sample.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// Parameters of a rank's slice of a set. Sent to all ranks.
struct SliceParameters {
    std::uint64_t size;
    bool wide, padded;
};

/// The function that a rank calls: a search, gather_pairs(), or `cancelled`: any function whose call was cancelled before it began.
enum class CallKind : std::uint8_t { search, gather, cancelled };

/// Parameters of a rank's call. Sent to all ranks. Only searches use the members after `kind`.
struct CallParameters {
    CallKind kind = CallKind::search;
    OutputKind output_kind;
    Order order;
    bool join, limited, verify;
    double margin;
    std::uint64_t limit, buffer_bytes;
    std::array<SliceParameters, 2> slices;
};

SliceParameters parameters_of(const Objects* set) {
    if (set == nullptr) return {};
    return {set->size(), std::holds_alternative<std::span<const Box3d>>(set->boxes), !set->padding.empty()};
}

CallParameters parameters_of(const detail::Request& request, OutputKind output_kind) {
    const Options& options = request.options;
    return {.kind = CallKind::search,
            .output_kind = output_kind,
            .order = options.order,
            .join = request.second != nullptr,
            .limited = options.limit.has_value(),
            .verify = options.verify,
            .margin = options.margin,
            .limit = options.limit.value_or(0),
            .buffer_bytes = options.buffer_bytes,
            .slices = {parameters_of(&request.first), parameters_of(request.second)}};
}

/// Returns the first parameter in which two calls differ, for messages; empty if they agree.
std::string_view difference(const CallParameters& a, const CallParameters& b) {
    if (a.output_kind != b.output_kind) return "the output (count, list, stream or 64-bit indices)";
    if (a.join != b.join) return "the number of sets";
    if (a.order != b.order) return "the order";
    if (a.margin != b.margin) return "the margin";
    if (a.buffer_bytes != b.buffer_bytes) return "the size of the buffer";
    if (a.limited != b.limited || a.limit != b.limit) return "the limit";
    return {};
}

/// Returns the first rank with objects of a set, or the last rank if no rank has objects. All ranks with objects must use the precision
/// of that rank, and have paddings if that rank has paddings.
std::size_t first_rank_with_objects(const std::vector<CallParameters>& all, unsigned set) {
    std::size_t rank = 0;
    while (rank + 1 < all.size() && all[rank].slices[set].size == 0) ++rank;
    return rank;
}

[[noreturn]] void refuse(std::size_t rank, std::size_t other, std::string_view what) {
    throw Error(ErrorCode::usage, "the calls of rank " + std::to_string(rank) + " and rank " + std::to_string(other) +
                                      " differ in " + std::string(what));
}

void check_parameters_agree(const std::vector<CallParameters>& all) {
    for (const CallParameters& parameters : all) {
        if (parameters.verify)
            throw Error(ErrorCode::usage,
                        "verify: the MPI engine cannot check results, because no rank has all objects");
    }
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        if (const auto what = difference(all[0], all[rank]); !what.empty()) refuse(0, rank, what);
    }
    for (unsigned set = 0; set < 2; ++set) {
        const std::size_t first = first_rank_with_objects(all, set);
        const SliceParameters& like = all[first].slices[set];
        for (std::size_t rank = 0; rank < all.size(); ++rank) {
            const SliceParameters& slice = all[rank].slices[set];
            if (slice.size == 0) continue;
            if (slice.wide != like.wide) refuse(first, rank, "the precision of the boxes");
            if (slice.padded != like.padded) refuse(first, rank, "the use of padding");
        }
    }
}

/// Collective. Exchanges the first message of a call. Returns the parameters of all ranks. Throws: the same Error on all ranks if one rank
/// gathers and another rank searches.
std::vector<CallParameters> exchange_parameters(Communicator& comm, const CallParameters& own) {
    std::vector<CallParameters> all = comm.all_gather(own);
    const auto gathers = [](const CallParameters& one) { return one.kind == CallKind::gather; };
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        if (gathers(all[rank]) != gathers(all[0])) refuse(0, rank, "the function (gather_pairs or a search)");
    }
    return all;
}

/// Sets the origin of rounding to the median of a sample of corners. The local engine takes the same sample for the same objects.
void choose_origin(Communicator& comm, const detail::Request& request, JointCall& call) {
    const BoxSource own(request.first, request.second, call.form);
    const OriginSample sample{std::size_t(call.objects())};
    std::vector<OriginSample::Corner> corners;
    Agreement(comm).together([&] {
        for_each_own(call, sample, [&](std::size_t, std::size_t number) { corners.push_back(own.low_corner(number)); });
    });
    call.form.rounding.origin =
        OriginSample::median(comm.all_gather(std::span<const OriginSample::Corner>(corners)).values);
}

/// Refuses the first object of a rank's source, from `number` on, that is not a valid box. position(number) returns the
/// position of an object among the objects of all ranks. named_from(number) returns the offsets, one for each set, that turn
/// an object's number in the source into its name. Throws: BadObject, so that all ranks report the same object.
template <typename Position, typename NamedFrom>
[[noreturn]] void refuse_object(const BoxSource& source, std::size_t number, const Position& position,
                                const NamedFrom& named_from) {
    Entry entry;
    while (number + 1 < source.size() && source.load(number, {&entry, 1})) ++number;
    try {
        source.refuse(number, named_from(number));
    } catch (const Error& error) {
        throw BadObject{std::uint64_t(position(number)), error.what(), error.place()};
    }
}

}  // namespace

void JointCall::refuse(const BoxSource& source, std::size_t own) const {
    refuse_object(
        source, own, [&](std::size_t number) { return position(number); },
        [&](std::size_t number) { return named_from(number); });
}

void join_gather(Communicator& comm) {
    CallParameters own{};
    own.kind = CallKind::gather;
    (void)exchange_parameters(comm, own);
}

void join_cancelled(Communicator& comm) {
    CallParameters own{};
    own.kind = CallKind::cancelled;
    (void)exchange_parameters(comm, own);
    Agreement(comm).together([] { throw Error(ErrorCode::cancelled, "cancelled"); });
}

JointCall join_call(Communicator& comm, const detail::Request& request, OutputKind output_kind,
                    std::uint64_t max_objects) {
    const std::vector<CallParameters> all = exchange_parameters(comm, parameters_of(request, output_kind));
    Agreement(comm).together([&] { detail::check_request(request); });
    check_parameters_agree(all);
    JointCall call;
    call.join = request.second != nullptr;
    call.form = {request.options.margin == 0, {.origin = {}, .margin = request.options.margin}};
    for (unsigned set = 0; set < 2; ++set) {
        call.sizes[set] = all[comm.rank()].slices[set].size;
        const SliceParameters& like = all[first_rank_with_objects(all, set)].slices[set];
        call.wide[set] = like.size > 0 && like.wide;
        call.padded[set] = like.size > 0 && like.padded;
        call.form.exact &= !call.wide[set] && !call.padded[set];
        for (std::size_t rank = 0; rank < all.size(); ++rank) {
            call.starts[set].push_back(call.totals[set]);
            call.totals[set] += all[rank].slices[set].size;
        }
        call.begins[set] = call.starts[set][comm.rank()];
        call.starts[set].push_back(call.totals[set]);
    }
    if (call.objects() > max_objects) {
        throw Error(ErrorCode::resource_limit, std::to_string(call.objects()) + " objects on all ranks; at most " +
                                                   std::to_string(max_objects) + " fit into one call");
    }
    if (!call.form.exact) choose_origin(comm, request, call);
    return call;
}

}  // namespace octopair
