#include "cli/detect/rank_group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/checksum.hpp"
#include "base/timed.hpp"
#include "cli/input/search_inputs.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/exclusion_rules.hpp"
#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

constexpr std::array<std::string_view, 6> options_of_inputs = {"INPUT",     "--against",  "--padding",
                                                               "--exclude", "--baseline", "--statuses"};
constexpr std::array<std::string_view, 2> options_of_a_rank = {"--threads", "--quiet"};

bool contains(std::span<const std::string_view> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Part of a sequence of bytes.
struct ByteRange {
    std::uint64_t begin, size;
};

/// Returns the parts of `bytes` bytes of data that the ranks compare. `all`: everything. Otherwise, of large data, only 1,024 evenly
/// spread blocks with the first and the last byte.
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

/// Returns facts about the inputs: objects, frames and precision of each set, and size and hash of each file. The hash is of 1,024
/// evenly spread blocks; with --verify, of the whole file. The boxes of shapes are hashed, too, because a scene file may name mesh
/// files that differ between ranks.
/// Requires: the inputs were read. Throws: Error{io_failed, bad_input, cancelled}.
Facts input_facts(const DetectRun& run) {
    const DetectRequest& request = run.request;
    Facts facts;
    add_set(facts, "INPUT", run.inputs.first, run);
    if (run.join()) add_set(facts, "--against", run.inputs.second, run);
    for (std::size_t i = 0; i < request.inputs.size(); ++i)
        add_file(facts, fmt::format("input {}", i + 1), request.inputs[i], run);
    add_file(facts, "--against", request.against, run);
    add_file(facts, "--padding", request.padding, run);
    if (!io::relation_rules(request.pipeline.exclude)) add_file(facts, "--exclude", request.pipeline.exclude, run);
    add_file(facts, "--baseline", request.pipeline.baseline, run);
    return facts;
}

/// Reads this rank's slice of each set.
void read_slices(DetectRun& run, const Cluster& cluster) {
    const DetectRequest& request = run.request;
    const SliceRequest slice{own_slice(cluster), cluster.first()};
    InputSet &first = run.inputs.first, &second = run.inputs.second;
    first = read_input_slice(request.inputs, {.objects = request.mesh_objects, .reader = reader_of(request)}, slice,
                             run.stop);
    if (run.join()) {
        second = read_input_slice(
            {request.against},
            {.objects = request.mesh_objects, .unit = first.scene.space.unit, .reader = reader_of(request)}, slice,
            run.stop);
    }
    run.inputs.frames =
        joint_frames({first.scene.frames, first.scene.moving}, {second.scene.frames, second.scene.moving}, request);
    run.inputs.padding.emplace(request, SetSizes{first.total, second.total}, run.stop);
    const auto own = [](std::span<const double> all, const InputSet& set) {
        return all.empty() ? all : all.subspan(set.begin, set.scene.objects);
    };
    first.padding = own(run.inputs.padding->inputs(), first);
    second.padding = own(run.inputs.padding->against(), second);
}

class RankGroup final : public SearchGroup {
public:
    explicit RankGroup(Cluster& cluster) : cluster_(cluster) {}

    Group& processes() override { return cluster_; }

    void read_inputs(DetectRun& run) override {
        if (needs_whole_inputs(run.request)) return run.inputs.read(run.request, run.progress, run.stop);
        read_slices(run, cluster_);
    }

    void check_objects(DetectRun& run) override {
        run.report.engine.ranks = cluster_.ranks();
        if (!has_wide_indices(run)) return;
        const std::string objects = std::to_string(run.report.objects) + " objects: ";
        if (run.request.verify) throw Error(ErrorCode::resource_limit, objects + "--verify has indices of 32 bits");
        if (has_filters(run.request))
            throw Error(ErrorCode::resource_limit, objects + "filters have indices of 32 bits");
        if (!io::is_array_file(run.request.output) && !run.request.count_only) {
            throw Error(ErrorCode::resource_limit, objects + "indices of 64 bits go to .npy files alone");
        }
    }

    void compare_inputs(DetectRun& run) override {
        const Timed timed(run.report.seconds.read);
        Facts facts;
        cluster_.together([&] { facts = input_facts(run); });
        cluster_.require_same(facts);
    }

    std::unique_ptr<FrameSearch> make_search(DetectRun& run) override { return make_ranked_search(run, cluster_); }

private:
    Cluster& cluster_;
};

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

bool has_wide_indices(const DetectRun& run) {
    return run.request.wide_indices || run.report.objects > std::numeric_limits<std::uint32_t>::max();
}

bool needs_whole_inputs(const DetectRequest& request) {
    return has_filters(request) || request.verify || io::is_json_file(request.against) ||
           std::any_of(request.inputs.begin(), request.inputs.end(), io::is_json_file);
}

SliceNumber own_slice(const Cluster& cluster) { return {cluster.rank(), cluster.ranks()}; }

std::unique_ptr<SearchGroup> ranks_of(Cluster& cluster) { return std::make_unique<RankGroup>(cluster); }

}  // namespace octopair::cli
