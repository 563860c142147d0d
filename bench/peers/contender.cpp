#include "peers/contender.hpp"

#include <algorithm>

namespace octopair::bench {

namespace {

/// Finalizer of MurmurHash3: every bit of the key affects every bit of the result.
std::uint64_t mixed(std::uint64_t key) {
    key = (key ^ key >> 33) * 0xFF51AFD7ED558CCDull;
    key = (key ^ key >> 33) * 0xC4CEB9FE1A85EC53ull;
    return key ^ key >> 33;
}

}  // namespace

void add(Found& found, std::span<const Pair> pairs) {
    found.pairs += pairs.size();
    for (const Pair& pair : pairs) {
        found.hash += mixed(std::uint64_t(std::min(pair.a, pair.b)) << 32 | std::max(pair.a, pair.b));
    }
}

Found CollectingContender::found() const {
    Found found;
    add(found, pairs_);
    return found;
}

std::vector<ContenderKind> contender_kinds() {
    std::vector<ContenderKind> kinds;
    for (const auto& some : {octopair_contenders(), baseline_contenders(), embree_contenders(), cgal_contenders(),
                             fcl_contenders(), boost_contenders(), bullet_contenders(), ode_contenders(), limits()}) {
        kinds.insert(kinds.end(), some.begin(), some.end());
    }
    return kinds;
}

}  // namespace octopair::bench
