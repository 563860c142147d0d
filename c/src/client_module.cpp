// The module with gRPC that connection.cpp loads.
#include <algorithm>
#include <chrono>
#include <string>

#include "connection.hpp"
#include "octopair/client.hpp"
#include "octopair/error.hpp"

namespace {

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// Returns a duration of at most a year. Throws: Error{bad_input} if it is negative or not a number.
std::chrono::milliseconds milliseconds_of(double seconds, const char* name) {
    constexpr double year = 365 * 86400.0;
    if (!(seconds >= 0))
        throw octopair::Error(octopair::ErrorCode::bad_input, std::string(name) + " is not a number of seconds >= 0");
    return std::chrono::milliseconds(std::int64_t(std::min(seconds, year) * 1e3));
}

}  // namespace

extern "C" OCTOPAIR_API void octopair_c_connect(const std::string& address, const octopair_engine_options& options,
                                                std::unique_ptr<octopair::Engine>& engine) {
    octopair::ClientOptions client;
    client.token = text_of(options.token);
    client.authority = text_of(options.authority);
    client.certificate = text_of(options.certificate);
    client.key = text_of(options.key);
    client.tls = options.tls != 0;
    client.token_in_clear = options.token_in_clear != 0;
    client.connect_timeout = milliseconds_of(options.connect_timeout, "connect_timeout");
    client.patience = milliseconds_of(options.patience, "patience");
    engine = octopair::connect(address, client);
}
