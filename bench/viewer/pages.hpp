// Pages for the benchmark of the viewer: a process of low priority with connections to a View.
#pragma once

#include <cstdint>
#include <string>

namespace octopair::bench {

enum class Reading : std::uint8_t {
    all,   ///< requests and reads each frame
    first  ///< reads one frame, requests a whole frame, and never reads again
};

/// Number and sizes of the live frames that the pages of a process received.
struct PageBytes {
    std::uint64_t frames = 0;      ///< number of all frames
    double median_difference = 0;  ///< median number of bytes of the frames that are differences
    double largest_difference = 0;
    double whole = 0;  ///< bytes of the last whole frame
};

/// Runs the pages of this process until the server ends, and prints PageBytes. Called by the program that PageProcess starts.
int run_pages(const std::string& address, unsigned pages, Reading reading);

/// A process with pages. It has the lowest priority, so that a scene keeps the processor cores.
class PageProcess {
public:
    PageProcess(const std::string& address, unsigned pages, Reading reading);
    PageProcess(const PageProcess&) = delete;
    PageProcess& operator=(const PageProcess&) = delete;
    ~PageProcess() { kill(); }

    void kill();
    /// Waits for the end of the process, after that of the server. Returns zeros if the process was killed.
    PageBytes wait();

private:
    int child_ = -1, output_ = -1;
};

}  // namespace octopair::bench
