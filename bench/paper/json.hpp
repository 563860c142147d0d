// Study as JSON (docs/formats.md): every measured time, and derived quantities.
#pragma once

#include <string>

#include "paper/study.hpp"

namespace octopair::paper {

/// Returns one JSON object, ended by a newline.
std::string study_json(const Study& study);

}  // namespace octopair::paper
