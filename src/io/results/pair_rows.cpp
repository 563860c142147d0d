#include "io/results/pair_rows.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "io/json/json_text.hpp"

namespace octopair::io {

namespace {

char* put_number(char* at, std::uint32_t number) { return std::to_chars(at, at + 10, number).ptr; }

}  // namespace

void write_csv_rows(OutputStream& out, std::string_view begin, std::span<const Pair> pairs) {
    for (const Pair pair : pairs) {
        char* const row = out.room(begin.size() + 32);
        char* at = put_number(std::copy(begin.begin(), begin.end(), row), pair.a);
        *at++ = ',';
        at = put_number(at, pair.b);
        *at++ = '\n';
        out.advance(std::size_t(at - row));
    }
}

void JsonlRows::write(OutputStream& out, std::string_view begin, std::span<const Pair> pairs) {
    for (const Pair pair : pairs) {
        line_ = '{';
        line_ += begin;
        append_number("\"a\":", pair.a);
        append_number(",\"b\":", pair.b);
        append_name("a_name", names_.a, pair.a);
        append_name("b_name", names_.b, pair.b);
        line_ += "}\n";
        out.write(line_);
    }
}

void JsonlRows::append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object) {
    if (names == nullptr || names->empty() || (*names)[object].empty()) return;
    line_ += fmt::format(",\"{}\":{}", key, json_string((*names)[object]));
}

void JsonlRows::append_number(std::string_view before, std::uint32_t number) {
    char digits[10];
    line_ += before;
    line_.append(digits, put_number(digits, number));
}

}  // namespace octopair::io
