// Collisions of instances of a mesh: octopair's pipeline, and FCL's dynamic AABB tree with FCL's own narrow phase.
//
//     octopair_exact_objects [--objects N] [--threads K] [--rounds R] [--json FILE]
//
// Both start with the mesh and the poses and end with the pairs of objects that collide. Time includes data built from
// the mesh, the boxes and the tree of the broad phase. Both take turns, round by round. FCL tests only surfaces, so
// pairs that octopair finds contained are not compared. If the other pairs differ, the exit status is 1.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"
#include "machine/median.hpp"
#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"
#include "samples/meshes.hpp"

namespace {

using namespace octopair;

struct Request {
    std::uint32_t objects = 10'000;
    unsigned threads = 1;
    unsigned rounds = 5;
    std::string json;
};

struct Scene {
    shape::Mesh mesh;
    std::vector<Pose> poses;
};

/// Makes objects with 5,000 triangles each, at a density where each object collides with about one other.
Scene make_scene(const Request& request) {
    Scene scene{samples::torus_mesh({50, 50, 0.2, 1}), {}};
    samples::RandomStream random(2, 0);
    const double width = 2.1 * std::cbrt(double(request.objects));
    for (std::uint32_t i = 0; i < request.objects; ++i) scene.poses.push_back(samples::random_pose(random, width));
    return scene;
}

std::vector<Pair> by_octopair(const Scene& scene, unsigned threads) {
    const std::vector<Geometry> geometries = {Geometry(scene.mesh)};
    const std::vector<std::uint32_t> geometry(scene.poses.size(), 0);
    const ShapedObjects objects{geometries, geometry, scene.poses};
    const std::vector<Box3d> boxes = boxes_of(objects);
    const auto engine = make_local_engine(threads);
    Pipeline pipeline(threads);
    pipeline.add(make_exact_object_filter(objects));
    std::vector<Pair> collisions;
    pipeline.run(*engine, {std::span(boxes)}, [&](const Batch& batch) {
        for (std::size_t i = 0; i < batch.pairs().size(); ++i) {
            const bool contained = batch.findings()[i].collision_class == CollisionClass::contained;
            if (!contained) collisions.push_back(batch.pairs()[i]);
        }
    });
    return collisions;
}

std::shared_ptr<fcl::CollisionGeometryd> fcl_mesh(const shape::Mesh& mesh) {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    std::vector<fcl::Vector3d> vertices;
    std::vector<fcl::Triangle> triangles;
    for (const Point3d& v : mesh.vertices) vertices.emplace_back(v[0], v[1], v[2]);
    for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
    model->beginModel();
    model->addSubModel(vertices, triangles);
    model->endModel();
    return model;
}

fcl::Transform3d fcl_pose(const Pose& pose) {
    fcl::Transform3d transform = fcl::Transform3d::Identity();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) transform(row, column) = pose.rows[row][column];
    }
    return transform;
}

std::uint32_t number_of(const fcl::CollisionObjectd* object) {
    return std::uint32_t(reinterpret_cast<std::uintptr_t>(object->getUserData()));
}

bool keep_colliding(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
    fcl::CollisionResultd result;
    if (fcl::collide(a, b, fcl::CollisionRequestd(), result) == 0) return false;
    static_cast<std::vector<Pair>*>(pairs)->push_back(
        {std::min(number_of(a), number_of(b)), std::max(number_of(a), number_of(b))});
    return false;
}

std::vector<Pair> by_fcl(const Scene& scene) {
    const auto model = fcl_mesh(scene.mesh);
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
    std::vector<fcl::CollisionObjectd*> pointers;
    for (std::size_t i = 0; i < scene.poses.size(); ++i) {
        objects.push_back(std::make_unique<fcl::CollisionObjectd>(model, fcl_pose(scene.poses[i])));
        objects.back()->setUserData(reinterpret_cast<void*>(i));
        pointers.push_back(objects.back().get());
    }
    fcl::DynamicAABBTreeCollisionManagerd manager;
    manager.registerObjects(pointers);
    manager.setup();
    std::vector<Pair> collisions;
    manager.collide(&collisions, keep_colliding);
    std::sort(collisions.begin(), collisions.end());
    return collisions;
}

template <typename Find>
double seconds_of(const Find& find, std::vector<Pair>& found) {
    const auto start = std::chrono::steady_clock::now();
    found = find();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int run(const Request& request) {
    const Scene scene = make_scene(request);
    std::vector<double> ours, theirs;
    std::vector<Pair> found, found_by_fcl;
    for (unsigned round = 0; round < request.rounds; ++round) {
        ours.push_back(seconds_of([&] { return by_octopair(scene, request.threads); }, found));
        theirs.push_back(seconds_of([&] { return by_fcl(scene); }, found_by_fcl));
    }
    const bool agree = found == found_by_fcl;
    const double ratio = bench::median(theirs) / bench::median(ours);
    fmt::print("{} objects of {} triangles, {} rounds\n", request.objects, scene.mesh.triangles.size(), request.rounds);
    fmt::print("  octopair, {} thread(s)  {:8.3f} s  {} collisions\n", request.threads, bench::median(ours),
               found.size());
    fmt::print("  FCL, 1 thread          {:8.3f} s  {} collisions{}\n", bench::median(theirs), found_by_fcl.size(),
               agree ? "" : "  DIFFERS");
    fmt::print("  FCL / octopair         {:8.2f}\n", ratio);
    if (!request.json.empty()) {
        const nlohmann::ordered_json json = {{"machine", bench::machine_json()},
                                             {"objects", request.objects},
                                             {"threads", request.threads},
                                             {"triangles", scene.mesh.triangles.size()},
                                             {"collisions", found.size()},
                                             {"agree", agree},
                                             {"octopair_seconds", ours},
                                             {"fcl_seconds", theirs},
                                             {"ratio", ratio}};
        io::AtomicFile file(request.json);
        file.write(json.dump(2) + '\n');
        file.commit();
    }
    return agree ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Compares octopair with FCL on colliding instances of a mesh.");
    Request request;
    app.add_option("--objects", request.objects, "number of instances (default 10000)");
    app.add_option("--threads", request.threads, "threads of octopair; FCL uses one thread (default 1)");
    app.add_option("--rounds", request.rounds, "rounds; both run once in each round (default 5)")
        ->check(CLI::PositiveNumber);
    app.add_option("--json", request.json, "write the results to this file as JSON");
    CLI11_PARSE(app, argc, argv);
    return run(request);
}
