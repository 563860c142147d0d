#include "cli/input/input_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <system_error>

#include "cli/input/isolated_read.hpp"
#include "io/boxes/npy.hpp"
#include "io/formats/format_choice.hpp"

namespace octopair::cli {

Objects InputSet::frame(std::uint64_t f) const {
    Objects objects = scene.frame(scene.moving ? f : 0);
    objects.padding = padding;
    return objects;
}

Objects InputSet::frame_slice(std::uint64_t f, const SliceNumber& number) const {
    Objects objects = frame(f);
    const auto first = std::size_t(number.begin(total)), count = std::size_t(number.end(total)) - first;
    std::visit([&](auto& boxes) { boxes = boxes.subspan(first, count); }, objects.boxes);
    if (!objects.padding.empty()) objects.padding = objects.padding.subspan(first, count);
    return objects;
}

Box3d InputSet::bounds() const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    std::visit(
        [&](const auto& boxes) {
            for (const auto& box : boxes.span()) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    bounds.min[axis] = std::min(bounds.min[axis], double(box.min[axis]));
                    bounds.max[axis] = std::max(bounds.max[axis], double(box.max[axis]));
                }
            }
        },
        scene.boxes);
    return bounds;
}

std::optional<InputSet::InvalidBox> InputSet::find_invalid_box() const {
    scene.check_mapped();
    const auto fault = io::find_invalid_box(scene);
    if (!fault) return std::nullopt;
    const std::string frame = scene.moving ? fmt::format("frame {}: ", fault->frame) : "";
    const std::uint64_t position = fault->frame * total + begin + fault->object;
    std::uint64_t object = begin + fault->object;
    for (const Part& part : parts) {
        if (object < part.objects)
            return InvalidBox{position, fmt::format("{}: {}object {}: {}", part.path, frame, object, fault->what)};
        object -= part.objects;
    }
    return std::nullopt;
}

namespace {

io::LoadedScene read_part(const std::string& path, const io::SceneContent& content, const std::stop_token& stop) {
    // Most mesh files need an importer, which may crash. JSON scenes may name mesh files.
    if (!content.reader.command.empty()) return io::read_scene(path, content, stop);
    const bool isolated = io::is_imported_file(path) || io::is_json_file(path);
    return isolated ? read_isolated(path, content, stop) : io::read_scene(path, content, stop);
}

Part part_of(const std::string& path, const io::LoadedScene& scene) {
    const bool converted = !scene.converted_from.empty();
    return {path,
            scene.objects,
            scene.shapes || io::is_mesh_file(path) || io::is_json_file(path),
            converted ? scene.converted_from : scene.space.unit,
            scene.converted_from,
            scene.project,
            scene.root};
}

/// A file from which a range of objects can be read. Only .npy files are read in part; others are read whole.
class PartFile {
public:
    PartFile(const std::string& path, const io::SceneContent& content, const std::stop_token& stop) {
        if (content.reader.command.empty() && io::is_npy_file(path)) {
            io::check_readable(path);
            npy_.emplace(path);
        } else {
            whole_ = read_part(path, content, stop);
        }
    }

    Part part(const std::string& path) const {
        return npy_ ? Part{path, npy_->shape().objects} : part_of(path, whole_);
    }
    const std::string& unit() const { return whole_.space.unit; }
    std::uint64_t objects() const { return npy_ ? npy_->shape().objects : whole_.objects; }
    bool wide() const { return npy_ ? npy_->wide() : std::holds_alternative<Buffer<Box3d>>(whole_.boxes); }
    std::vector<std::string> take_names() { return std::move(whole_.names); }

