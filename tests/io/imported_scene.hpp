// Reads the text of a mesh scene, as `octopair detect` does.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/scene_reader.hpp"
#include "io/temporary.hpp"

namespace octopair::test {

/// The objects of a scene: names without the node of the file, and boxes.
struct ImportedScene {
    std::multimap<std::string, Box3d> objects;
    std::vector<std::string> warnings;  ///< but for the one that Assimp reads the format
    std::vector<std::string> not_read;
};

inline ImportedScene import_text(const std::string& ending, const std::string& text) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("scene" + ending);
    write_file(path, text);
    const io::LoadedScene loaded = io::read_scene(path, {io::MeshObjects::node});
    ImportedScene scene;
    const auto& boxes = std::get<Buffer<Box3d>>(loaded.boxes);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const std::string& name = loaded.names[i];
        scene.objects.emplace(name.substr(name.rfind('/') + 1), boxes[i]);
    }
    for (const std::string& warning : loaded.warnings) {
        if (warning.find("does not vouch") == std::string::npos) scene.warnings.push_back(warning);
    }
    scene.not_read = loaded.not_read;
    return scene;
}

/// Returns the message of the refusal of a text, without the path of its file. Fails if the text is not refused.
inline std::string refusal_of_text(const std::string& ending, const std::string& text) {
    std::string message = error_of(ErrorCode::bad_input, [&] { (void)import_text(ending, text); });
    return message.substr(std::min(message.find(ending + ": ") + ending.size() + 2, message.size()));
}

/// Returns a box as text, "0 0 0 1 1 1", rounded to a millionth: Assimp rounds to float32.
inline std::string text_of_box(const Box3d& box) {
    std::string text;
    for (const auto* side : {&box.min, &box.max}) {
        for (const double value : *side) {
            const double rounded = std::round(value * 1e6) / 1e6;
            text += (text.empty() ? "" : " ") + fmt::format("{}", rounded == 0 ? 0 : rounded);
        }
    }
    return text;
}

/// Returns the boxes of the objects with a name as texts, in the order of the file.
inline std::vector<std::string> boxes_named(const ImportedScene& scene, const std::string& name) {
    std::vector<std::string> texts;
    const auto [begin, end] = scene.objects.equal_range(name);
    for (auto at = begin; at != end; ++at) texts.push_back(text_of_box(at->second));
    return texts;
}

}  // namespace octopair::test
