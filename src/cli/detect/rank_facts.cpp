#include "cli/detect/rank_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "base/checksum.hpp"
#include "io/files/input_file.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

constexpr std::array<std::string_view, 5> options_of_inputs = {"INPUT", "--against", "--padding", "--exclude",
                                                               "--baseline"};
constexpr std::array<std::string_view, 2> options_of_a_rank = {"--threads", "--quiet"};

bool contains(std::span<const std::string_view> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Part of a sequence of bytes.
struct ByteRange {
    std::uint64_t begin, size;
};

/// Returns the parts of `bytes` bytes that are compared: all, or 1,024 blocks of which the first and last are at the ends.
std::vector<ByteRange> compared_parts(std::uint64_t bytes, bool all) {
    constexpr std::uint64_t blocks = 1024, block = 4096;
    std::vector<ByteRange> parts;
    if (all || bytes <= blocks * block) {
        constexpr std::uint64_t piece = 1 << 20;
        for (std::uint64_t at = 0; at < bytes; at += piece) parts.push_back({at, std::min(piece, bytes - at)});
    } else {
        const std::uint64_t last = bytes - block;
        for (std::uint64_t i = 0; i < blocks; ++i)
            parts.push_back({last / (blocks - 1) * i + last % (blocks - 1) * i / (blocks - 1), block});
    }
    return parts;
}

std::string checksum_text(const Checksum& sum) { return fmt::format("checksum {:016x}", sum.value()); }

std::string checksum_of(const io::InputFile& file, const DetectRun& run) {
    Checksum sum;
    std::vector<std::byte> bytes;
    for (const ByteRange& part : compared_parts(file.size(), run.request.verify)) {
        bytes.resize(std::size_t(part.size));
        file.read(part.begin, bytes, run.stop);
        sum.add(bytes);
    }
    file.check_unchanged();
    return checksum_text(sum);
}

std::string checksum_of(std::span<const std::byte> bytes, bool all) {
    Checksum sum;
    for (const ByteRange& part : compared_parts(bytes.size(), all))
        sum.add(bytes.subspan(std::size_t(part.begin), std::size_t(part.size)));
    return checksum_text(sum);
}

void add_file(Facts& facts, const std::string& option, const std::string& path, const DetectRun& run) {
    if (path.empty()) return;
    const io::InputFile file(path);
    facts.push_back({"the size of " + option, fmt::format("{} bytes", file.size()), path});
    facts.push_back({"the content of " + option, checksum_of(file, run), path});
}

void add_set(Facts& facts, const std::string& option, const InputSet& set, const DetectRun& run) {
    const bool wide = std::holds_alternative<Buffer<Box3d>>(set.scene.boxes);
    facts.push_back({"the number of objects of " + option, std::to_string(set.total)});
    facts.push_back({"the number of frames of " + option,
                     set.scene.moving ? std::to_string(set.scene.frames) : std::string("no frames")});
    facts.push_back({"the precision of " + option, wide ? "float64" : "float32"});
    if (set.shaped != nullptr) {
        const auto bytes_of = [](const auto& boxes) { return std::as_bytes(boxes.span()); };
        facts.push_back(
            {"the boxes of " + option, checksum_of(std::visit(bytes_of, set.scene.boxes), run.request.verify)});
    }
}

}  // namespace

Facts option_facts(const DetectRequest& request) {
    Facts facts = {{"the program", "octopair " OCTOPAIR_VERSION}, {"the subcommand", "detect"}};
    for (const GivenOption& option : request.given) {
        if (contains(options_of_a_rank, option.name)) continue;
        const bool input = contains(options_of_inputs, option.name);
        const std::string texts = fmt::format("{}", fmt::join(option.texts, " "));
        facts.push_back(input ? Fact{option.name, fmt::format("{} given", option.texts.size()), texts}
                              : Fact{option.name, texts});
    }
    return facts;
}

Facts input_facts(const DetectRun& run) {
    const DetectRequest& request = run.request;
    Facts facts;
    add_set(facts, "INPUT", run.inputs.first, run);
    if (run.join()) add_set(facts, "--against", run.inputs.second, run);
    for (std::size_t i = 0; i < request.inputs.size(); ++i)
        add_file(facts, fmt::format("input {}", i + 1), request.inputs[i], run);
    add_file(facts, "--against", request.against, run);
    add_file(facts, "--padding", request.padding, run);
    add_file(facts, "--exclude", request.pipeline.exclude, run);
    add_file(facts, "--baseline", request.pipeline.baseline, run);
    return facts;
}

}  // namespace octopair::cli
