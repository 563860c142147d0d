#include "io/meshes/three_mf/model.hpp"

#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/three_mf/attributes.hpp"
#include "io/meshes/three_mf/model_parser.hpp"

namespace octopair::io::three_mf {

namespace {

std::string place_of_part(std::string_view name, const ReadBudget& budget) {
    return fmt::format("{}: {}", budget.path(), shown_text(name));
}

/// Stores the version in the namespace of the first element.
class VersionHandler final : public XmlHandler {
public:
    void begin(const XmlTag& element) override {
        if (!done_) version_ = version_in(element.name().space);
        done_ = true;
    }
    void end() override {}

    bool done() const { return done_; }
    std::string take() { return std::move(version_); }

private:
    std::string version_;
    bool done_ = false;
};

}  // namespace

ModelPart parse_model_part(std::string name, const TextSource& source, const PartReading& reading) {
    ModelPart part;
    part.name = std::move(name);
    ModelParser(part, place_of_part(part.name, reading.budget), reading).parse(source);
    return part;
}

std::string parse_version(const std::string& name, const TextSource& source, ReadBudget& budget) {
    VersionHandler handler;
    XmlParser parser(place_of_part(name, budget), handler, XmlParser::Mode::strict);
    source([&](std::string_view piece) {
        parser.parse(piece);
        return !handler.done();
    });
    if (!handler.done()) parser.finish();
    return handler.take();
}

Model::Model(Package& package, const std::function<void(double)>& progress) : package_(package) {
    std::string name = package.find_start();
    const TextSource text = package.text_of(name, "the package", progress);
    parts_.push_back(parse_model_part(std::move(name), text, {true, package.budget()}));
    add_parts(start().items, progress);
    for (const ModelObject& object : start().objects) add_parts(object.components, progress);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        resolve(parts_[i].items, i);
        for (ModelObject& object : parts_[i].objects) resolve(object.components, i);
    }
}

void Model::add_parts(const std::vector<Reference>& references, const std::function<void(double)>& progress) {
    for (const Reference& from : references) {
        if (!from.part.empty() && !part_numbers_.contains(from.part)) add_part(from, progress);
    }
}

void Model::add_part(const Reference& from, const std::function<void(double)>& progress) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (!is_same_part(from.part, parts_[i].name)) continue;
        part_numbers_.emplace(from.part, i);
        return;
    }
    const TextSource text = package_.text_of(from.part, place_of(0, from.line).substr(path().size() + 2), progress);
    parts_.push_back(parse_model_part(from.part, text, {false, budget()}));
    part_numbers_.emplace(from.part, parts_.size() - 1);
    const std::string &unit = parts_.back().unit, &start_unit = start().unit;
    if (unit == start_unit) return;
    refuse(path(), fmt::format("{}: the unit is {}, but that of {} is {}; write all parts in one unit",
                               shown_text(from.part), unit, shown_text(start().name), start_unit));
}

void Model::resolve(std::vector<Reference>& references, std::size_t part) {
    for (Reference& reference : references) {
        reference.target.part = reference.part.empty() ? part : part_numbers_.at(reference.part);
        const ModelPart& of = parts_[reference.target.part];
        const auto found = of.numbers.find(reference.object);
        if (found == of.numbers.end()) {
            refuse(place_of(part, reference.line),
                   fmt::format("refers to object {}, which {} does not have; add the object, or remove this reference",
                               reference.object, shown_text(of.name)));
        }
        reference.target.number = found->second;
    }
}

std::string Model::place_of(std::size_t part, std::uint64_t line) const {
    return fmt::format("{}: {}: line {}", path(), shown_text(parts_[part].name), line);
}

std::vector<std::string> Model::warnings() const {
    std::vector<std::string> lines;
    if (package_.has_several_starts())
        lines.push_back(fmt::format("{}: has several models; only {} is read", path(), shown_text(start().name)));
    for (const ModelPart& part : parts_) {
        const auto add = [&](const CountedNote& note, std::string_view what) {
            if (note.count == 0) return;
            lines.push_back(fmt::format("{}: {}: {} {}; the first is {}", path(), shown_text(part.name), note.count,
                                        what, note.first));
        };
        add(part.flat_triangles,
            "triangles have the same vertex twice, which 3MF does not allow; they are read as flat triangles");
        add(part.unknown_elements, "elements are not those of 3MF, and are not read");
        add(part.unknown_materials, "references to materials have no material, and are left out");
    }
    return lines;
}

}  // namespace octopair::io::three_mf
