// Patterns that names fit: `*` stands for any characters, none as well, `?` for one, every other for itself. Characters are
// those of UTF-8; what is not UTF-8 counts by bytes.
#pragma once

#include <string_view>

namespace octopair {

/// Takes up to |name| * |pattern| steps.
bool fits(std::string_view name, std::string_view pattern);

}  // namespace octopair
