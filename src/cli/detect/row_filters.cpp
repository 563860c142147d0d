#include "cli/detect/row_filters.hpp"

#include <string_view>
#include <utility>

#include "octopair/filters.hpp"

namespace octopair::cli {

namespace {

class EarlyDepthFilter final : public Filter {
public:
    EarlyDepthFilter(std::unique_ptr<Filter> features, double min_depth)
        : features_(std::move(features)), min_depth_(min_depth) {}

    std::string_view name() const override { return "depth"; }

    void apply(Batch& batch) const override {
        Batch judged = batch;
        features_->apply(judged);
        batch.keep_if([&](std::size_t i) {
            const Finding& finding = judged.finding(i);
            return finding.depth_kind == DepthKind::unknown || finding.depth_at_most >= min_depth_;
        });
    }

private:
    std::unique_ptr<Filter> features_;
    double min_depth_;
};

class ClassFilter final : public Filter {
public:
    ClassFilter(const ClassSet& classes, LeftOut* left_out) : classes_(classes), left_out_(left_out) {}

    std::string_view name() const override { return "classes"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const Finding& finding = batch.finding(i);
            if (classes_[std::size_t(finding.collision_class)]) return true;
            if (left_out_ != nullptr) {
                const std::lock_guard lock(left_out_->mutex);
                left_out_->pairs.push_back(batch.pairs()[i]);
                left_out_->findings.push_back(finding);
            }
            return false;
        });
    }

private:
    ClassSet classes_;
    LeftOut* left_out_;
};

}  // namespace

std::unique_ptr<Filter> make_early_depth_filter(std::unique_ptr<Filter> features, double min_depth) {
    return std::make_unique<EarlyDepthFilter>(std::move(features), min_depth);
}

std::unique_ptr<Filter> make_class_filter(const ClassSet& classes, LeftOut* left_out) {
    return std::make_unique<ClassFilter>(classes, left_out);
}

}  // namespace octopair::cli
