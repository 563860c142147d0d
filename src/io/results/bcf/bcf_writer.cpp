#include "io/results/bcf/bcf_writer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "io/files/atomic_file.hpp"
#include "io/json/json_text.hpp"
#include "io/results/bcf/zip_writer.hpp"

namespace octopair::io {

namespace {

constexpr std::string_view head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
constexpr std::string_view date = "1980-01-01T00:00:00Z";  // BCF needs a date; a clock would change the bytes
constexpr std::string_view author = "octopair";
constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD in UTF-8

/// Returns a text as content of an element or an attribute. Characters that XML does not have become U+FFFD.
std::string xml_text(std::string_view text) {
    std::string xml;
    for (const char c : clean_text(text)) {
        switch (c) {
            case '&':
                xml += "&amp;";
                break;
            case '<':
                xml += "&lt;";
                break;
            case '>':
                xml += "&gt;";
                break;
            case '"':
                xml += "&quot;";
                break;
            default:
                xml += c >= 0 && c < ' ' && c != '\n' && c != '\t' ? replacement : std::string_view(&c, 1);
        }
    }
    for (const std::string_view character : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"}) {  // U+FFFE and U+FFFF
        for (std::size_t at = 0; (at = xml.find(character, at)) != std::string::npos;)
            xml.replace(at, character.size(), replacement);
    }
    return xml;
}

std::string element(std::string_view name, std::string_view text) {
    return fmt::format("<{0}>{1}</{0}>", name, xml_text(text));
}

std::string vector_xml(std::string_view name, const Point3d& value) {
    return fmt::format("    <{0}><X>{1}</X><Y>{2}</Y><Z>{3}</Z></{0}>\n", name, json_number(value[0]),
                       json_number(value[1]), json_number(value[2]));
}

std::string component_xml(const BcfComponent& component) {
    if (!component.ifc_id.empty()) return fmt::format("<Component IfcGuid=\"{}\"/>", component.ifc_id);
    return fmt::format("<Component>{}{}</Component>", element("OriginatingSystem", author),
                       element("AuthoringToolId", component.authoring_id));
}

std::string file_xml(const BcfFile& file) {
    const std::string project = file.project.empty() ? "" : fmt::format(" IfcProject=\"{}\"", file.project);
    return fmt::format("    <File{} isExternal=\"true\">{}</File>\n", project, element("Filename", file.name));
}

std::string comment_xml(const BcfComment& comment, const BcfTopic& topic) {
    return fmt::format("  <Comment Guid=\"{}\">{}{}{}<Viewpoint Guid=\"{}\"/></Comment>\n", comment.guid,
                       element("Date", date), element("Author", author), element("Comment", comment.text),
                       topic.viewpoint_guid);
}

std::string markup_of(const BcfTopic& topic) {
    std::string xml = fmt::format("{}<Markup>\n", head);
    if (!topic.files.empty()) {
        xml += "  <Header>\n";
        for (const BcfFile& file : topic.files) xml += file_xml(file);
        xml += "  </Header>\n";
    }
    xml += fmt::format("  <Topic Guid=\"{}\" TopicType=\"Clash\" TopicStatus=\"{}\">\n", topic.guid,
                       word_of(topic.status));
    xml += fmt::format("    {}\n", element("Title", topic.title));
    if (!topic.label.empty()) xml += fmt::format("    {}\n", element("Labels", topic.label));
    xml += fmt::format("    {}\n    {}\n    {}\n  </Topic>\n", element("CreationDate", date),
                       element("CreationAuthor", author), element("Description", topic.description));
    for (const BcfComment& comment : topic.comments) xml += comment_xml(comment, topic);
    xml += fmt::format("  <Viewpoints Guid=\"{}\">{}</Viewpoints>\n</Markup>\n", topic.viewpoint_guid,
                       element("Viewpoint", "viewpoint.bcfv"));
    return xml;
}

std::string viewpoint_of(const BcfTopic& topic) {
    std::string components;
    for (const BcfComponent& component : topic.components) components += component_xml(component);
    return fmt::format("{}<VisualizationInfo Guid=\"{}\">\n  <Components>\n    <Selection>{}</Selection>\n", head,
                       topic.viewpoint_guid, components) +
           fmt::format("    <Visibility DefaultVisibility=\"false\"><Exceptions>{}</Exceptions></Visibility>\n",
                       components) +
           "  </Components>\n  <PerspectiveCamera>\n" + vector_xml("CameraViewPoint", topic.camera.place) +
           vector_xml("CameraDirection", topic.camera.direction) + vector_xml("CameraUpVector", topic.camera.up) +
           fmt::format("    <FieldOfView>{}</FieldOfView>\n  </PerspectiveCamera>\n</VisualizationInfo>\n",
                       BcfTopics::field_of_view);
}

class BcfWriter final : public CollisionWriter {
public:
    BcfWriter(const std::string& path, const BcfScene& scene) : file_(path), scene_(scene), topics_(scene_) {}

    void write(const CollisionRows& rows) override { topics_.add(rows); }
    void write_gone(std::span<const std::string_view>) override {}  // a topic needs elements that exist
    void finish() override {
        ZipWriter zip;
        zip.add("bcf.version",
                fmt::format("{}<Version VersionId=\"2.1\">{}</Version>\n", head, element("DetailedVersion", "2.1")));
        for (const BcfTopic& topic : topics_.topics()) {
            zip.add(topic.guid + "/markup.bcf", markup_of(topic));
            zip.add(topic.guid + "/viewpoint.bcfv", viewpoint_of(topic));
        }
        file_.write(zip.finish());
        file_.commit();
    }

private:
    AtomicFile file_;
    BcfScene scene_;
    BcfTopics topics_;
};

}  // namespace

std::unique_ptr<CollisionWriter> make_bcf_writer(const std::string& path, const BcfScene& scene) {
    return std::make_unique<BcfWriter>(path, scene);
}

}  // namespace octopair::io
