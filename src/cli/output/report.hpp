// Formats the results of a run of `octopair detect`: a summary for people, and statistics in JSON.
#pragma once

#include <string>

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// Returns the summary: several lines, each with a newline.
std::string summary_text(const DetectReport& report);

/// Returns the statistics: one JSON object (docs/formats.md) and a newline.
std::string stats_json(const DetectReport& report);

}  // namespace octopair::cli
