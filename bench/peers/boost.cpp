// Boost.Geometry's R-tree, packed. Each box queries the tree for later boxes.
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <iterator>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

namespace bg = boost::geometry;
using Point = bg::model::point<float, 3, bg::cs::cartesian>;
using Region = bg::model::box<Point>;
using Value = std::pair<Region, std::uint32_t>;

class BoostTree : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override {
        std::vector<Value> values;
        values.reserve(boxes.size());
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            const Box3f& box = boxes[i];
            values.emplace_back(
                Region(Point(box.min[0], box.min[1], box.min[2]), Point(box.max[0], box.max[1], box.max[2])), i);
        }
        const bg::index::rtree<Value, bg::index::linear<16>> tree(values);
        pairs_.clear();
        for (const auto& [region, object] : values) {
            for (auto hit = tree.qbegin(bg::index::intersects(region)); hit != tree.qend(); ++hit) {
                if (hit->second > object) pairs_.push_back({object, hit->second});
            }
        }
    }
};

}  // namespace

std::vector<ContenderKind> boost_contenders() {
    return {{"Boost R-tree", false, false,
             [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<BoostTree>(); }}};
}

}  // namespace octopair::bench
