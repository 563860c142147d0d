// Ours: the timed call is find_pairs in octal order into a reused list; besides, ascending order and counting.
#include "octopair/octopair.hpp"

#include <algorithm>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

class Ours : public Contender {
public:
    Ours(unsigned threads, Order order) : engine_(make_local_engine(threads)) { options_.order = order; }

    void run(std::span<const Box3f> boxes) override { find(Objects{boxes}); }
    Found found() const override {
        Found found;
        for (const auto chunk : pairs_.chunks()) add(found, chunk);
        return found;
    }

protected:
    void find(const Objects& objects) { (void)engine_->find_pairs(objects, pairs_, options_); }

private:
    std::unique_ptr<Engine> engine_;
    Options options_;
    PairList pairs_;
};

/// Finds the same number, and no pairs whose hash could be compared.
class OursCounting : public Contender {
public:
    explicit OursCounting(unsigned threads) : engine_(make_local_engine(threads)) {}
    void run(std::span<const Box3f> boxes) override { pairs_ = engine_->count_pairs(Objects{boxes}); }
    Found found() const override { return {pairs_, 0}; }

private:
    std::unique_ptr<Engine> engine_;
    std::uint64_t pairs_ = 0;
};

/// The same boxes in float64, converted on the first run.
class OursWide : public Ours {
public:
    explicit OursWide(unsigned threads) : Ours(threads, Order::octal) {}
    void run(std::span<const Box3f> boxes) override {
        if (narrow_.data() != boxes.data() || narrow_.size() != boxes.size()) widen(boxes);
        find(Objects{std::span<const Box3d>(wide_)});
    }

private:
    void widen(std::span<const Box3f> boxes) {
        narrow_ = boxes;
        wide_.resize(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            std::copy_n(boxes[i].min, 3, wide_[i].min);
            std::copy_n(boxes[i].max, 3, wide_[i].max);
        }
    }

    std::span<const Box3f> narrow_;
    std::vector<Box3d> wide_;
};

}  // namespace

std::vector<ContenderKind> octopair_contenders() {
    return {
        {"octopair", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Ours>(k, Order::octal); }},
        {"octopair ascending", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Ours>(k, Order::ascending); }},
        {"octopair count", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<OursCounting>(k); }},
        {"octopair float64", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<OursWide>(k); }},
    };
}

}  // namespace octopair::bench
