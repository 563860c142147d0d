#include "cli/detect/detect_options.hpp"

#include <string>

#include "cli/command/command.hpp"
#include "cli/command/numbers.hpp"
#include "cli/command/words.hpp"

namespace octopair::cli {

void add_scene_options(Command& command, DetectRequest& request) {
    command.add_option("INPUT", request.inputs, "scene files: .npy, .csv, .json or a mesh scene; several are one set")
        .required();
    command.add_option("--against", request.against, "only pairs (a in INPUT, b in FILE)").type_name("FILE");
    command
        .add_option(
            "--objects",
            [&request](const std::string& word) {
                check_word({"--objects", {"node", "triangle"}, {}}, word);
                request.mesh_objects = word == "node" ? io::MeshObjects::node : io::MeshObjects::triangle;
            },
            "what counts as one object of a mesh file: node (default) or triangle")
        .type_name("WHAT");
    command
        .add_option(
            "--margin", [&request](const std::string& text) { request.margin = parse_length("--margin", text); },
            "pairs count up to a gap of M on every axis (default 0)")
        .type_name("M");
    command.add_option("--padding", request.padding, "shape (n,): each object's own clearance").type_name("FILE.npy");
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
