// ODE's hash space for all pairs of one scene; hash space and sweep and prune space frame by frame.
#include <ode/ode.h>

#include "peers/contender.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

namespace {

/// Registers a class of geometry that consists only of its bounds.
int bounds_class() {
    static const int number = [] {
        dGeomClass bounds{};
        bounds.bytes = sizeof(const Box3f*);
        bounds.collider = [](int) -> dColliderFn* { return nullptr; };
        bounds.aabb = [](dGeomID geometry, dReal aabb[6]) {
            const Box3f& box = **static_cast<const Box3f**>(dGeomGetClassData(geometry));
            for (int axis = 0; axis < 3; ++axis) {
                aabb[2 * axis] = dReal(box.min[axis]);
                aabb[2 * axis + 1] = dReal(box.max[axis]);
            }
        };
        return dCreateGeomClass(&bounds);
    }();
    return number;
}

std::uint32_t object(dGeomID of) { return std::uint32_t(reinterpret_cast<std::uintptr_t>(dGeomGetData(of))); }

void keep(void* pairs, dGeomID a, dGeomID b) {
    dReal first[6], second[6];
    dGeomGetAABB(a, first);
    dGeomGetAABB(b, second);
    for (int axis = 0; axis < 3; ++axis) {
        if (first[2 * axis] > second[2 * axis + 1] || second[2 * axis] > first[2 * axis + 1]) return;
    }
    static_cast<std::vector<Pair>*>(pairs)->push_back({object(a), object(b)});
}

dSpaceID make_hash_space() { return dHashSpaceCreate(nullptr); }
dSpaceID make_sweep_and_prune_space() { return dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ); }

/// ODE space with a geometry for each box. Requires: the boxes stay at their place in memory.
class OdeWorld {
public:
    OdeWorld(std::span<const Box3f> boxes, dSpaceID space) : space_(space), geometries_(boxes.size()) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const dGeomID geometry = geometries_[i] = dCreateGeom(bounds_class());
            *static_cast<const Box3f**>(dGeomGetClassData(geometry)) = &boxes[i];
            dGeomSetData(geometry, reinterpret_cast<void*>(i));
            dSpaceAdd(space_, geometry);
        }
    }
    OdeWorld(const OdeWorld&) = delete;
    OdeWorld& operator=(const OdeWorld&) = delete;
    ~OdeWorld() { dSpaceDestroy(space_); }

    /// Sets positions of moved geometries. ODE queries their bounds at the next collision test of the space.
    void next(const Frame& frame) {
        for (std::size_t i = 0; i < frame.moved.size(); ++i) {
            const float* const at = frame.moved_boxes[i].min;
            dGeomSetPosition(geometries_[frame.moved[i]], dReal(at[0]), dReal(at[1]), dReal(at[2]));
        }
    }

    void collect(std::vector<Pair>& pairs) {
        pairs.clear();
        dSpaceCollide(space_, &pairs, keep);
    }

private:
    dSpaceID space_;
    std::vector<dGeomID> geometries_;
};

class Ode : public CollectingContender {
public:
    Ode() { dInitODE2(0); }
    void run(std::span<const Box3f> boxes) override { OdeWorld(boxes, make_hash_space()).collect(pairs_); }
};

template <dSpaceID (*make_space)()>
class OdeTracker : public CollectingTracker {
public:
    OdeTracker() { dInitODE2(0); }
    void begin(std::span<const Box3f> boxes) override {
        world_ = std::make_unique<OdeWorld>(boxes, make_space());
        world_->collect(pairs_);
    }
    void next(const Frame& frame) override {
        world_->next(frame);
        world_->collect(pairs_);
    }

private:
    std::unique_ptr<OdeWorld> world_;
};

}  // namespace

std::vector<ContenderKind> ode_contenders() {
    return {{"ODE hash space", false, false,
             [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Ode>(); }, 50'000}};
}

std::vector<TrackerKind> ode_trackers() {
    return {
        {"ODE hash space", false,
         [](unsigned) -> std::unique_ptr<Tracker> { return std::make_unique<OdeTracker<make_hash_space>>(); }},
        {"ODE sweep and prune", false,
         [](unsigned) -> std::unique_ptr<Tracker> {
             return std::make_unique<OdeTracker<make_sweep_and_prune_space>>();
         }},
    };
}

}  // namespace octopair::bench
