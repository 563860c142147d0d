// Fuzzes the reader of exclusion rules. The reader returns rules, or one line that describes the error.
#include <cstdint>

#include "fuzz/require.hpp"
#include "io/json/exclusion_rules.hpp"

using namespace octopair;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    fuzz::require_clear_errors({.begin = "r.json: "}, [&] {
        const io::ExclusionRules rules = io::parse_exclusion_rules(text, "r.json");
        require(rules.exclude.size() + rules.ignored_pairs.size() <= size);
    });
    return 0;
}
