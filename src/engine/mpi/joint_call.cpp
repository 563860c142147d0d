#include "engine/mpi/joint_call.hpp"

#include <string>
#include <string_view>

#include "engine/mpi/bad_object.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// What a rank says of its slice of a set.
struct ToldSlice {
    std::uint64_t size;
    bool wide, padded;
};

/// What a rank says of its call.
struct ToldCall {
    OutputKind output_kind;
    Order order;
    bool join, limited, verify;
    double margin;
    std::uint64_t limit, buffer_bytes;
    std::array<ToldSlice, 2> slices;
};

ToldSlice told_of(const Objects* set) {
    if (set == nullptr) return {};
    return {set->size(), std::holds_alternative<std::span<const Box3d>>(set->boxes), !set->padding.empty()};
}

ToldCall told_of(const detail::Request& request, OutputKind output_kind) {
    const Options& options = request.options;
    return {.output_kind = output_kind,
            .order = options.order,
            .join = request.second != nullptr,
            .limited = options.limit.has_value(),
            .verify = options.verify,
            .margin = options.margin,
            .limit = options.limit.value_or(0),
            .buffer_bytes = options.buffer_bytes,
            .slices = {told_of(&request.first), told_of(request.second)}};
}

/// What two ranks' calls do not have in common, or nothing.
std::string_view difference(const ToldCall& a, const ToldCall& b) {
    if (a.output_kind != b.output_kind) return "whether pairs are counted, listed or streamed";
    if (a.join != b.join) return "whether there is a second set";
    if (a.order != b.order) return "the order";
    if (a.margin != b.margin) return "the margin";
    if (a.buffer_bytes != b.buffer_bytes) return "the size of the buffer";
    if (a.limited != b.limited || a.limit != b.limit) return "the limit";
    return {};
}

/// The first rank with an object in a set, which says for all how the set is held.
std::size_t spokesman(const std::vector<ToldCall>& all, unsigned set) {
    std::size_t rank = 0;
    while (rank + 1 < all.size() && all[rank].slices[set].size == 0) ++rank;
    return rank;
}

[[noreturn]] void refuse(std::size_t rank, std::size_t other, std::string_view what) {
    throw Error(ErrorCode::usage, "the ranks' calls differ: " + std::string(what) + ", on rank " +
                                      std::to_string(rank) + " and on rank " + std::to_string(other));
}

void check_likeness(const std::vector<ToldCall>& all) {
    for (const ToldCall& told : all) {
        if (told.verify) throw Error(ErrorCode::usage, "verify: not on ranks, none of which has all objects");
    }
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        if (const auto what = difference(all[0], all[rank]); !what.empty()) refuse(0, rank, what);
    }
    for (unsigned set = 0; set < 2; ++set) {
        const std::size_t first = spokesman(all, set);
        const ToldSlice& like = all[first].slices[set];
        for (std::size_t rank = 0; rank < all.size(); ++rank) {
            const ToldSlice& slice = all[rank].slices[set];
            if (slice.size == 0) continue;
            if (slice.wide != like.wide) refuse(first, rank, "the precision of the boxes");
            if (slice.padded != like.padded) refuse(first, rank, "whether objects have a padding");
        }
    }
}

/// The median of the same corners that the local engine would take.
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

}  // namespace

void JointCall::refuse(const BoxSource& source, std::size_t own) const {
    refuse_object(
        source, own, [&](std::size_t number) { return position(number); },
        [&](std::size_t number) { return named_from(number); });
}

JointCall join_call(Communicator& comm, const detail::Request& request, OutputKind output_kind, std::uint64_t most_objects) {
    Agreement(comm).together([&] { detail::check_request(request); });
    const std::vector<ToldCall> all = comm.all_gather(told_of(request, output_kind));
    check_likeness(all);
    JointCall call;
    call.join = request.second != nullptr;
    call.form = {request.options.margin == 0, {.origin = {}, .margin = request.options.margin}};
    for (unsigned set = 0; set < 2; ++set) {
        call.sizes[set] = all[comm.rank()].slices[set].size;
        const ToldSlice& like = all[spokesman(all, set)].slices[set];
        call.wide[set] = like.size > 0 && like.wide;
        call.padded[set] = like.size > 0 && like.padded;
        call.form.exact &= !call.wide[set] && !call.padded[set];
        for (std::size_t rank = 0; rank < all.size(); ++rank) {
            if (rank == comm.rank()) call.begins[set] = call.totals[set];
            call.totals[set] += all[rank].slices[set].size;
        }
    }
    if (call.objects() > most_objects) {
        throw Error(ErrorCode::resource_limit, std::to_string(call.objects()) + " objects on all ranks; at most " +
                                                   std::to_string(most_objects) + " fit into one call");
    }
    if (!call.form.exact) choose_origin(comm, request, call);
    return call;
}

}  // namespace octopair
