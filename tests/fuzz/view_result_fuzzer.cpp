// Fuzzes the reader of results that `octopair view` shows. The first byte chooses the format.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>

#include "fuzz/require.hpp"
#include "io/results/result_file.hpp"

namespace {

using namespace octopair;
using fuzz::require;

void check(const io::ResultFile& result) {
    require(result.frames.size() >= 1);
    for (std::uint64_t number = 0; number < std::min<std::uint64_t>(result.frames.size(), 50); ++number) {
        const io::ResultFrame frame = result.frames.frame(number);
        require(frame.findings.empty() || frame.findings.size() == frame.pairs.size());
        require(std::is_sorted(frame.pairs.begin(), frame.pairs.end()));
        require(std::adjacent_find(frame.pairs.begin(), frame.pairs.end()) == frame.pairs.end());
        for (const Pair pair : frame.pairs) require(pair.a < pair.b && pair.b < result.objects);
        for (const Finding& finding : frame.findings) {
            require(std::isfinite(finding.depth) && std::isfinite(finding.distance));
            for (const Contact& contact : finding.contacts) require(std::isfinite(contact.point[0]));
        }
    }
    for (const auto& [object, name] : result.names) require(object < result.objects);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size == 0) return 0;
    constexpr std::array endings = {".jsonl", ".csv", ".npy"};
    const std::string path = "/tmp/octopair-fuzz-" + std::to_string(::getpid()) + endings[bytes[0] % 3];
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes + 1), std::streamsize(size - 1));
    fuzz::require_clear_errors({.codes = {ErrorCode::bad_input, ErrorCode::resource_limit}}, [&] {
        if (io::is_result(path)) check(io::read_result(path, {}));
    });
    ::unlink(path.c_str());
    return 0;
}
