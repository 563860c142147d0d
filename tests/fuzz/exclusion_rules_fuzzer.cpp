// Fuzzes the reader of exclusion rules. The reader returns rules, or one line that describes the error.
#include <cstdint>
#include <cstdlib>

#include "io/json/exclusion_rules.hpp"
#include "octopair/error.hpp"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace octopair;
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    try {
        const io::ExclusionRules rules = io::parse_exclusion_rules(text, "r.json");
        require(rules.exclude.size() + rules.ignored_pairs.size() <= size);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        const std::string_view words = error.what();
        require(words.starts_with("r.json: "));
        require(words.find('\n') == std::string_view::npos);
    }
    return 0;
}
