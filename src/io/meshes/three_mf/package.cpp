#include "io/meshes/three_mf/package.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/files/letter_case.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/uri.hpp"
#include "io/meshes/xml/xml_parser.hpp"

namespace octopair::io::three_mf {

namespace {

constexpr std::string_view relationships = "_rels/.rels";
constexpr std::size_t several = ~std::size_t(0);  // several parts have this name

Buffer<std::byte> package_bytes(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    Buffer<std::byte> content{std::size_t(file.size())};
    file.read(0, content.span(), stop);
    return content;
}

/// Collects the targets of the relationships with start parts.
class RelationshipHandler final : public XmlHandler {
public:
    explicit RelationshipHandler(const std::string& place) : place_(place) {}

    void begin(const XmlTag& element) override {
        constexpr std::string_view start_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
        if (element.name().local != "Relationship") return;
        const char *const type = element.find("Type"), *const target = element.find("Target");
        if (type == nullptr || type != start_type) return;
        const char* const mode = element.find("TargetMode");
        if (mode != nullptr && std::string_view(mode) == "External")
            refuse(place_, "the model is in another file; write one 3MF file with everything");
        if (target == nullptr) refuse(place_, "the relationship with the model has no Target; write the file again");
        targets_.push_back(part_name(target));
    }
    void end() override {}

    const std::vector<std::string>& targets() const { return targets_; }

private:
    const std::string& place_;
    std::vector<std::string> targets_;
};

}  // namespace

std::string part_name(std::string_view path) {
    std::vector<std::string> segments;
    while (!path.empty()) {
        const std::size_t end = std::min(path.find('/'), path.size());
        std::string segment = percent_decoded(path.substr(0, end));
        path.remove_prefix(std::min(end + 1, path.size()));
        if (segment == "..") {
            if (!segments.empty()) segments.pop_back();
        } else if (!segment.empty() && segment != ".") {
            segments.push_back(std::move(segment));
        }
    }
    return fmt::format("{}", fmt::join(segments, "/"));
}

bool is_same_part(std::string_view a, std::string_view b) { return in_lower_case(a) == in_lower_case(b); }

Package::Package(const std::string& path, const std::stop_token& stop)
    : Package(path, package_bytes(path, stop), stop) {}

Package::Package(std::string path, Buffer<std::byte> content, const std::stop_token& stop)
    : budget_(std::move(path), stop), content_(std::move(content)), archive_([this]() -> ZipArchive {
          if (content_.size() == 0) refuse(budget_.path(), "is empty");
          budget_.add_file(content_.size());
          return {content_.span(), budget_};
      }()) {
    for (std::size_t i = 0; i < archive_.entries().size(); ++i) {
        const std::string_view name = archive_.entries()[i].name;
        budget_.charge(1, sizeof(std::size_t) + sizeof(std::string) + 4 * sizeof(void*) + name.size());
        const auto [place, is_new] = numbers_.try_emplace(in_lower_case(part_name(name)), i);
        if (!is_new) place->second = several;
    }
}

std::string Package::find_start() {
    const TextSource text = text_of(relationships, "a 3MF file");
    const std::string place = fmt::format("{}: {}", budget_.path(), relationships);
    RelationshipHandler handler(place);
    XmlParser parser(place, handler, XmlParser::Mode::strict);
    text([&](std::string_view piece) {
        parser.parse(piece);
        return true;
    });
    parser.finish();
    starts_ = handler.targets().size();
    if (starts_ == 0) refuse(place, "names no model; this ZIP archive is no 3MF file");
    return handler.targets().front();
}

TextSource Package::text_of(std::string_view name, std::string_view place, std::function<void(double)> progress) {
    const auto found = numbers_.find(in_lower_case(name));
    if (found == numbers_.end()) {
        refuse(budget_.path(),
               fmt::format("has no part {}, which {} needs; write the file again", shown_text(name), place));
    }
    if (found->second == several)
        refuse(budget_.path(), fmt::format("has several parts {}; write the file again", shown_text(name)));
    const ZipEntry& entry = archive_.entries()[found->second];
    return [this, &entry, progress = std::move(progress)](const std::function<bool(std::string_view)>& consumer) {
        double done = 0;
        archive_.unpack(entry, [&](std::string_view piece) {
            done += double(piece.size()) / double(entry.size) * double(entry.packed_size);
            if (progress) progress(std::min(1.0, (double(packed_read_) + done) / double(content_.size())));
            return consumer(piece);
        });
        packed_read_ += entry.packed_size;
    };
}

}  // namespace octopair::io::three_mf
