#include "io/pair_rows.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>

#include <fmt/format.h>

#include "io/json_text.hpp"

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
        line_.clear();
        fmt::format_to(std::back_inserter(line_), "{{{}\"a\":{},\"b\":{}", begin, pair.a, pair.b);
        append_name("a_name", names_.a, pair.a);
        append_name("b_name", names_.b, pair.b);
        line_ += "}\n";
        out.write(line_);
    }
}

void JsonlRows::append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object) {
    if (names == nullptr || names->empty() || (*names)[object].empty()) return;
    fmt::format_to(std::back_inserter(line_), ",\"{}\":{}", key, json_string((*names)[object]));
}

}  // namespace octopair::io
