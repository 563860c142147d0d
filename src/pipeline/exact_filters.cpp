// The exact stages for objects: "exact object" and "exact feature".
#include <utility>

#include "geometry/shape/object_pair.hpp"
#include "octopair/filters.hpp"

namespace octopair {

namespace {

/// The objects of pairs: of one set, or of two.
class PosedPairs {
public:
    PosedPairs(const ShapedObjects& first, const ShapedObjects* second)
        : first_(first), second_(second ? *second : first) {
        check(first_);
        check(second_);
    }

    PosedObject a(const Pair& pair) const { return posed(first_, pair.a); }
    PosedObject b(const Pair& pair) const { return posed(second_, pair.b); }
    double padding(const Pair& pair) const { return padding_of(first_, pair.a) + padding_of(second_, pair.b); }

private:
    static PosedObject posed(const ShapedObjects& objects, std::uint32_t i) {
        return {objects.geometries[objects.geometry[i]].prepared(), objects.poses[i]};
    }
    static double padding_of(const ShapedObjects& objects, std::uint32_t i) {
        return objects.padding.empty() ? 0 : objects.padding[i];
    }

    ShapedObjects first_, second_;
};

class ExactObjectFilter final : public Filter {
public:
    ExactObjectFilter(const PosedPairs& objects, double margin) : objects_(objects), margin_(margin) {}

    std::string_view name() const override { return "exact object"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Pair pair = batch.pairs()[i];
            Finding found;
            if (!judge_objects(objects_.a(pair), objects_.b(pair), margin_ + objects_.padding(pair), found))
                return false;
            Finding& finding = batch.finding(i);
            found.note = finding.note;
            finding = std::move(found);
            return true;
        });
    }

private:
    PosedPairs objects_;
    double margin_;
};

}  // namespace

std::unique_ptr<Filter> make_exact_object_filter(const ShapedObjects& first, const ExactOptions& options,
                                                 const ShapedObjects* second) {
    return std::make_unique<ExactObjectFilter>(PosedPairs(first, second), options.margin);
}

}  // namespace octopair
