// Fuzzes the .csv reader. The reader returns at most one box per line, or one line that describes the error.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "io/boxes/csv.hpp"
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
        const auto boxes = io::parse_csv_boxes(text, "f.csv");
        require(boxes.size() <= std::size_t(std::count(text.begin(), text.end(), '\n')) + 1);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        const std::string_view words = error.what();
        require(words.starts_with("f.csv: line "));
        require(words.find('\n') == std::string_view::npos);
    }
    return 0;
}
