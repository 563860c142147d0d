// Reads the elements of an IFC file, and the facts about elements that only the text of the file has (read_ifc_text()).
#include "io/meshes/assimp/ifc_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_set>
#include <vector>

#include <fmt/format.h>

#include "io/meshes/assimp/ifc_links.hpp"
#include "io/meshes/assimp/step_reader.hpp"
#include "io/object_details.hpp"

namespace octopair::io {

namespace {

void append_utf8(std::string& text, std::uint32_t letter) {
    if (letter < 0x80) {
        text += char(letter);
        return;
    }
    if (letter < 0x800) {
        text += char(0xC0 | letter >> 6);
    } else if (letter < 0x10000) {
        text += char(0xE0 | letter >> 12);
        text += char(0x80 | (letter >> 6 & 0x3F));
    } else {
        text += char(0xF0 | letter >> 18);
        text += char(0x80 | (letter >> 12 & 0x3F));
        text += char(0x80 | (letter >> 6 & 0x3F));
    }
    text += char(0x80 | (letter & 0x3F));
}

/// Returns the value of the `digits` hexadecimal digits at the beginning of a text; nothing if the text has fewer such digits.
std::optional<std::uint32_t> hexadecimal(std::string_view text, std::size_t digits) {
    if (text.size() < digits) return std::nullopt;
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + digits, value, 16);
    if (error != std::errc() || end != text.data() + digits) return std::nullopt;
    return value;
}

/// Decodes the letters of \X2\ (4 digits each) or \X4\ (8 digits each), up to \X0\. Appends them to `decoded`. Returns the number of
/// bytes read; 0 if the code is not valid.
std::size_t decode_letters(std::string_view text, std::size_t digits, std::string& decoded) {
    std::string letters;
    std::uint32_t high = 0;  // first half of a UTF-16 pair
    std::size_t at = 0;
    for (; !text.substr(at).starts_with("\\X0\\"); at += digits) {
        const auto letter = hexadecimal(text.substr(at), digits);
        if (!letter || *letter > 0x10FFFF) return 0;
        const bool is_high = *letter >= 0xD800 && *letter < 0xDC00, is_low = *letter >= 0xDC00 && *letter < 0xE000;
        if (is_low != (high != 0) || (is_high && digits != 4)) return 0;
        if (is_high) {
            high = *letter;
            continue;
        }
        append_utf8(letters, is_low ? 0x10000 + ((high - 0xD800) << 10) + (*letter - 0xDC00) : *letter);
        high = 0;
    }
    if (high != 0) return 0;
    decoded += letters;
    return at + 4;
}

/// Decodes a code that begins with a backslash. Returns the number of bytes read; 0 if the code is not valid.
std::size_t decode_code(std::string_view text, std::string& decoded) {
    if (text.starts_with("\\\\")) {
        decoded += '\\';
        return 2;
    }
    if (text.starts_with("\\S\\") && text.size() > 3) {
        append_utf8(decoded, 0x80 | static_cast<unsigned char>(text[3]));
        return 4;
    }
    if (text.starts_with("\\X\\")) {
        const auto letter = hexadecimal(text.substr(3), 2);
        if (letter) append_utf8(decoded, *letter);
        return letter ? 5 : 0;
    }
    for (const auto& [begin, digits] : {std::pair("\\X2\\", 4u), std::pair("\\X4\\", 8u)}) {
        if (!text.starts_with(begin)) continue;
        const std::size_t read = decode_letters(text.substr(4), digits, decoded);
        return read == 0 ? 0 : 4 + read;
    }
    return 0;
}

using step::attribute_at;
using step::digits;
using step::references_of;
using step::StepInstance;
using step::StepReader;

/// Returns the largest number in the attributes of a point, without its sign.
double largest_of(std::string_view point) {
    double largest = 0;
    for (StepReader reader(point); reader.find("0123456789");) {
        const std::string_view text = reader.take_all("0123456789.eE+-");
        double value = 0;
        if (std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc())
            largest = std::max(largest, value);
    }
    return largest;
}

/// Returns whether a representation is a body, by its identifier.
bool is_body(std::string_view identifier) {
    constexpr std::string_view others =
        " Axis Axis2D Axis3D FootPrint Box Annotation Profile Reference CoG Clearance Lighting PlanSymbol2D "
        "PlanSymbol3D SurveyPoints ";
    return others.find(fmt::format(" {} ", identifier)) == std::string_view::npos;
}

/// Returns whether Assimp leaves out elements of a type, although they have a body.
bool is_left_out(const StepInstance& instance) {
    constexpr std::array<std::string_view, 7> types = {"IFCOPENINGELEMENT", "IFCOPENINGSTANDARDCASE", "IFCSPACE",
                                                       "IFCVOIDINGFEATURE", "IFCVIRTUALELEMENT",      "IFCGRID",
                                                       "IFCANNOTATION"};
    return std::any_of(types.begin(), types.end(), [&](std::string_view type) { return instance.is(type); });
}

/// Collects the facts of an IfcText.
class IfcTextReader {
public:
    IfcText read(std::string_view step) {
        StepReader reader(step);
        while (!reader.at_end()) {
            if (const auto instance = reader.next()) add(*instance);
        }
        add_materials();
        add_bodies();
        text_.links = links_.find(ids_);
        text_.schema = ifc_schema(step);
        text_.complete = step.rfind("END-ISO-10303-21") != std::string_view::npos;
        return std::move(text_);
    }

private:
    struct Material {
        std::string name;                          // name of an IfcMaterial
        std::vector<std::string_view> references;  // numbers of the instances in a layer, a set or a list
    };

    struct Product {
        std::string_view id, type, shape;  // shape: the number of its definition
    };

