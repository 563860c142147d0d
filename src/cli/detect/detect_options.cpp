#include "cli/detect/detect_options.hpp"

#include <string>

#include "cli/command/command.hpp"
#include "cli/command/numbers.hpp"
#include "cli/command/words.hpp"

namespace octopair::cli {

void add_scene_options(Command& command, DetectRequest& request) {
    command
        .add_option("INPUT", request.inputs, "scene files: .npy, .csv, .json or mesh files; several files form one set")
        .required();
    command.add_option("--against", request.against, "find only pairs of an object a of INPUT and an object b of FILE")
        .type_name("FILE");
    command
        .add_option(
            "--objects",
            [&request](const std::string& word) {
                check_word({"--objects", {"node", "triangle"}, {}}, word);
                request.mesh_objects = word == "node" ? io::MeshObjects::node : io::MeshObjects::triangle;
            },
            "objects of a mesh file: node (default; nodes with meshes) or triangle")
        .type_name("WHAT");
    command
        .add_option(
            "--margin", [&request](const std::string& text) { request.margin = parse_length("--margin", text); },
            "largest gap per axis at which two boxes still form a pair (default 0)")
        .type_name("M");
    command.add_option("--padding", request.padding, "clearance of each object: an array of shape (n,)")
        .type_name("FILE.npy");
}

void add_order_options(Command& command, DetectRequest& request, const std::string& limited) {
    command
        .add_option(
            "--order",
            [&request](const std::string& word) {
                check_word({"--order", {"ascending", "octal"}, {}}, word);
                request.order = word == "octal" ? Order::octal : Order::ascending;
            },
            "order of the pairs: ascending (default) or octal")
        .type_name("ORDER");
    command
        .add_option(
            "--limit", [&request](const std::string& text) { request.limit = parse_count("--limit", text); }, limited)
        .type_name("N");
}

}  // namespace octopair::cli
