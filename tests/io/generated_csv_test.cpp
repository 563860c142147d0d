// Tests the reader of boxes in CSV with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "io/boxes/csv.hpp"
#include "io/spelling.hpp"

namespace octopair::test {
namespace {

/// A random CSV file: its text, and what it says.
struct CsvFile {
    Spelling spelling;
    std::string text;
    std::vector<double> numbers;  ///< six of each box

    explicit CsvFile(std::uint64_t seed) : spelling(seed) {
        text = spelling.byte_order_mark();
        if (spelling.one_in(2)) write_header();
        for (std::uint64_t rows = spelling.below(8); rows > 0; --rows) write_row();
        if (spelling.one_in(2) && text.ends_with(spelling.line_end()))
            text.resize(text.size() - spelling.line_end().size());
    }

    void write_header() {
        const std::string name = spelling.pick({"minx", "min x", "\"min x\"", "\"x, least\"", "#x", "x1", "", "none"});
        for (int column = 0; column < 5; ++column) text += name + ",";
        text += "last" + spelling.line_end();
    }

    void write_row() {
        const bool quoted = spelling.one_in(4);
        for (int column = 0; column < 6; ++column) {
            SpelledNumber number = spelling.spelled();
            if (spelling.one_in(8)) number = {spelling.pick({"inf", "INF", "-Infinity"}), 0};
            if (number.value == 0) number.value = std::strtod(number.text.c_str(), nullptr);
            if (spelling.one_in(4)) std::replace(number.text.begin(), number.text.end(), 'e', 'D');
            const char* quote = quoted || spelling.one_in(8) ? "\"" : "";
            text += spelling.indent() + quote + number.text + quote + spelling.indent() + (column < 5 ? "," : "");
            numbers.push_back(number.value);
        }
        text += spelling.line_end();
        while (spelling.one_in(6)) text += spelling.indent() + spelling.line_end();
    }
};

TEST(GeneratedFiles, OfCsvAreReadAsTheyAreWritten) {
    for (std::uint64_t i = 0; i < generated_files(); ++i) {
        const std::uint64_t seed = case_seed("csv", i);
        CsvFile file(seed);
        const Buffer<Box3d> boxes = io::parse_csv_boxes(file.text, "m.csv");
        ASSERT_EQ(boxes.size() * 6, file.numbers.size()) << repetition(seed, file.text);
        ASSERT_TRUE(boxes.size() == 0 ||
                    std::memcmp(boxes.data(), file.numbers.data(), sizeof(Box3d) * boxes.size()) == 0)
            << repetition(seed, file.text);

        const std::string mutated = file.spelling.mutated(file.text);
        const std::string fault = fault_of_reading("m.csv: ", [&]() -> std::string {
            (void)io::parse_csv_boxes(mutated, "m.csv");
            return "";
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
