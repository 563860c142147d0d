#include "machine/machine.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "machine/build.hpp"
#include "octopair/version.hpp"

namespace octopair::bench {

namespace {

std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    }
    return "unknown";
}

}  // namespace

nlohmann::ordered_json machine_json() {
    return {{"version", OCTOPAIR_VERSION},
            {"commit", OCTOPAIR_COMMIT},
            {"compiler", OCTOPAIR_COMPILER},
            {"processor", processor()},
            {"cores", std::thread::hardware_concurrency()}};
}

}  // namespace octopair::bench
