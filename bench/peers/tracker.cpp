#include "peers/tracker.hpp"

namespace octopair::bench {

Found CollectingTracker::found() const {
    Found found;
    add(found, pairs_);
    return found;
}

std::vector<TrackerKind> tracker_kinds() {
    std::vector<TrackerKind> kinds;
    for (const auto& some : {octopair_trackers(), bullet_trackers(), fcl_trackers(), ode_trackers()}) {
        kinds.insert(kinds.end(), some.begin(), some.end());
    }
    return kinds;
}

}  // namespace octopair::bench
