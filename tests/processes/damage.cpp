#include "processes/damage.hpp"

#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "engine/processes/shared_memory/layout.hpp"
#include "samples/random.hpp"

namespace octopair::test {

namespace {

/// Returns the address of the control block in this process.
std::byte* find_control_block() {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        if (line.find("memfd:octopair") == std::string::npos) continue;
        auto* const begin = reinterpret_cast<std::byte*>(std::strtoull(line.c_str(), nullptr, 16));
        std::uint64_t mark = 0;
        std::memcpy(&mark, begin, sizeof mark);
        if (mark == control_mark) return begin;
    }
    return nullptr;
}

class Damage final : public ShareObserver {
public:
    Damage(std::uint64_t seed, unsigned slot) : random_(seed, slot), slot_(slot) {
        // A replacement process continues with other random numbers than its predecessor.
        for (auto i = std::uint64_t(::getpid()) % 64; i > 0; --i) (void)random_.below(2);
    }

    void begin(Step) override { perhaps(40); }
    void tick() override { perhaps(300); }
    void reach(CommitPoint) override { perhaps(80); }
    void end() override { perhaps(40); }

private:
    void perhaps(std::uint64_t one_in) {
        if (random_.below(one_in) != 0) return;
        if (control_block_ == nullptr) control_block_ = find_control_block();
        if (control_block_ != nullptr) write();
    }

    void write() {
        const std::uint64_t shares = 200;
        switch (random_.below(6)) {
            case 0:
                return scribble(ControlBlockLayout::slots + slot_ * sizeof(Slot), sizeof(Slot));
            case 1:
                return scribble(ControlBlockLayout::shares + random_.below(shares) * sizeof(Share), sizeof(Share));
            case 2:
                return scribble(ControlBlockLayout::runs + random_.below(shares) * sizeof(Run), sizeof(Run));
            case 3:
                return scribble(
                    ControlBlockLayout::rings + (slot_ * max_ring_blocks + random_.below(8)) * sizeof(RingEntry),
                    sizeof(RingEntry));
            case 4:
                return scribble(ControlBlockLayout::logs + slot_ * max_logged * sizeof(LoggedPage), 64);
            default:
                return scribble(ControlBlockLayout::commits + 2 * slot_ * sizeof(Commit), 256);
        }
    }

    /// Overwrites 1 or 4 random words of [offset, offset + size).
    void scribble(std::uint64_t offset, std::uint64_t size) {
        const std::uint64_t words = random_.below(3) == 0 ? 4 : 1;
        for (std::uint64_t i = 0; i < words; ++i) {
            const std::uint64_t value = random_.next() >> random_.below(64);
            std::memcpy(control_block_ + offset + random_.below(size / 8) * 8, &value, sizeof value);
        }
    }

    samples::RandomStream random_;
    unsigned slot_;
    std::byte* control_block_ = nullptr;
};

}  // namespace

std::unique_ptr<ShareObserver> make_damage(std::uint64_t seed, unsigned slot) {
    return std::make_unique<Damage>(seed, slot);
}

}  // namespace octopair::test
