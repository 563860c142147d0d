#include "cli/detect/row_filters.hpp"

#include <string_view>
#include <utility>

#include "octopair/filters.hpp"

namespace octopair::cli {

namespace {

class EarlyDepthFilter final : public Filter {
public:
    EarlyDepthFilter(std::unique_ptr<Filter> features, double min_depth)
        : features_(std::move(features)), depth_(make_depth_filter(min_depth)) {}

    std::string_view name() const override { return "depth"; }

    void apply(Batch& batch) const override {
        Batch judged = batch;
        features_->apply(judged);
        depth_->apply(judged);
        // Filters keep the order of the pairs.
        auto kept = judged.pairs().begin();
        batch.keep_if([&](std::size_t i) {
            const bool is_kept = kept != judged.pairs().end() && *kept == batch.pairs()[i];
            if (is_kept) ++kept;
            return is_kept;
        });
    }

private:
    std::unique_ptr<Filter> features_, depth_;
};

class ClassFilter final : public Filter {
public:
    explicit ClassFilter(const ClassSet& classes) : classes_(classes) {}

    std::string_view name() const override { return "classes"; }

    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) { return classes_[std::size_t(batch.finding(i).collision_class)]; });
    }

private:
    ClassSet classes_;
};

class RecordedFilter final : public Filter {
public:
    RecordedFilter(std::unique_ptr<Filter> filter, LeftOut& left_out)
        : filter_(std::move(filter)), left_out_(left_out) {}

    std::string_view name() const override { return filter_->name(); }
    std::size_t least_batch() const override { return filter_->least_batch(); }

    void apply(Batch& batch) const override {
        const Batch before = batch;
        filter_->apply(batch);
        if (batch.pairs().size() == before.pairs().size()) return;
        // Filters keep the order of the pairs.
        const std::lock_guard lock(left_out_.mutex);
        auto kept = batch.pairs().begin();
        for (std::size_t i = 0; i < before.pairs().size(); ++i) {
            if (kept != batch.pairs().end() && *kept == before.pairs()[i]) {
                ++kept;
                continue;
            }
            left_out_.pairs.push_back(before.pairs()[i]);
            if (!left_out_.keeps_findings) continue;
            left_out_.findings.push_back(before.findings().empty() ? Finding() : before.findings()[i]);
        }
    }

private:
    std::unique_ptr<Filter> filter_;
    LeftOut& left_out_;
};

}  // namespace

std::unique_ptr<Filter> make_early_depth_filter(std::unique_ptr<Filter> features, double min_depth) {
    return std::make_unique<EarlyDepthFilter>(std::move(features), min_depth);
}

std::unique_ptr<Filter> make_class_filter(const ClassSet& classes) { return std::make_unique<ClassFilter>(classes); }

std::unique_ptr<Filter> make_recorded_filter(std::unique_ptr<Filter> filter, LeftOut& left_out) {
    return std::make_unique<RecordedFilter>(std::move(filter), left_out);
}

}  // namespace octopair::cli
