#include "exactness/large_scenes.hpp"

#include "exactness/shrink.hpp"
#include "samples/random.hpp"
#include "support/families.hpp"

namespace octopair::test {

namespace {

constexpr std::uint64_t max_pairs_per_object = 60;

std::uint64_t pairs_of(const Case& a_case, Engine& engine) {
    Options options{.margin = a_case.margin, .limit = max_pairs_per_object * 1'000'000};
    return engine.count_pairs(a_case.input(), options);
}

std::uint64_t object_count_of(const Case& a_case) {
    return a_case.first.view().size() + (a_case.second ? a_case.second->view().size() : 0);
}

}  // namespace

Case large_case(std::uint64_t i, std::uint64_t least) {
    static const auto names = family_names();
    static const auto engine = make_local_engine(2);
    for (std::uint64_t attempt = 0;; ++attempt) {
        const std::uint64_t seed = samples::mix_bits(i * 64 + attempt) >> 1;
        samples::RandomStream random(seed, 2);
        const auto objects = std::uint64_t(double(least) * (1 + 6 * random.uniform()));
        Case a_case = make_family_case(names[i % names.size()], objects, seed);
        if (pairs_of(a_case, *engine) <= max_pairs_per_object * object_count_of(a_case)) return a_case;
    }
}

std::optional<Finding> check_large_case(const Case& a_case, const EngineFor& engines, Calls calls) {
    const auto check = [&](const Case& one) { return check_case(one, second_algorithm_pairs(one), engines, calls); };
    std::optional<Finding> finding = check(a_case);
    if (!finding) return {};
    const Case smallest = shrunk(
        a_case, [&](const Case& one) { return check(one).has_value(); }, std::chrono::seconds(60));
    finding->text += "\n" + as_test(smallest);
    return finding;
}

Case cloth_case(std::uint64_t objects, std::uint64_t seed) {
    for (;; ++seed) {
        Case a_case = make_family_case("cloth", objects, seed);
        if (a_case.second) return a_case;
    }
}

}  // namespace octopair::test
