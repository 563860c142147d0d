// FCL's dynamic AABB tree (array, Morton) and sweep and prune managers.
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <fcl/geometry/collision_geometry.h>
#include <fcl/narrowphase/collision_object.h>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

/// A shape that is nothing but its bounds: a box of FCL's would be rounded to centre and sides.
class Bounds : public fcl::CollisionGeometryd {
public:
    explicit Bounds(const Box3f& box) {
        aabb_local = fcl::AABBd(fcl::Vector3d(box.min[0], box.min[1], box.min[2]),
                                fcl::Vector3d(box.max[0], box.max[1], box.max[2]));
    }
    void computeLocalAABB() override {}
};

template <typename Manager>
class Fcl : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override {
        std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
        std::vector<fcl::CollisionObjectd*> pointers;
        objects.reserve(boxes.size());
        pointers.reserve(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            objects.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<Bounds>(boxes[i])));
            objects.back()->setUserData(reinterpret_cast<void*>(i));
            pointers.push_back(objects.back().get());
        }
        Manager manager;
        manager.registerObjects(pointers);
        manager.setup();
        pairs_.clear();
        manager.collide(this, keep);
    }

private:
    static bool keep(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* self) {
        if (a->getAABB().overlap(b->getAABB())) static_cast<Fcl*>(self)->pairs_.push_back({object(a), object(b)});
        return false;
    }
    static std::uint32_t object(const fcl::CollisionObjectd* of) {
        return std::uint32_t(reinterpret_cast<std::uintptr_t>(of->getUserData()));
    }
};

}  // namespace

std::vector<ContenderKind> fcl_contenders() {
    return {
        {"FCL AABB tree", false, false,
         [](unsigned) -> std::unique_ptr<Contender> {
             return std::make_unique<Fcl<fcl::DynamicAABBTreeCollisionManager_Arrayd>>();
         }},
        {"FCL sweep and prune", false, false,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Fcl<fcl::SaPCollisionManagerd>>(); },
         50'000},
    };
}

}  // namespace octopair::bench