    void add(const StepInstance& instance) {
        constexpr std::size_t id_length = 22;
        StepReader reader(instance.attributes);
        if (instance.is("IFCCARTESIANPOINT")) {
            text_.largest_coordinate = std::max(text_.largest_coordinate, largest_of(instance.attributes));
            return;
        }
        if (instance.is("IFCPRODUCTDEFINITIONSHAPE")) {
            definitions_.emplace(instance.number, references_of(instance.attributes));
        } else if (instance.is("IFCSHAPEREPRESENTATION")) {
            const std::string_view identifier = attribute_at(instance, 1);
            if (is_body(identifier.substr(identifier.starts_with('\'') ? 1 : 0, identifier.size() - 2)))
                body_representations_.insert(instance.number);
        }
        const auto first = reader.take_text();
        if (instance.is("IFCMATERIAL")) {
            materials_[instance.number].name = first ? decode_step_text(*first) : std::string();
        } else if (instance.is("IFCMATERIAL", true)) {
            materials_[instance.number].references = references_of(instance.attributes);
        } else if (instance.is("IFCRELASSOCIATESMATERIAL")) {
            associations_.push_back(references_of(instance.attributes));
        }
        if (!first || first->size() != id_length) return;
        ids_.emplace(instance.number, *first);
        links_.add(instance);
        if (instance.is("IFCPROJECT") && text_.project.empty()) text_.project = *first;
        const std::string_view shape = attribute_at(instance, 6);
        if (shape.starts_with('#')) add_product({*first, instance.type, shape.substr(1)}, is_left_out(instance));
        if (!reader.take(',')) return;
        reader.skip(" \t\r\n#$*");
        reader.skip(digits);
        const auto name = reader.take(',') ? reader.take_text() : std::nullopt;
        if (name && !name->empty()) text_.names.emplace(*first, decode_step_text(*name));
    }

    /// Notes the materials of the elements of each association. An association refers to its elements first, and to the material last.
    void add_materials() {
        for (const auto& references : associations_) {
            if (references.empty()) continue;
            const auto [known, is_new] = joined_.try_emplace(references.back());
            if (is_new) known->second = joined_materials(materials_below(references.back()));
            const std::string& joined = known->second;
            for (const std::string_view element : references) {
                const auto id = ids_.find(element);
                if (id != ids_.end() && !joined.empty()) text_.materials.emplace(id->second, joined);
            }
        }
    }

    void add_product(const Product& product, bool left_out) {
        if (left_out) {
            ++text_.left_out[std::string(product.type)];
        } else {
            products_.push_back(product);
        }
    }

    void add_bodies() {
        for (const Product& product : products_) {
            const auto definition = definitions_.find(product.shape);
            if (definition == definitions_.end()) continue;
            const auto& shapes = definition->second;
            if (std::any_of(shapes.begin(), shapes.end(),
                            [&](std::string_view shape) { return body_representations_.contains(shape); }))
                text_.bodies.push_back({std::string(product.id), std::string(product.type)});
        }
    }

    /// Returns the names of the materials that an instance leads to. Visits a limited number of instances, because in some files many lists
    /// lead to one long list. The stack is explicit, because the file controls the depth.
    std::set<std::string> materials_below(std::string_view number) const {
        constexpr std::size_t most = 100;
        std::set<std::string> names;
        std::set<std::string_view> seen;
        std::vector<std::string_view> waiting = {number};
        while (!waiting.empty() && seen.size() < most) {
            const auto found = materials_.find(waiting.back());
            waiting.pop_back();
            if (found == materials_.end() || !seen.insert(found->first).second) continue;
            if (!found->second.name.empty()) names.insert(found->second.name);
            const auto& references = found->second.references;
            waiting.insert(waiting.end(), references.begin(),
                           references.begin() + std::ptrdiff_t(std::min(references.size(), most)));
        }
        return names;
    }

    IfcText text_;
    IfcLinkReader links_;
    std::vector<Product> products_;
    std::unordered_map<std::string_view, std::vector<std::string_view>> definitions_;  // representations, by number
    std::unordered_set<std::string_view> body_representations_;                        // numbers of instances
    std::unordered_map<std::string_view, std::string_view> ids_;  // GlobalIds, by the numbers of instances
    std::unordered_map<std::string_view, Material> materials_;    // by the numbers of instances
    std::unordered_map<std::string_view, std::string>
        joined_;  // names of materials, by the instances that lead to them
    std::vector<std::vector<std::string_view>> associations_;
};

}  // namespace

std::optional<IfcElement> parse_ifc_element(std::string_view node_name) {
    constexpr std::size_t id_length = 22, most_bytes = 1023;  // Assimp cuts longer names
    if (!node_name.starts_with("Ifc") || node_name.size() < id_length + 2) return std::nullopt;
    if (node_name.size() >= most_bytes) return IfcElement{node_name.substr(0, node_name.find('_')), {}, {}};
    const std::size_t type_end = node_name.find('_'), name_end = node_name.size() - id_length - 1;
    if (node_name[name_end] != '_' || type_end > name_end) return std::nullopt;
    IfcElement element{node_name.substr(0, type_end), {}, node_name.substr(name_end + 1)};
    if (type_end < name_end) element.name = node_name.substr(type_end + 1, name_end - type_end - 1);
    if (element.name == "Unnamed") element.name = {};  // Assimp writes this name for elements without one
    return element;
}

std::string decode_step_text(std::string_view text) {
    std::string decoded;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '\'' && text.substr(at).starts_with("''")) ++at;
        if (const std::size_t read = c == '\\' ? decode_code(text.substr(at), decoded) : 0) {
            at += read;
            continue;
        }
        decoded += c;
        ++at;
    }
    return decoded;
}

IfcText read_ifc_text(std::string_view step) { return IfcTextReader().read(step); }

}  // namespace octopair::io
