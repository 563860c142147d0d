// XmlTree: the elements of an XML text, in memory. XmlWriter: writes an XML text.
//
// Invariants
//   Elements are in document order. The descendants of element i are those from i + 1 to its end.
//   Texts are UTF-8, whatever the encoding of the file is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octopair::io {

class XmlTree;

/// An element of an XmlTree. Requires: the tree outlives the element.
class XmlElement {
public:
    XmlElement(const XmlTree& tree, std::size_t index) : tree_(&tree), index_(index) {}

    std::size_t index() const { return index_; }
    std::string_view name() const;
    /// Returns the line of the file in which the element begins.
    std::size_t line() const;
    std::optional<std::string_view> attribute(std::string_view name) const;
    /// Returns all attributes, each with its name.
    std::vector<std::pair<std::string_view, std::string_view>> attributes() const;
    /// Returns the characters before the first child.
    std::string_view text() const;
    /// Returns the children, in document order.
    std::vector<XmlElement> children() const;
    /// Returns the children with a name.
    std::vector<XmlElement> children(std::string_view name) const;
    std::optional<XmlElement> child(std::string_view name) const;
    std::optional<XmlElement> parent() const;
    /// Returns whether a descendant has the name.
    bool contains(std::string_view name) const;

    /// Throws: Error{bad_input} "FILE: line N: WHAT".
    [[noreturn]] void refuse(std::string_view what) const;

private:
    const XmlTree* tree_;
    std::size_t index_;
};

class XmlTree {
public:
    /// Parses a text. `path` is for messages.
    /// Throws: Error{bad_input} with the line if the text is not well-formed, or if more than 5,000 elements are nested.
    XmlTree(std::string path, std::string_view bytes);

    XmlElement root() const { return {*this, 0}; }
    /// Returns the number of elements.
    std::size_t size() const { return elements_.size(); }
    XmlElement at(std::size_t index) const { return {*this, index}; }
    const std::string& path() const { return path_; }

private:
    XmlTree() = default;
    friend class XmlElement;
    friend class XmlTreeBuilder;

    struct Element {
        std::uint32_t name = 0;  // index in names_
        std::uint32_t attributes = 0;
        std::size_t line = 0, parent = 0, end = 0;
        std::size_t first_attribute = 0;  // index in attributes_
        std::size_t text_begin = 0, text_end = 0;
    };
    struct Attribute {
        std::uint32_t name = 0;
        std::size_t begin = 0, end = 0;
    };

    std::string_view characters(std::size_t begin, std::size_t end) const {
        return std::string_view(characters_).substr(begin, end - begin);
    }

    std::string path_;
    std::vector<std::string> names_;
    std::vector<Element> elements_;
    std::vector<Attribute> attributes_;
    std::string characters_;  // texts of elements and values of attributes
};

/// Appends elements to an XML text.
class XmlWriter {
public:
    void open(std::string_view name);
    /// Requires: the element has neither text nor child so far.
    void attribute(std::string_view name, std::string_view value);
    void text(std::string_view characters);
    void close();

    std::size_t size() const { return text_.size(); }
    std::string take() { return std::move(text_); }

private:
    void end_tag();
    void escape(std::string_view characters);

    std::string text_;
    std::vector<std::string> open_;
    bool in_tag_ = false;  // true if the start tag of the last open element has no ">" yet
};

}  // namespace octopair::io
