// FairOrder: decides which client's job runs next, when clients have more jobs than the server can run.
//
// - Each client gets the same share of the work, however many jobs it has waiting.
// - The work of a job is estimated from its objects when it begins, and corrected when it ends: few objects can have many pairs. A client
//   that was idle gets no more than its share afterwards.
// - Source: Goyal, Vin, Cheng 1996, "Start-time fair queueing".
#pragma once

#include <algorithm>
#include <map>
#include <string>

namespace octopair::service {

/// Thread safety: none; the caller locks.
class FairOrder {
public:
    /// Returns the virtual start time of the client's next job. The job with the smallest start time runs next.
    double start_of(const std::string& client) const {
        const auto known = ends_.find(client);
        return known == ends_.end() ? now_ : std::max(now_, known->second);
    }
    /// Records that a job of a client begins to run. Requires: `work`, the estimated work, is > 0.
    void begin(const std::string& client, double work) {
        now_ = start_of(client);
        ends_[client] = now_ + work;
        constexpr std::size_t max_known = 1000;
        if (ends_.size() > max_known) std::erase_if(ends_, [this](const auto& end) { return end.second <= now_; });
    }

    /// Records that a job of a client took more work than begin() assumed. Requires: `more`, the difference, is >= 0.
    void add(const std::string& client, double more) {
        const auto known = ends_.find(client);
        if (known != ends_.end()) known->second += more;
    }

private:
    double now_ = 0;                      // virtual start time of the job that began last
    std::map<std::string, double> ends_;  // virtual end time of the last job of each client
};

}  // namespace octopair::service
