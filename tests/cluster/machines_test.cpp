// Tests the model of a cluster with several processors per machine, on invented measurements.
#include "cluster/machines.hpp"

#include <gtest/gtest.h>

namespace octopair::cluster {
namespace {

struct Sent {
    std::uint64_t bytes, messages;
};

Costs costs_of(double build, double merge, double scan, const Sent& sent) {
    Costs costs;
    costs.build = build;
    costs.merge = merge;
    costs.scan = scan;
    costs.bytes_sent = sent.bytes;
    costs.messages_sent = sent.messages;
    return costs;
}

/// Returns measurements of machines with two ranks each. A rank alone takes half as long as all ranks together.
Measured made(Arrangement arrangement, const EachRank& alone) {
    Measured measured;
    measured.setup = {"uniform", 1'000'000, unsigned(alone.size()), arrangement, 2};
    measured.alone = measured.together = alone;
    for (Costs& costs : measured.together) {
        costs.build *= 2;
        costs.merge *= 2;
        costs.scan *= 2;
    }
    for (Costs& costs : measured.alone) costs.bytes_sent = costs.messages_sent = 0;  // counted in `together`
    return measured;
}

Measured paper_on_six() {
    return made(Arrangement::paper,
                {costs_of(0.010, 0.100, 0.200, {50'000'000, 20}), costs_of(0.011, 0, 0, {4'000'000, 4}),
                 costs_of(0.012, 0.003, 0, {10'000'000, 5}), costs_of(0.010, 0, 0, {4'000'000, 4}),
                 costs_of(0.010, 0.004, 0, {12'000'000, 5}), costs_of(0.009, 0, 0, {4'000'000, 4})});
}

Measured shared_on_six() {
    EachRank ranks(6, costs_of(0.010, 0, 0.030, {1'000'000, 50}));
    ranks[3].scan = 0.040;
    ranks[4].bytes_sent = 5'000'000;
    return made(Arrangement::shared, ranks);
}

TEST(Machines, ThePapersStepsWaitForEachOther) {
    // The slowest build of a list, the slowest merge of a machine, the master's merge, and the master's scan.
    EXPECT_DOUBLE_EQ(critical_path(paper_on_six()), 0.012 + 0.004 + 0.100 + 0.200);
    EXPECT_DOUBLE_EQ(merged_on_machines(paper_on_six().alone), 0.004);
    EXPECT_DOUBLE_EQ(merged_at_master(paper_on_six().alone), 0.100);
    EXPECT_DOUBLE_EQ(critical_path(shared_on_six()), 0.050);
}

TEST(Machines, TheNetworkIsThatBetweenThem) {
    const Network network{1e-3, 1e6};
    // The master broadcasts to five ranks, four of them on other machines. Two machines send their lists to the master.
    // Lists within a machine need no network.
    const Modelled paper = modelled(paper_on_six(), network);
    EXPECT_DOUBLE_EQ(paper.network, 50 * 4.0 / 5 + 10 + 12 + 20 * 4.0 / 5 * 1e-3);
    EXPECT_DOUBLE_EQ(paper.all(), paper.computing + paper.network);
    // The bytes of the busiest machine, and the messages of the busiest rank.
    EXPECT_DOUBLE_EQ(modelled(shared_on_six(), network).network, 6 * 4.0 / 5 + 50 * 4.0 / 5 * 1e-3);
    Measured one_machine = shared_on_six();
    one_machine.setup.ranks = 2;
    one_machine.together.resize(2);
    EXPECT_EQ(modelled(one_machine, network).network, 0);
}

TEST(Machines, TextHoldsOursAndThePapers) {
    std::vector<Measured> all = {made(Arrangement::paper, {costs_of(0.5, 0.1, 0.348, {0, 0})}), paper_on_six()};
    for (const bool whole : {false, true}) {
        if (whole) all.push_back(shared_on_six());
        const std::string text = machines_text(all, {0, 1e9});
        for (const char* part :
             {"Network is a model, not measured: 0 us a message, 8000 Mbit/s", "Table 1: run time in microseconds",
              "1,480,608   49.9%", "948,000       -          0     948,000       -", "316,000   50.0%     62,000",
              "378,000   41.8%", "1,000,000 objects on 6 processors; as published: on 40",
              "38,622             4,000"}) {
            EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
        }
        // No efficiency without a measurement on one rank.
        EXPECT_EQ(text.find("50,000       -      4,800      54,800       -") != std::string::npos, whole) << text;
    }
}

TEST(Machines, WhatWasMeasuredIsReadAgain) {
    const std::vector<Measured> all = {paper_on_six(), shared_on_six()};
    const std::vector<Measured> again = measured_of(measured_json(all));
    ASSERT_EQ(again.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_TRUE(again[i].setup.same_call(all[i].setup));
        EXPECT_EQ(critical_path(again[i]), critical_path(all[i]));
        EXPECT_EQ(modelled(again[i], {}).network, modelled(all[i], {}).network);
    }
    EXPECT_EQ(again[0].setup.arrangement, Arrangement::paper);
}

}  // namespace
}  // namespace octopair::cluster
