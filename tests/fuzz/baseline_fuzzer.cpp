// Fuzzes the reader of older results. If no collision is new, all rows count as gone. Otherwise one line describes the
// error.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/results/baseline.hpp"

using namespace octopair;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(bytes + 1), size - 1);
    fuzz::require_clear_errors({.begin = "f.jsonl: line ", .printable = true}, [&] {
        io::Baseline baseline = io::Baseline::of_text(text, "f.jsonl", bytes[0] % 2 == 1);
        const std::size_t rows = baseline.gone().size();
        require(rows <= std::size_t(std::count(text.begin(), text.end(), '\n')) + 1);
        const Pair pairs[] = {{0, 1}, {0, 5}};
        const auto changes = baseline.compare(pairs, {}, {});
        const auto same = std::size_t(std::count(changes.begin(), changes.end(), io::Change::same));
        require(changes.size() == 2 && baseline.gone().size() + same == rows && baseline.counts().same == same);
    });
    return 0;
}
