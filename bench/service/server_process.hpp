// Server process owned by this program, on a Unix socket in a temporary folder.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace octopair::bench {

class ServerProcess {
public:
    /// `program`: octopair. `options`: options of `octopair serve` other than the address. Throws: Error if the start
    /// fails.
    ServerProcess(const std::string& program, const std::vector<std::string>& options);
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;
    ~ServerProcess();

    std::string address() const { return "unix:" + (folder_ / "socket").string(); }

private:
    std::filesystem::path folder_;
    pid_t process_ = -1;
};

}  // namespace octopair::bench
