// FCL's dynamic AABB trees (array in Morton order, and tree of nodes), and FCL's sweep and prune. Contenders for all
// pairs of one scene, and trackers frame by frame.
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <fcl/geometry/collision_geometry.h>
#include <fcl/narrowphase/collision_object.h>

#include "peers/contender.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

namespace {

/// Shape that consists only of its bounds. FCL's own box stores centre and sides, which would round the bounds.
class Bounds : public fcl::CollisionGeometryd {
public:
    explicit Bounds(const Box3f& box) { set(box); }
    void computeLocalAABB() override {}
    void set(const Box3f& box) {
        aabb_local = fcl::AABBd(fcl::Vector3d(box.min[0], box.min[1], box.min[2]),
                                fcl::Vector3d(box.max[0], box.max[1], box.max[2]));
    }
};

std::uint32_t object(const fcl::CollisionObjectd* of) {
    return std::uint32_t(reinterpret_cast<std::uintptr_t>(of->getUserData()));
}

bool keep(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
    if (a->getAABB().overlap(b->getAABB())) {
        static_cast<std::vector<Pair>*>(pairs)->push_back({object(a), object(b)});
    }
    return false;
}

/// Manager with an object for each box.
template <typename Manager>
class FclWorld {
public:
    explicit FclWorld(std::span<const Box3f> boxes) {
        shapes_.reserve(boxes.size());
        objects_.reserve(boxes.size());
        pointers_.reserve(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            auto shape = std::make_shared<Bounds>(boxes[i]);
            shapes_.push_back(shape.get());
            objects_.push_back(std::make_unique<fcl::CollisionObjectd>(std::move(shape)));
            objects_.back()->setUserData(reinterpret_cast<void*>(i));
            pointers_.push_back(objects_.back().get());
        }
        manager_.registerObjects(pointers_);
        manager_.setup();
    }

    /// Moves the objects of a frame. If all moved, refits the whole tree, and builds it anew in every tenth frame: after some
    /// hundred refits it would be 30 times slower. Else moves single objects within the tree.
    void next(const Frame& frame) {
        moved_.clear();
        for (std::size_t i = 0; i < frame.moved.size(); ++i) {
            const std::uint32_t index = frame.moved[i];
            shapes_[index]->set(frame.moved_boxes[i]);
            pointers_[index]->computeAABB();
            moved_.push_back(pointers_[index]);
        }
        if (!frame.all_moved()) {
            manager_.update(moved_);
        } else if (++refits_ < 10) {
            manager_.update();
        } else {
            refits_ = 0;
            manager_.clear();
            manager_.registerObjects(pointers_);
            manager_.setup();
        }
    }

    void collect(std::vector<Pair>& pairs) {
        pairs.clear();
        manager_.collide(&pairs, keep);
    }

    /// Returns the number of objects that overlap a box.
    std::uint64_t overlaps(const Box3f& box) {
        query_shape_->set(box);
        query_.computeAABB();
        found_.clear();
        manager_.collide(&query_, &found_, keep);
        return found_.size();
    }

private:
    std::shared_ptr<Bounds> query_shape_ = std::make_shared<Bounds>(Box3f{});
    fcl::CollisionObjectd query_{query_shape_};
    std::vector<Pair> found_;
    std::vector<Bounds*> shapes_;
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
    std::vector<fcl::CollisionObjectd*> pointers_, moved_;
    unsigned refits_ = 0;  // since the tree was built
    Manager manager_;
};

template <typename Manager>
class Fcl : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override { FclWorld<Manager>(boxes).collect(pairs_); }
};

template <typename Manager>
class FclTracker : public CollectingTracker {
public:
    void begin(std::span<const Box3f> boxes) override {
        world_ = std::make_unique<FclWorld<Manager>>(boxes);
        world_->collect(pairs_);
    }
    void next(const Frame& frame) override {
        world_->next(frame);
        world_->collect(pairs_);
    }
    std::optional<std::uint64_t> overlaps(std::span<const Box3f> boxes) override {
        std::uint64_t objects = 0;
        for (const Box3f& box : boxes) objects += world_->overlaps(box);
        return objects;
    }

private:
    std::unique_ptr<FclWorld<Manager>> world_;
};

using TreeInArray = fcl::DynamicAABBTreeCollisionManager_Arrayd;
using TreeOfNodes = fcl::DynamicAABBTreeCollisionManagerd;

}  // namespace

std::vector<ContenderKind> fcl_contenders() {
    return {
        {"FCL AABB tree", false, false,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Fcl<TreeInArray>>(); }},
        {"FCL sweep and prune", false, false,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Fcl<fcl::SaPCollisionManagerd>>(); },
         50'000},
    };
}

std::vector<TrackerKind> fcl_trackers() {
    return {
        {"FCL AABB tree", false,
         [](unsigned) -> std::unique_ptr<Tracker> { return std::make_unique<FclTracker<TreeOfNodes>>(); }},
        {"FCL AABB tree, array", false,
         [](unsigned) -> std::unique_ptr<Tracker> { return std::make_unique<FclTracker<TreeInArray>>(); }},
    };
}

}  // namespace octopair::bench
