// Limits of the hardware: a copy of the boxes, one radix sort of (30-bit key, index), and one written pair per object.
#include <array>
#include <utility>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

class Limit : public Contender {
public:
    Found found() const override { return {}; }
};

class Copy : public Limit {
public:
    void run(std::span<const Box3f> boxes) override { copy_.assign(boxes.begin(), boxes.end()); }

private:
    std::vector<Box3f> copy_;
};

/// Three passes of 10 bits, least significant first.
class RadixSort : public Limit {
public:
    void run(std::span<const Box3f> boxes) override {
        items_.resize(boxes.size());
        other_.resize(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const std::uint64_t key = i * 0x9E3779B97F4A7C15ull >> 34;
            items_[i] = key << 32 | i;
        }
        for (unsigned shift = 32; shift < 62; shift += digit_bits) pass(shift);
    }

private:
    static constexpr unsigned digit_bits = 10;

    void pass(unsigned shift) {
        std::array<std::size_t, 1 << digit_bits> at{};
        const auto digit = [&](std::uint64_t item) { return item >> shift & (at.size() - 1); };
        for (const std::uint64_t item : items_) ++at[digit(item)];
        std::size_t sum = 0;
        for (std::size_t& count : at) sum += std::exchange(count, sum);
        for (const std::uint64_t item : items_) other_[at[digit(item)]++] = item;
        items_.swap(other_);
    }

    std::vector<std::uint64_t> items_, other_;
};

class WritePairs : public Limit {
public:
    void run(std::span<const Box3f> boxes) override {
        pairs_.resize(boxes.size());
        for (std::uint32_t i = 0; i < pairs_.size(); ++i) pairs_[i] = {i, i + 1};
    }

private:
    std::vector<Pair> pairs_;
};

}  // namespace

std::vector<ContenderKind> limits() {
    return {
        {"limit: copy", false, true, [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Copy>(); }},
        {"limit: radix sort", false, true,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<RadixSort>(); }},
        {"limit: write a pair", false, true,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<WritePairs>(); }},
    };
}

}  // namespace octopair::bench
