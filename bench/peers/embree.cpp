// Embree's rtcCollide on user geometry, with the fast builder (Morton) and the good builder (surface area heuristic).
#include <embree3/rtcore.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

class Embree : public CollectingContender {
public:
    Embree(unsigned threads, RTCBuildQuality quality) : quality_(quality) {
        device_ = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    }
    ~Embree() override { rtcReleaseDevice(device_); }

    void run(std::span<const Box3f> boxes) override {
        boxes_ = boxes;
        const RTCScene scene = rtcNewScene(device_);
        rtcSetSceneBuildQuality(scene, quality_);
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryBuildQuality(geometry, quality_);
        rtcSetGeometryUserPrimitiveCount(geometry, unsigned(boxes.size()));
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
        for (auto& some : found_) some.clear();
        rtcCollide(scene, scene, collide, this);
        rtcReleaseScene(scene);
        pairs_.clear();
        for (const auto& some : found_) pairs_.insert(pairs_.end(), some.begin(), some.end());
    }

private:
    static void bounds(const RTCBoundsFunctionArguments* arguments) {
        const Box3f& box = static_cast<Embree*>(arguments->geometryUserPtr)->boxes_[arguments->primID];
        RTCBounds& to = *arguments->bounds_o;
        to.lower_x = box.min[0];
        to.lower_y = box.min[1];
        to.lower_z = box.min[2];
        to.upper_x = box.max[0];
        to.upper_y = box.max[1];
        to.upper_z = box.max[2];
    }

    /// Embree reports candidates in both directions, and a leaf with itself. Keeps candidates with a < b whose boxes
    /// overlap.
    static void collide(void* self, RTCCollision* collisions, unsigned count) {
        Embree& embree = *static_cast<Embree*>(self);
        std::vector<Pair>& found = embree.found_.local();
        for (unsigned i = 0; i < count; ++i) {
            const std::uint32_t a = collisions[i].primID0, b = collisions[i].primID1;
            if (a < b && overlap(embree.boxes_[a], embree.boxes_[b])) found.push_back({a, b});
        }
    }

    static bool overlap(const Box3f& a, const Box3f& b) {
        bool hit = true;
        for (int axis = 0; axis < 3; ++axis) hit &= a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis];
        return hit;
    }

    RTCBuildQuality quality_;
    RTCDevice device_;
    std::span<const Box3f> boxes_;
    oneapi::tbb::enumerable_thread_specific<std::vector<Pair>> found_;
};

}  // namespace

std::vector<ContenderKind> embree_contenders() {
    return {
        {"Embree Morton", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Embree>(k, RTC_BUILD_QUALITY_LOW); }},
        {"Embree SAH", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> {
             return std::make_unique<Embree>(k, RTC_BUILD_QUALITY_MEDIUM);
         }},
    };
}

}  // namespace octopair::bench
