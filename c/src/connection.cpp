#include "connection.hpp"

#include <dlfcn.h>

#include "octopair/error.hpp"

namespace octopair::c {

namespace {

/// Returns the path of the module: the folder of this library, else its name alone, which the system searches.
std::string module_path() {
    const std::string name = "liboctopair_c_client.so.0";
    Dl_info info = {};
    if (dladdr(reinterpret_cast<const void*>(&connect_through_module), &info) == 0 || info.dli_fname == nullptr)
        return name;
    const std::string library = info.dli_fname;
    const std::size_t slash = library.rfind('/');
    return slash == std::string::npos ? name : library.substr(0, slash + 1) + name;
}

ConnectFunction load() {
    void* module = dlopen(module_path().c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) module = dlopen("liboctopair_c_client.so.0", RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) {
        throw Error(ErrorCode::usage, std::string("connections to servers are not installed: ") + dlerror());
    }
    void* const function = dlsym(module, "octopair_c_connect");
    if (function == nullptr) throw Error(ErrorCode::usage, "liboctopair_c_client is of another version");
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
