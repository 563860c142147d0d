#include "exactness/small_scenes.hpp"

#include <cstdio>

#include "exactness/tiny_tuning.hpp"
#include "samples/random.hpp"
#include "support/families.hpp"
#include "support/kinds.hpp"

namespace octopair::test {

Case small_case(std::uint64_t seed) {
    static const auto families = family_names(), kinds = all_kind_names();
    samples::RandomStream random(seed, 1);
    // Mostly few objects, because the time of nested octrees grows fast with the number of objects.
    const std::uint64_t size = random.below(100), bound = size < 50 ? 20 : size < 98 ? 50 : 300;
    const std::uint64_t objects = 2 + random.below(bound - 1);
    if (random.below(4) != 0) return make_family_case(families[random.below(families.size())], objects, seed);
    const std::string& kind = kinds[random.below(kinds.size())];
    Case result;
    result.first.boxes = make_boxes(kind, objects, seed);
    if (random.below(2) == 0) result.first.boxes = make_double_boxes(kind, objects, seed);
    if (random.below(3) == 0) result.second.emplace().boxes = make_boxes(kind, objects / 2, seed + 1);
    if (random.below(3) == 0) result.margin = random.below(2) == 0 ? 0.5 : random.uniform() / 8;
    result.limit = random.below(1 + 2 * objects);
    result.buffer_bytes = std::uint64_t(1) << random.below(14);
    for (unsigned& threads : result.threads) threads = 1 + unsigned(random.below(3));
    return result;
}

#ifdef OCTOPAIR_TEST_HOOKS

std::optional<Finding> check_small_cases(const SceneRange& seeds, const EngineFor& engines) {
    for (std::uint64_t seed = seeds.begin; seed < seeds.end; ++seed) {
        const Case a_case = small_case(seed);
        const TuningScope tiny(tiny_tuning(seed));
        if (auto finding = check_case(a_case, brute_force_pairs(a_case), engines)) {
            finding->text += "; OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ": " + a_case.describe();
            return finding;
        }
    }
    return {};
}

void reset_test_hooks() {
    test_hooks().tuning = default_tuning;
    test_hooks().fault = Fault::none;
    for (auto& taken : test_hooks().paths) taken = 0;
}

std::string paths_not_taken(std::initializer_list<Path> paths) {
    std::string names;
    for (const Path path : paths) {
        const std::uint64_t taken = test_hooks().paths[std::size_t(path)];
        std::printf("%-24s %12llu\n", path_names[std::size_t(path)].data(), static_cast<unsigned long long>(taken));
        if (taken == 0) names.append(" ").append(path_names[std::size_t(path)]);
    }
    return names;
}

#endif

}  // namespace octopair::test
