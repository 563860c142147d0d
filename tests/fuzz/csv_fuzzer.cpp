// Fuzzes the .csv reader. The reader returns at most one box per line, or one line that describes the error.
#include <algorithm>
#include <cstdint>

#include "fuzz/require.hpp"
#include "io/boxes/csv.hpp"

using namespace octopair;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    fuzz::require_clear_errors({.begin = "f.csv: line "}, [&] {
        const auto boxes = io::parse_csv_boxes(text, "f.csv");
        require(boxes.size() <= std::size_t(std::count(text.begin(), text.end(), '\n')) + 1);
    });
    return 0;
}
