// A study as JSON (docs/formats.md): every time that was measured, and what follows from them.
#pragma once

#include <string>

#include "paper/study.hpp"

namespace octopair::paper {

/// One object, ended by a newline.
std::string study_json(const Study& study);

}  // namespace octopair::paper
