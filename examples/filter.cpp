// User-defined filter after the box test: keeps pairs of spheres whose distance is at most the sum of their radii.
#include <octopair/octopair.hpp>
#include <octopair/pipeline.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

struct Sphere {
    std::array<float, 3> centre;
    float radius;
};

octopair::Box3f box_of(const Sphere& s) {
    octopair::Box3f box;
    for (std::size_t i = 0; i < 3; ++i) {
        box.min[i] = s.centre[i] - s.radius;
        box.max[i] = s.centre[i] + s.radius;
    }
    return box;
}

/// Keeps spheres that touch, and records the squared distance of their centres in thousandths.
class SpheresTouch final : public octopair::Filter {
public:
    explicit SpheresTouch(const std::vector<Sphere>& spheres) : spheres_(spheres) {}

    std::string_view name() const override { return "spheres touch"; }

    void apply(octopair::Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Sphere &a = spheres_[batch.pairs()[i].a], &b = spheres_[batch.pairs()[i].b];
            float squared = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                squared += (a.centre[k] - b.centre[k]) * (a.centre[k] - b.centre[k]);
            }
            const float reach = a.radius + b.radius;
            if (squared > reach * reach) return false;
            batch.finding(i).note = std::uint64_t(1000 * squared);
            return true;
        });
    }

private:
    const std::vector<Sphere>& spheres_;
};

}  // namespace

int main() {
    const std::vector<Sphere> spheres = {
        {{0, 0, 0}, 1}, {{1.5f, 0, 0}, 1}, {{1.2f, 1.7f, 0}, 1}, {{-1.5f, -1.5f, 0}, 1}};
    std::vector<octopair::Box3f> boxes;
    for (const Sphere& sphere : spheres) boxes.push_back(box_of(sphere));
    try {
        octopair::Pipeline pipeline;
        pipeline.add(std::make_unique<SpheresTouch>(spheres));
        const auto print = [](const octopair::Batch& batch) {
            for (std::size_t i = 0; i < batch.pairs().size(); ++i) {
                const auto [a, b] = batch.pairs()[i];
                std::printf("%u and %u: %.2f\n", a, b, double(batch.findings()[i].note) / 1000);
            }
        };
        const auto summary = pipeline.run(*octopair::make_local_engine(), {boxes}, print);
        const auto& filter = summary.filters.front();
        std::printf("%s: %llu of %llu\n", filter.name.c_str(), static_cast<unsigned long long>(filter.out),
                    static_cast<unsigned long long>(filter.in));
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
