// Connections to servers. They need gRPC, so they are in a module that is loaded when the first address is used: programs without
// addresses load neither the module nor gRPC.
#pragma once

#include <memory>
#include <string>

#include "octopair.h"
#include "octopair/engine.hpp"

namespace octopair::c {

/// Returns an engine of the server at `address`.
/// Throws: as connect() (octopair/client.hpp); Error{usage} if the module is not installed.
std::unique_ptr<Engine> connect_through_module(const std::string& address, const octopair_engine_options& options);

/// The function `octopair_c_connect` of the module. Throws as above.
using ConnectFunction = void (*)(const std::string& address, const octopair_engine_options& options,
                                 std::unique_ptr<Engine>& engine);

}  // namespace octopair::c
