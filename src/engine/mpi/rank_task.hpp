// RankSearch::Task: state of one call, which the steps of RankSearch pass on.
#pragma once

#include <array>
#include <optional>
#include <stop_token>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/relay.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/order/index_order.hpp"
#include "engine/mpi/rank_search.hpp"
#include "engine/progress.hpp"

namespace octopair {

struct RankSearch::Task {
    Task(RankSearch& search, const detail::Request& asked, const detail::Output& out, const ProgressSink& sink)
        : request(asked),
          output(out),
          progress_sink(sink),
          stops(search.comm_, stop, search.on_poll_),
          agreement(search.comm_),
          progress(sink),
          order(search.comm_) {}

    const detail::Request& request;
    const detail::Output& output;
    const IndexedCall* indexed = nullptr;
    Recipients recipients = Recipients::all;
    const ProgressSink& progress_sink;
    std::stop_source stop;
    StopRelay stops;
    Agreement agreement;
    Progress progress;
    std::optional<Relay> relay;  // only if a sink of rank 0 receives all pairs
    JointCall joint;
    std::array<Objects, 2> slices;
    IndexOrder order;  // used by indexed calls only
    Summary summary;
    unsigned sets() const { return joint.join ? 2 : 1; }
};

}  // namespace octopair
