#include "io/meshes/three_mf/model_part.hpp"

#include <utility>

#include <fmt/format.h>

#include "io/json/json_fields.hpp"
#include "io/meshes/three_mf/extensions.hpp"
#include "io/meshes/three_mf/model_parser.hpp"

namespace octopair::io::three_mf {

namespace {

std::string place_of_part(std::string_view name, const ReadBudget& budget) {
    return fmt::format("{}: {}", budget.path(), shown_text(name));
}

/// Gets the namespace of the first element.
class VersionHandler final : public XmlHandler {
public:
    void begin(const XmlElement& element) override {
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
    XmlParser parser(place_of_part(name, budget), handler);
    source([&](std::string_view piece) {
        parser.parse(piece);
        return !handler.done();
    });
    if (!handler.done()) parser.finish();
    return handler.take();
}

}  // namespace octopair::io::three_mf
