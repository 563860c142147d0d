// What `octopair detect` says about its work: lines for people, JSON for programs.
#pragma once

#include <string>

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// A few lines, each ended.
std::string summary_text(const DetectReport& report);

/// One JSON object (docs/formats.md), ended by a newline.
std::string stats_json(const DetectReport& report);

}  // namespace octopair::cli
