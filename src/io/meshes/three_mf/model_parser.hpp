// ModelParser: reads the XML of a part into a ModelPart.
//
// - Elements of extensions are skipped. If an element within an object may change the object's shape, the parser notes the element.
// - Elements that 3MF does not define are skipped and counted, because programs write such elements.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/meshes/three_mf/attributes.hpp"
#include "io/meshes/three_mf/mesh_builder.hpp"
#include "io/meshes/three_mf/model.hpp"
#include "io/meshes/xml/xml_parser.hpp"

namespace octopair::io::three_mf {

class ModelParser final : public XmlHandler {
public:
    /// Borrows `part`. `place`: the file and the part, for messages.
    ModelParser(ModelPart& part, const std::string& place, const PartReading& reading);

    /// Parses a text to its end, and makes the checks that need the whole part. Throws: as parse_model_part().
    void parse(const TextSource& source);

    void prefix(std::string_view prefix, std::string_view uri) override;
    void begin(const XmlTag& element) override;
    void end() override;

private:
    /// The kind of element that contains the parser's position.
    enum class Place : std::uint8_t {
        document,
        model,
        resources,
        base_materials,
        object,
        mesh,
        vertices,
        triangles,
        components,
        build,
        item,
        skipped,
    };
    struct Rule;
    static const Rule* rule_for(Place within, std::string_view name);

    /// Returns the place inside `element`, an element in `within`. Calls the action of the element's rule.
    Place enter(Place within, const XmlTag& element);
    void note_extension(Place within, const XmlTag& element);
    void begin_model(const XmlTag& element);
    void begin_resources(const XmlTag& element);
    void begin_build(const XmlTag& element);
    void begin_item(const XmlTag& element);
    void begin_materials(const XmlTag& element);
    void begin_base(const XmlTag& element);
    void begin_object(const XmlTag& element);
    void begin_mesh(const XmlTag& element);
    void begin_vertices(const XmlTag& element);
    void begin_triangles(const XmlTag& element);
    void begin_components(const XmlTag& element);
    void begin_component(const XmlTag& element);
    void begin_vertex(const XmlTag& element);
    void begin_triangle(const XmlTag& element);
    void finish_mesh();
    void finish_object();

    std::uint32_t identifier(const XmlTag& element, std::string_view key) const;
    std::uint32_t new_identifier(const XmlTag& element);
    Reference reference(const XmlTag& element, std::string_view kind);
    void check_component(const Reference& component) const;
    void refuse_second(bool& has, std::string_view what);
    void note(CountedNote& to, std::string_view what) const;
    void name_materials();
    ModelObject& object() { return part_.objects.back(); }

    ModelPart& part_;
    const PartReading reading_;
    XmlParser parser_;
    MeshBuilder mesh_;
    Prefixes prefixes_;  // prefixes of the element <model>
    std::string core_;   // namespace of 3MF in this part
    std::vector<Place> places_ = {Place::document};
    std::uint64_t elements_ = 0;
    std::optional<Property> own_property_;                                   // property of the current object
    std::vector<std::set<Property>> properties_;                             // properties of each object
    std::unordered_map<std::uint32_t, std::vector<std::string>> materials_;  // groups of base materials, by identifier
    std::unordered_map<std::uint32_t, std::uint64_t> lines_;  // line of each object and group of materials
    std::set<std::uint32_t> other_groups_;                    // groups of properties of extensions
    std::vector<std::string>* group_ = nullptr;               // group of the element <basematerials>
    bool has_resources_ = false, has_build_ = false, has_vertices_ = false, has_triangles_ = false;
};

}  // namespace octopair::io::three_mf
