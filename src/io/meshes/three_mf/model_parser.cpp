#include "io/meshes/three_mf/model_parser.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/three_mf/attributes.hpp"
#include "io/meshes/three_mf/package.hpp"

namespace octopair::io::three_mf {

namespace {

constexpr std::array<std::string_view, 5> type_names = {"model", "support", "solidsupport", "surface", "other"};
constexpr std::array<std::string_view, 6> unit_names = {"micron", "millimeter", "centimeter", "inch", "foot", "meter"};

std::string text_or_empty(const char* text) { return text == nullptr ? std::string() : text; }

}  // namespace

/// Allowed element within another element, and the action when the element begins.
struct ModelParser::Rule {
    Place within;
    std::string_view name;
    Place place;
    void (ModelParser::*begin)(const XmlTag&);
};

const ModelParser::Rule* ModelParser::rule_for(Place within, std::string_view name) {
    static constexpr auto rules = std::to_array<Rule>({
        {Place::vertices, "vertex", Place::skipped, &ModelParser::begin_vertex},
        {Place::triangles, "triangle", Place::skipped, &ModelParser::begin_triangle},
        {Place::document, "model", Place::model, &ModelParser::begin_model},
        {Place::model, "metadata", Place::skipped, nullptr},
        {Place::model, "resources", Place::resources, &ModelParser::begin_resources},
        {Place::model, "build", Place::build, &ModelParser::begin_build},
        {Place::resources, "basematerials", Place::base_materials, &ModelParser::begin_materials},
        {Place::base_materials, "base", Place::skipped, &ModelParser::begin_base},
        {Place::resources, "object", Place::object, &ModelParser::begin_object},
        {Place::object, "metadatagroup", Place::skipped, nullptr},
        {Place::object, "mesh", Place::mesh, &ModelParser::begin_mesh},
        {Place::object, "components", Place::components, &ModelParser::begin_components},
        {Place::mesh, "vertices", Place::vertices, &ModelParser::begin_vertices},
        {Place::mesh, "triangles", Place::triangles, &ModelParser::begin_triangles},
        {Place::components, "component", Place::skipped, &ModelParser::begin_component},
        {Place::build, "item", Place::item, &ModelParser::begin_item},
        {Place::item, "metadatagroup", Place::skipped, nullptr},
    });
    const auto found = std::find_if(rules.begin(), rules.end(),
                                    [&](const Rule& rule) { return rule.within == within && rule.name == name; });
    return found == rules.end() ? nullptr : &*found;
}

ModelParser::ModelParser(ModelPart& part, const std::string& place, const PartReading& reading)
    : part_(part), reading_(reading), parser_(place, *this, XmlParser::Mode::strict), mesh_(reading.budget) {}

void ModelParser::parse(const TextSource& source) {
    source([this](std::string_view piece) {
        parser_.parse(piece);
        return true;
    });
    parser_.finish();
    if (!has_build_ && reading_.is_root)
        refuse(parser_.place(), "has no <build>, which lists the objects; write the file again");
    name_materials();
}

void ModelParser::prefix(std::string_view prefix, std::string_view uri) {
    if (places_.back() == Place::document) prefixes_.insert_or_assign(std::string(prefix), std::string(uri));
}

void ModelParser::begin(const XmlTag& element) {
    if (++elements_ % 1024 == 0) reading_.budget.checkpoint();
    const Place within = places_.back();
    places_.push_back(within == Place::skipped ? Place::skipped : enter(within, element));
}

ModelParser::Place ModelParser::enter(Place within, const XmlTag& element) {
    const XmlName& name = element.name();
    if (within != Place::document && name.space != core_) {
        note_extension(within, element);
        return Place::skipped;
    }
    const Rule* const rule = rule_for(within, name.local);
    if (rule == nullptr) {
        if (within == Place::document) refuse_at(parser_, "does not begin with <model>; it is no model of 3MF");
        note(part_.unknown_elements, fmt::format("<{}>", shown_text(name.local)));
        return Place::skipped;
    }
    if (rule->begin != nullptr) (this->*rule->begin)(element);
    return rule->place;
}

void ModelParser::note_extension(Place within, const XmlTag& element) {
    const XmlName& name = element.name();
    if (within == Place::resources) {
        const char* const id = element.find("id");
        reading_.budget.charge(1, 8 * sizeof(void*));
        if (const auto number = id == nullptr ? std::nullopt : parse_whole_number(id)) other_groups_.insert(*number);
    }
    const bool in_object = within == Place::object || within == Place::mesh;
    if (!in_object || is_harmless_space(name.space) || !object().extension.empty()) return;
    object().extension = fmt::format("<{}> of {}", shown_text(name.local), shown_space(name.space));
}

void ModelParser::end() {
    const Place place = places_.back();
    places_.pop_back();
    if (place == Place::mesh) finish_mesh();
    if (place == Place::object) finish_object();
}

void ModelParser::begin_model(const XmlTag& element) {
    core_ = element.name().space;
    if (!is_core_space(core_)) {
        refuse_at(parser_,
                  fmt::format("is of the namespace {}; octopair reads 3MF core 2015/02: write the file as this",
                              shown_space(core_)));
    }
    part_.version = version_in(core_);
    const char* const unit = element.find("unit");
    part_.unit = unit == nullptr ? "millimeter" : trimmed(unit);
    if (std::find(unit_names.begin(), unit_names.end(), part_.unit) == unit_names.end()) {
        refuse_at(parser_,
                  fmt::format("the unit is '{}', not one of {}", shown(part_.unit), fmt::join(unit_names, ", ")));
    }
    const char* const required = element.find("requiredextensions");
    if (required == nullptr) return;
    const std::string place = fmt::format("{}: line {}", parser_.place(), parser_.line());
    part_.needs_slices = check_required_extensions(required, prefixes_, place).contains(std::string(slice_space));
}

void ModelParser::begin_resources(const XmlTag&) { refuse_second(has_resources_, "<resources>"); }

void ModelParser::begin_build(const XmlTag&) { refuse_second(has_build_, "<build>"); }

void ModelParser::begin_item(const XmlTag& element) {
    if (!reading_.is_root) return;
    reading_.budget.charge(1, sizeof(Reference));
    Reference item = reference(element, "item");
    item.part_number = text_or_empty(element.find("partnumber"));
    part_.items.push_back(std::move(item));
}

void ModelParser::begin_materials(const XmlTag& element) {
    reading_.budget.charge(1, sizeof(std::vector<std::string>) + 8 * sizeof(void*));
    group_ = &materials_[new_identifier(element)];
}

void ModelParser::begin_base(const XmlTag& element) {
    std::string name = text_or_empty(element.find("name"));
    reading_.budget.charge(1, sizeof(std::string) + name.size());
    group_->push_back(std::move(name));
}

void ModelParser::begin_object(const XmlTag& element) {
    const std::uint32_t id = new_identifier(element);
    ModelObject next;
    next.id = id;
    next.line = parser_.line();
    next.name = text_or_empty(element.find("name"));
    next.part_number = text_or_empty(element.find("partnumber"));
    reading_.budget.charge(1, sizeof(ModelObject) + next.name.size() + next.part_number.size());
    if (const char* const type = element.find("type")) {
        const auto found = std::find(type_names.begin(), type_names.end(), trimmed(type));
        if (found == type_names.end()) {
            refuse_at(parser_, fmt::format("object {}: the type is '{}', not one of {}", id, shown(type),
                                           fmt::join(type_names, ", ")));
        }
        next.type = ObjectType(found - type_names.begin());
    }
    for (const XmlName& name : {XmlName{slice_space, "meshresolution"}, XmlName{production_space, "modelresolution"},
                                XmlName{alternatives_space, "modelresolution"}}) {
        const char* const resolution = element.find(name);
        next.is_coarse |= resolution != nullptr && trimmed(resolution) != "fullres";
    }
    const char *const group = element.find("pid"), *const index = element.find("pindex");
    own_property_.reset();
    if (group != nullptr) {
        const auto group_id = parse_whole_number(group), number = parse_whole_number(index == nullptr ? "0" : index);
        if (group_id && number) own_property_.emplace(*group_id, *number);
    }
    part_.objects.push_back(std::move(next));
    properties_.emplace_back();
}

void ModelParser::begin_mesh(const XmlTag&) {
    if (object().has_components)
        refuse_at(parser_, fmt::format("object {} has components and a mesh; divide it into two objects", object().id));
    refuse_second(object().has_mesh, "<mesh>");
    has_vertices_ = has_triangles_ = false;
    mesh_.begin(own_property_);
}

void ModelParser::begin_vertices(const XmlTag&) { refuse_second(has_vertices_, "<vertices>"); }

void ModelParser::begin_triangles(const XmlTag&) { refuse_second(has_triangles_, "<triangles>"); }

void ModelParser::begin_vertex(const XmlTag& element) { mesh_.add_vertex(element, parser_); }

void ModelParser::begin_triangle(const XmlTag& element) {
    if (!mesh_.add_triangle(element, parser_)) note(part_.flat_triangles, {});
}

void ModelParser::begin_components(const XmlTag&) {
    if (object().has_mesh)
        refuse_at(parser_, fmt::format("object {} has components and a mesh; divide it into two objects", object().id));
    refuse_second(object().has_components, "<components>");
}

void ModelParser::begin_component(const XmlTag& element) {
    reading_.budget.charge(1, sizeof(Reference));
    Reference component = reference(element, "component");
    check_component(component);
    object().components.push_back(std::move(component));
}

void ModelParser::finish_mesh() {
    object().mesh = mesh_.take();
    properties_.back() = mesh_.properties();
}

void ModelParser::finish_object() { part_.numbers.emplace(object().id, part_.objects.size() - 1); }

std::uint32_t ModelParser::identifier(const XmlTag& element, std::string_view key) const {
    const char* const text = element.find(key);
    if (text == nullptr) refuse_at(parser_, fmt::format("<{}> has no {}", element.name().local, key));
    const auto number = parse_whole_number(text);
    if (!number) {
        refuse_at(parser_, fmt::format("<{}>: {} is '{}', not a whole number below 2^31", element.name().local, key,
                                       shown(text)));
    }
    return *number;
}

/// Returns the identifier of a resource. Refuses an identifier that another resource has.
std::uint32_t ModelParser::new_identifier(const XmlTag& element) {
    const std::uint32_t id = identifier(element, "id");
    const auto [line, is_new] = lines_.try_emplace(id, parser_.line());
    if (is_new) return id;
    refuse_at(parser_,
              fmt::format("the id {} is that of the resource in line {}, too; give each its own id", id, line->second));
}

Reference ModelParser::reference(const XmlTag& element, std::string_view kind) {
    Reference to;
    to.object = identifier(element, "objectid");
    to.line = parser_.line();
    if (const char* const text = element.find("transform")) {
        const auto pose = parse_matrix(text);
        if (!pose) {
            refuse_at(parser_, fmt::format("{}: the transform is '{}', not 12 numbers within the range of float64",
                                           kind, shown(text)));
        }
        to.pose = *pose;
    }
    if (const char* const path = element.find(XmlName{production_space, "path"})) {
        if (!reading_.is_root)
            refuse_at(parser_, fmt::format("{}: only the start part may refer to other parts (path)", kind));
        const std::string name = part_name(path);
        if (!is_same_part(name, part_.name)) to.part = name;
        reading_.budget.charge(1, name.size());
    }
    return to;
}

/// Refuses a component that refers to an object after it. So no object can contain itself.
void ModelParser::check_component(const Reference& component) const {
    if (!component.part.empty() || part_.numbers.contains(component.object)) return;
    const std::uint32_t own = part_.objects.back().id;
    if (component.object == own) {
        refuse_at(parser_, fmt::format("object {} has itself as a component; remove this component", own));
    }
    refuse_at(parser_, fmt::format("object {} has object {} as a component, which is not defined before it; write the "
                                   "object before those that it is in",
                                   own, component.object));
}

void ModelParser::refuse_second(bool& has, std::string_view what) {
    if (has) refuse_at(parser_, fmt::format("has a second {}; only one is allowed here", what));
    has = true;
}

void ModelParser::note(CountedNote& to, std::string_view what) const {
    if (to.count++ > 0) return;
    to.first =
        what.empty() ? fmt::format("in line {}", parser_.line()) : fmt::format("{} in line {}", what, parser_.line());
}

void ModelParser::name_materials() {
    for (std::size_t i = 0; i < part_.objects.size(); ++i) {
        for (const auto& [id, index] : properties_[i]) {
            const auto group = materials_.find(id);
            if (group != materials_.end() && index < group->second.size()) {
                if (!group->second[index].empty()) part_.objects[i].mesh.materials.insert(group->second[index]);
            } else if (group != materials_.end() || !other_groups_.contains(id)) {
                CountedNote& to = part_.unknown_materials;
                if (to.count++ == 0)
                    to.first = fmt::format("object {} in line {}", part_.objects[i].id, part_.objects[i].line);
            }
        }
    }
}

}  // namespace octopair::io::three_mf
