// ODE's hash space.
#include <ode/ode.h>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

/// A class of geometry that is nothing but its bounds.
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

class Ode : public CollectingContender {
public:
    Ode() { dInitODE2(0); }
    void run(std::span<const Box3f> boxes) override {
        const dSpaceID space = dHashSpaceCreate(nullptr);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const dGeomID geometry = dCreateGeom(bounds_class());
            *static_cast<const Box3f**>(dGeomGetClassData(geometry)) = &boxes[i];
            dGeomSetData(geometry, reinterpret_cast<void*>(i));
            dSpaceAdd(space, geometry);
        }
        pairs_.clear();
        dSpaceCollide(space, this, keep);
        dSpaceDestroy(space);
    }

private:
    static void keep(void* self, dGeomID a, dGeomID b) {
        dReal first[6], second[6];
        dGeomGetAABB(a, first);
        dGeomGetAABB(b, second);
        for (int axis = 0; axis < 3; ++axis) {
            if (first[2 * axis] > second[2 * axis + 1] || second[2 * axis] > first[2 * axis + 1]) return;
        }
        static_cast<Ode*>(self)->pairs_.push_back({object(a), object(b)});
    }
    static std::uint32_t object(dGeomID of) {
        return std::uint32_t(reinterpret_cast<std::uintptr_t>(dGeomGetData(of)));
    }
};

}  // namespace

std::vector<ContenderKind> ode_contenders() {
    return {{"ODE hash space", false, false,
             [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Ode>(); }, 50'000}};
}

}  // namespace octopair::bench