    io::LoadedScene read(const io::ObjectRows& rows, const std::stop_token& stop) {
        if (npy_) return npy_->read(rows, stop);
        io::LoadedScene part = std::move(whole_);
        part.details = {};  // a slice has no details and no relations of objects
        part.relations = {};
        const std::uint64_t objects = std::exchange(part.objects, rows.end - rows.begin);
        std::visit(
            [&](auto& boxes) {
                std::remove_reference_t<decltype(boxes)> some(std::size_t(part.frames * part.objects));
                for (std::uint64_t frame = 0; frame < part.frames; ++frame) {
                    std::copy_n(boxes.data() + frame * objects + rows.begin, part.objects,
                                some.data() + frame * part.objects);
                }
                boxes = std::move(some);
            },
            part.boxes);
        return part;
    }

private:
    std::optional<io::NpyScene> npy_;
    io::LoadedScene whole_;
};

/// Returns, for the progress, the start of each file in the sequence of all files: 1 + the bytes of the files before. The last element is
/// the end. A file of unknown size counts as 0 bytes.
std::vector<double> bytes_before(const std::vector<std::string>& paths) {
    std::vector<double> before = {1};
    for (const std::string& path : paths) {
        std::error_code error;
        const std::uintmax_t bytes = std::filesystem::file_size(path, error);
        before.push_back(before.back() + (error ? 0.0 : double(bytes)));
    }
    return before;
}

}  // namespace

InputSet read_input_set(const std::vector<std::string>& paths, const io::SceneContent& content,
                        const std::stop_token& stop) {
    InputSet set;
    std::vector<io::LoadedScene> scenes;
    io::SceneContent wanted = content;
    wanted.shapes |= std::any_of(paths.begin(), paths.end(), io::is_json_file);
    const std::vector<double> before = bytes_before(paths);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const std::string& path = paths[i];
        if (content.progress) {
            wanted.progress = [&, i](double done) {
                content.progress((before[i] + done * (before[i + 1] - before[i])) / before.back());
            };
        }
        scenes.push_back(read_part(path, wanted, stop));
        set.parts.push_back(part_of(path, scenes.back()));
        if (wanted.unit.empty()) wanted.unit = scenes.back().space.unit;
    }
    std::set<io::UpAxis> axes;
    for (const io::LoadedScene& scene : scenes) axes.insert(scene.space.up);
    axes.erase(io::UpAxis::unknown);
    set.mixed_axes = axes.size() > 1;
    set.scene = io::join_scenes(scenes, paths);
    set.total = set.scene.objects;
    return set;
}

InputSet read_input_slice(const std::vector<std::string>& paths, const io::SceneContent& content,
                          const SliceRequest& wanted, const std::stop_token& stop) {
    InputSet set;
    std::vector<PartFile> files;
    bool wide = false;
    std::vector<std::string> names;
    io::SceneContent in_unit = content;
    for (const std::string& path : paths) {
        files.emplace_back(path, in_unit, stop);
        if (in_unit.unit.empty()) in_unit.unit = files.back().unit();
        set.parts.push_back(files.back().part(path));
        wide |= files.back().wide();
        const std::vector<std::string> part_names = files.back().take_names();
        if (!part_names.empty()) names.resize(std::size_t(set.total));
        names.insert(names.end(), part_names.begin(), part_names.end());
        set.total += files.back().objects();
    }
    set.begin = wanted.number.begin(set.total);
    const std::uint64_t end = wanted.number.end(set.total);
    std::vector<io::LoadedScene> scenes;
    std::uint64_t before = 0;
    for (PartFile& file : files) {
        const std::uint64_t objects = file.objects();
        const auto row = [&](std::uint64_t object) { return std::clamp(object, before, before + objects) - before; };
        const io::ObjectRows rows{row(set.begin), row(end)};
        scenes.push_back(file.read(rows, stop));
        before += objects;
    }
    set.scene = io::join_scenes(scenes, paths, wide);
    if (wanted.names && !names.empty()) names.resize(std::size_t(set.total));
    set.scene.names = wanted.names ? std::move(names) : std::vector<std::string>();
    return set;
}

}  // namespace octopair::cli
