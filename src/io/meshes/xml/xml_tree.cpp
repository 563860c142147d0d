#include "io/meshes/xml/xml_tree.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/xml/xml_parser.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t no_parent = std::size_t(-1), max_depth = 5000;

}  // namespace

/// Adds to a tree the elements that a parser finds.
class XmlTreeBuilder final : public XmlHandler {
public:
    /// `encoding`: name of an encoding to use in place of the declared one, or null.
    XmlTreeBuilder(XmlTree& tree, const char* encoding)
        : tree_(tree), parser_(tree.path_, *this, XmlParser::Mode::lenient, encoding) {}

    /// Parses a text. Returns the error of the text, or nothing if it is well-formed.
    std::optional<Error> parse(std::string_view bytes) {
        try {
            parser_.parse_whole(bytes);
            return std::nullopt;
        } catch (const Error& error) {
            return error;
        }
    }

private:
    std::uint32_t number_of(const char* name) {
        const auto [found, is_new] = numbers_.try_emplace(name, std::uint32_t(tree_.names_.size()));
        if (is_new) tree_.names_.push_back(found->first);
        return found->second;
    }

    void begin(const XmlTag& tag) override {
        XmlTree::Element element;
        element.name = number_of(tag.name().local.data());
        element.line = parser_.line();
        element.parent = open_.empty() ? no_parent : open_.back();
        element.first_attribute = tree_.attributes_.size();
        for (const char* const* at = tag.attributes(); *at != nullptr; at += 2) {
            XmlTree::Attribute attribute;
            attribute.name = number_of(at[0]);
            attribute.begin = tree_.characters_.size();
            tree_.characters_ += at[1];
            attribute.end = tree_.characters_.size();
            tree_.attributes_.push_back(attribute);
            ++element.attributes;
        }
        element.text_begin = element.text_end = tree_.characters_.size();
        open_.push_back(tree_.elements_.size());
        tree_.elements_.push_back(element);
        has_child_ = false;
        if (open_.size() > max_depth)
            refuse(tree_.path_, fmt::format("line {}: more than {} elements are nested", parser_.line(), max_depth));
    }

    void end() override {
        tree_.elements_[open_.back()].end = tree_.elements_.size();
        open_.pop_back();
        has_child_ = true;
    }

    void text(std::string_view characters) override {
        if (open_.empty() || has_child_) return;
        tree_.characters_ += characters;
        tree_.elements_[open_.back()].text_end = tree_.characters_.size();
    }

    XmlTree& tree_;
    XmlParser parser_;
    std::map<std::string, std::uint32_t, std::less<>> numbers_;
    std::vector<std::size_t> open_;
    bool has_child_ = false;  // true if the last open element has a child
};

XmlTree::XmlTree(std::string path, std::string_view bytes) : path_(std::move(path)) {
    const std::optional<Error> fault = XmlTreeBuilder(*this, nullptr).parse(bytes);
    if (!fault) return;
    // Some programs write names in the encoding of the system, and declare UTF-8.
    XmlTree latin;
    latin.path_ = path_;
    if (XmlTreeBuilder(latin, "ISO-8859-1").parse(bytes)) throw *fault;
    *this = std::move(latin);
}

std::string_view XmlElement::name() const { return tree_->names_[tree_->elements_[index_].name]; }

std::size_t XmlElement::line() const { return tree_->elements_[index_].line; }

std::optional<std::string_view> XmlElement::attribute(std::string_view name) const {
    for (const auto& [key, value] : attributes()) {
        if (key == name) return value;
    }
    return std::nullopt;
}

std::vector<std::pair<std::string_view, std::string_view>> XmlElement::attributes() const {
    const XmlTree::Element& element = tree_->elements_[index_];
    std::vector<std::pair<std::string_view, std::string_view>> result;
    for (std::uint32_t i = 0; i < element.attributes; ++i) {
        const XmlTree::Attribute& attribute = tree_->attributes_[element.first_attribute + i];
        result.emplace_back(tree_->names_[attribute.name], tree_->characters(attribute.begin, attribute.end));
    }
    return result;
}

std::string_view XmlElement::text() const {
    const XmlTree::Element& element = tree_->elements_[index_];
    return tree_->characters(element.text_begin, element.text_end);
}

std::vector<XmlElement> XmlElement::children() const {
    std::vector<XmlElement> result;
    const std::size_t end = tree_->elements_[index_].end;
    for (std::size_t i = index_ + 1; i < end; i = tree_->elements_[i].end) result.emplace_back(*tree_, i);
    return result;
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
    std::vector<XmlElement> result = children();
    std::erase_if(result, [&](const XmlElement& child) { return child.name() != name; });
    return result;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
    const std::size_t end = tree_->elements_[index_].end;
    for (std::size_t i = index_ + 1; i < end; i = tree_->elements_[i].end) {
        if (tree_->at(i).name() == name) return tree_->at(i);
    }
    return std::nullopt;
}

std::optional<XmlElement> XmlElement::parent() const {
    const std::size_t parent = tree_->elements_[index_].parent;
    if (parent == no_parent) return std::nullopt;
    return tree_->at(parent);
}

bool XmlElement::contains(std::string_view name) const {
    for (std::size_t i = index_ + 1; i < tree_->elements_[index_].end; ++i) {
        if (tree_->at(i).name() == name) return true;
    }
    return false;
}

void XmlElement::refuse(std::string_view what) const {
    io::refuse(tree_->path(), fmt::format("line {}: {}", line(), what));
}

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
