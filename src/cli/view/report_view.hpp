// ReportView: the viewer's page for a report: the objects of the inputs, and the collisions of the report.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"

namespace octopair::cli {

class ReportView {
public:
    /// Borrows the request and the sets. `second` is null unless the result is of a join. Then the objects of the second set have
    /// the numbers after those of the first.
    ReportView(const DetectRequest& request, const InputSet& first, const InputSet* second);

    /// Adds collisions. Only the first 200,000 are kept.
    void add(std::span<const Pair> pairs, std::span<const Finding> findings);
    /// Returns the page, compressed by gzip and in base64. Empty if it would be too large.
    std::string page() const;

private:
    const DetectRequest& request_;
    const InputSet& first_;
    const InputSet* second_;
    std::vector<Pair> pairs_;
    std::vector<Finding> findings_;
};

}  // namespace octopair::cli
