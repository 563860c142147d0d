// Fuzzes the reader of older results. If no collision is new, all rows count as gone. Otherwise one line describes the
// error.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "io/results/baseline.hpp"
#include "octopair/error.hpp"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace octopair;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(bytes + 1), size - 1);
    try {
        io::Baseline baseline = io::Baseline::of_text(text, "f.jsonl", bytes[0] % 2 == 1);
        const std::size_t rows = baseline.gone().size();
        require(rows <= std::size_t(std::count(text.begin(), text.end(), '\n')) + 1);
        const Pair pairs[] = {{0, 1}, {0, 5}};
        const auto changes = baseline.compare(pairs, {}, {});
        const auto same = std::size_t(std::count(changes.begin(), changes.end(), io::Change::same));
        require(changes.size() == 2 && baseline.gone().size() + same == rows && baseline.counts().same == same);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        const std::string_view words = error.what();
        require(words.starts_with("f.jsonl: line "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
