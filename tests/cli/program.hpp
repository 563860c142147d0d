// Runs the built program as a user would, in a temporary directory.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "io/temporary.hpp"

namespace octopair::test {

struct Outcome {
    int status = 0;  ///< exit status as in a shell: 128 + signal if a signal killed the program
    std::string out;
    std::string err;
};

class ProgramTest : public ::testing::Test {
protected:
    /// Runs a line of sh in the directory. $P is the program. `hears PID` waits until process PID has blocked SIGINT,
    /// so that SIGINT is a stop request.
    Outcome shell(const std::string& line) const {
        const std::string hears =
            "hears() { for i in $(seq 1000); do grep -q '^SigBlk:.*[2367abef]$' /proc/$1/status && break; sleep 0.01; "
            "done; }";
        const std::string script = "cd '" + directory_.path() + "' && P='" OCTOPAIR_PROGRAM "' && " + hears + " && { " +
                                   line + "\n} >'" + streams_.file("out") + "' 2>'" + streams_.file("err") + "'";
        const int status = std::system(script.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(streams_.file("out")),
                read_file(streams_.file("err"))};
    }
    Outcome run(const std::string& arguments) const { return shell("\"$P\" " + arguments); }

    std::string file(const std::string& name) const { return directory_.file(name); }
    std::string content(const std::string& name) const { return read_file(file(name)); }

    /// Writes unit boxes at the given places on the x axis, as float32.
    void save_boxes(const std::string& name, const std::vector<float>& places) const {
        write_file(file(name), npy_of(io::NpyType::float32, {places.size(), 6}, rows_of(places)));
    }
    static std::vector<float> rows_of(const std::vector<float>& places) {
        std::vector<float> rows;
        for (const float x : places) rows.insert(rows.end(), {x, 0, 0, x + 1, 1, 1});
        return rows;
    }

    TemporaryDirectory directory_;
    TemporaryDirectory streams_;
};

}  // namespace octopair::test
