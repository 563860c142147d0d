// The exact stages for objects: "exact object" and "exact feature".
#include <cmath>
#include <utility>

#include "geometry/shape/object_pair.hpp"
#include "octopair/error.hpp"
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

/// Whether a pair counts; what was learned of it so far is replaced, but for the note.
bool judge(const PosedPairs& objects, const Pair& pair, double margin, Batch& batch, std::size_t i) {
    Finding found;
    if (!judge_objects(objects.a(pair), objects.b(pair), margin + objects.padding(pair), found)) return false;
    Finding& finding = batch.finding(i);
    found.note = finding.note;
    finding = std::move(found);
    return true;
}

class ExactObjectFilter final : public Filter {
public:
    ExactObjectFilter(const PosedPairs& objects, double margin) : objects_(objects), margin_(margin) {}

    std::string_view name() const override { return "exact object"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return judge(objects_, batch.pairs()[i], margin_, batch, i); });
    }

private:
    PosedPairs objects_;
    double margin_;
};

class ExactFeatureFilter final : public Filter {
public:
    ExactFeatureFilter(const PosedPairs& objects, const ExactOptions& options) : objects_(objects), options_(options) {}

    std::string_view name() const override { return "exact feature"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Pair pair = batch.pairs()[i];
            // Where no exact stage came before, this one is both.
            const bool judged = batch.finding(i).collision_class != CollisionClass::unknown;
            if (!judged && !judge(objects_, pair, options_.margin, batch, i)) return false;
            Finding& finding = batch.finding(i);
            if (finding.collision_class == CollisionClass::clearance) return true;
            find_contacts(objects_.a(pair), objects_.b(pair), options_.max_contacts, finding);
            return true;
        });
    }

private:
    PosedPairs objects_;
    ExactOptions options_;
};

void check(const ExactOptions& options) {
    if (std::isfinite(options.margin) && options.margin >= 0) return;
    throw Error(ErrorCode::bad_input, "the margin must be finite and >= 0");
}

}  // namespace

std::unique_ptr<Filter> make_exact_object_filter(const ShapedObjects& first, const ExactOptions& options,
                                                 const ShapedObjects* second) {
    check(options);
    return std::make_unique<ExactObjectFilter>(PosedPairs(first, second), options.margin);
}

std::unique_ptr<Filter> make_exact_feature_filter(const ShapedObjects& first, const ExactOptions& options,
                                                  const ShapedObjects* second) {
    check(options);
    return std::make_unique<ExactFeatureFilter>(PosedPairs(first, second), options);
}

}  // namespace octopair
