#include "engine/mpi/leading/slice_distribution.hpp"

#include <algorithm>

#include "base/stop.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

namespace {

Assignment::Set set_of(const Objects* objects) {
    if (objects == nullptr) return {};
    return {objects->size(), std::holds_alternative<std::span<const Box3d>>(objects->boxes), !objects->padding.empty()};
}

}  // namespace

Assignment Assignment::of(const detail::Request& request, OutputKind output_kind) {
    const Options& options = request.options;
    return {.end = false,
            .join = request.second != nullptr,
            .limited = options.limit.has_value(),
            .output_kind = output_kind,
            .order = options.order,
            .margin = options.margin,
            .limit = options.limit.value_or(0),
            .buffer_bytes = options.buffer_bytes,
            .sets = {set_of(&request.first), set_of(request.second)}};
}

Options Assignment::options() const {
    Options options;
    options.order = order;
    options.margin = margin;
    if (limited) options.limit = limit;
    options.buffer_bytes = buffer_bytes;
    return options;
}

void SliceDistribution::make(const Assignment& assignment, const detail::Request* request,
                             const std::stop_token& stop) {
    stop_ = stop;
    assignment_ = &assignment;
    for (unsigned set = 0; set < (assignment.join ? 2 : 1); ++set) {
        const Objects* const all = request == nullptr ? nullptr : set == 0 ? &request->first : request->second;
        assignment.sets[set].wide ? distribute_set<double>(set, all, memory_[set].wide_boxes)
                                  : distribute_set<float>(set, all, memory_[set].boxes);
    }
}

/// Collective. Sets this rank's slice of a set. `all`: all objects of the set on rank 0; null on the other ranks.
template <typename Real>
void SliceDistribution::distribute_set(unsigned set, const Objects* all, Buffer<Box<Real>>& boxes) {
    const std::uint64_t size = assignment_->sets[set].objects;
    const bool padded = assignment_->sets[set].padded;
    const std::size_t own = std::size_t(begin(size, comm_.rank() + 1) - begin(size, comm_.rank()));
    Buffer<double>& padding = memory_[set].padding;
    Agreement(comm_).together([&] {
        if (all != nullptr) return;
        boxes.resize_discard(own);
        padding.resize_discard(padded ? own : 0);
    });
    std::span<const Box<Real>> all_boxes;
    std::span<const double> all_padding;
    if (all != nullptr) {
        all_boxes = std::get<std::span<const Box<Real>>>(all->boxes);
        all_padding = all->padding;
    }
    distribute(all_boxes, size, boxes.span());
    if (padded) distribute(all_padding, size, padding.span());
    if (all == nullptr) {
        slices_[set] = {std::span<const Box<Real>>(boxes.span()), padding.span()};
    } else {
        slices_[set] = {all_boxes.first(own), padded ? all_padding.first(own) : all_padding};
    }
}

/// Collective. Sends `all` from rank 0 in rounds. A round sends a contiguous range of `all`, with parts of the slices of one or more
/// ranks.
template <typename Item>
void SliceDistribution::distribute(std::span<const Item> all, std::uint64_t size, std::span<Item> own) {
    const std::uint64_t step = tuning().ranks.round_bytes / sizeof(Item);
    for (std::uint64_t from = begin(size, 1), to = from; from < size; from = to) {
        Agreement(comm_).together([&] { throw_if_stopped(stop_); });
        to = std::min(size, from + step);
        const auto part = [&](unsigned rank) {
            const std::uint64_t first = std::max(from, begin(size, rank)), last = std::min(to, begin(size, rank + 1));
            return first < last ? last - first : 0;
        };
        Exchange counts{RankCounts(comm_.size(), 0), RankCounts(comm_.size(), 0)};
        if (comm_.rank() == 0) {
            for (unsigned rank = 1; rank < comm_.size(); ++rank) counts.sent[rank] = part(rank);
            comm_.exchange<Item>(all.data() + from, nullptr, counts);
        } else {
            const std::uint64_t own_part = counts.received[0] = part(comm_.rank());
            comm_.exchange<Item>(nullptr, own.data(), counts);
            own = own.subspan(std::size_t(own_part));
        }
    }
}

}  // namespace octopair
