// Parses many files in one process, for near_miss_test.py.
//
//     octopair_near_miss_reader KIND FILE < records > answers
//
// A record is the length of its bytes (32 bits, little endian) and these bytes. For each record, the program writes one line: "read" and
// the values (values.hpp), or "refused" and the message. FILE is a file that it may overwrite, for parsers that open their file
// themselves. The status is 0, or 1 for wrong arguments, or 2 if a parser threw another exception than Error.
#include <sys/stat.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <span>

#include "near_miss/readers.hpp"
#include "octopair/error.hpp"

namespace octopair::test {
namespace {

struct Kind {
    std::string_view name;
    void (*read)(const NearMissFile& file, Values& values);
    bool opens_file = false;  ///< the parser opens its file itself
};

constexpr Kind kinds[] = {
    {"csv_boxes", read_csv},
    {"npy_header", read_npy},
    {"json_scene", read_json_scene},
    {"exclusion_rules", read_exclusion_rules},
    {"config_file", read_config, true},
    {"count", read_count},
    {"bytes", read_bytes},
    {"length", read_length},
#ifdef OCTOPAIR_WITH_SERVICE
    {"token_file", read_tokens, true},
    {"client_token", read_client_token, true},
    {"role_file", read_roles, true},
    {"address", read_address},
#endif
};

std::string answer_of(const Kind& kind, const NearMissFile& file) {
    Values values;
    try {
        kind.read(file, values);
        return "read" + values.line();
    } catch (const Error& error) {
        return std::string("refused ") + error.what();
    }
}

/// Returns whether there was another record.
bool next_record(std::string& content) {
    std::uint32_t length = 0;
    if (std::fread(&length, sizeof length, 1, stdin) != 1) return false;
    content.resize(length);
    return std::fread(content.data(), 1, length, stdin) == length;
}

int answer_all(const Kind& kind, const std::string& path) {
    NearMissFile file{{}, path};
    while (next_record(file.content)) {
        if (kind.opens_file) {
            std::ofstream(path, std::ios::binary) << file.content;
            ::chmod(path.c_str(), 0600);
        }
        std::string answer = answer_of(kind, file);
        for (char& c : answer) {
            if (c == '\n') c = '\v';  // the test refuses a message with this character
        }
        std::cout << answer << '\n';
    }
    return 0;
}

int run(std::span<char*> arguments) {
    if (arguments.size() != 3) return 1;
    for (const Kind& kind : kinds) {
        if (kind.name == arguments[1]) return answer_all(kind, arguments[2]);
    }
    return 1;
}

}  // namespace
}  // namespace octopair::test

int main(int count, char** arguments) {
    try {
        return octopair::test::run({arguments, std::size_t(count)});
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 2;
    }
}
