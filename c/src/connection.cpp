#include "connection.hpp"

#include <dlfcn.h>

#include "octopair/error.hpp"

namespace octopair::c {

namespace {

/// Returns the folder of this library, with a slash at the end. Empty if unknown: then the system searches for the module.
std::string library_folder() {
    Dl_info info = {};
    if (dladdr(reinterpret_cast<const void*>(&connect_through_module), &info) == 0 || info.dli_fname == nullptr)
        return "";
    const std::string library = info.dli_fname;
    return library.substr(0, library.rfind('/') + 1);
}

/// Loads the module from the installation, or else from the build tree.
ConnectFunction load() {
    const std::string folder = library_folder();
    void* module = dlopen((folder + OCTOPAIR_C_MODULE_FOLDER "/octopair_c_client.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) module = dlopen((folder + "octopair_c_client.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) {
        throw Error(ErrorCode::usage, std::string("connections to servers are not installed: ") + dlerror());
    }
    void* const function = dlsym(module, "octopair_c_connect");
    if (function == nullptr) throw Error(ErrorCode::usage, "octopair_c_client.so is of another version");
    return reinterpret_cast<ConnectFunction>(function);
}

}  // namespace

std::unique_ptr<Engine> connect_through_module(const std::string& address, const octopair_engine_options& options) {
    static const ConnectFunction connect = load();
    std::unique_ptr<Engine> engine;
    connect(address, options, engine);
    return engine;
}

}  // namespace octopair::c
