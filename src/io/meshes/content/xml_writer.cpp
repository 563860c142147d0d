#include "io/meshes/content/xml_writer.hpp"

namespace octopair::io {

void XmlWriter::open(std::string_view name) {
    end_tag();
    text_.append("<").append(name);
    open_.emplace_back(name);
    in_tag_ = true;
}

void XmlWriter::attribute(std::string_view name, std::string_view value) {
    text_.append(" ").append(name).append("=\"");
    escape(value);
    text_ += '"';
}

void XmlWriter::text(std::string_view characters) {
    end_tag();
    escape(characters);
}

void XmlWriter::close() {
    if (in_tag_) {
        text_ += "/>\n";
    } else {
        text_.append("</").append(open_.back()).append(">\n");
    }
    open_.pop_back();
    in_tag_ = false;
}

void XmlWriter::end_tag() {
    if (in_tag_) text_ += '>';
    in_tag_ = false;
}

void XmlWriter::escape(std::string_view characters) {
    for (const char c : characters) {
        switch (c) {
            case '&':
                text_ += "&amp;";
                break;
            case '<':
                text_ += "&lt;";
                break;
            case '>':
                text_ += "&gt;";
                break;
            case '"':
                text_ += "&quot;";
                break;
            default:
                text_ += c;
        }
    }
}

}  // namespace octopair::io
