// Writes pairs as rows of text. All rows of a call have the same beginning, for example a frame and an event.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/results/pair_writer.hpp"

namespace octopair::io {

/// Writes rows `BEGINa,b`. `begin` includes its commas. Requires: `begin` has at most 64 characters.
void write_csv_rows(OutputStream& out, std::string_view begin, std::span<const Pair> pairs);

/// Writes rows `{BEGIN"a":0,"b":5}`, with the names of objects that have one. `begin` includes its commas.
class JsonlRows {
public:
    explicit JsonlRows(const PairNames& names) : names_(names) {}

    void write(OutputStream& out, std::string_view begin, std::span<const Pair> pairs);

private:
    void append_number(std::string_view before, std::uint32_t number);
    void append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object);

    PairNames names_;
    std::string line_;
};

}  // namespace octopair::io
